"""Quality columns: whose they are, which codes are good, and that doubt never discards a record."""

import numpy as np
import pytest
from stickslip.logs import read_log, read_loop

N = 20


def table(*columns, separator=",") -> str:
    """A table of N rows from (name, cell or cells) pairs behind a time of 1 s."""
    cells = [value if isinstance(value, list) else [value] * N for _, value in columns]
    head = separator.join(["2024 time", *(name for name, _ in columns)]).replace("2024 time", "time [s]")
    rows = [separator.join(map(str, [i, *(column[i] for column in cells)])) for i in range(N)]
    return "\n".join([head, *rows]) + "\n"


PV = ("FIC1.PV", [round(4 + 0.1 * (i % 5), 1) for i in range(N)])
OP = ("FIC1.OP", [50 + i % 3 for i in range(N)])


@pytest.mark.parametrize("name", ["FIC1.PV Confidence", "FIC1.PV.Conf", "FIC1.PV_CONFIDENCE"])
def test_confidence_100_is_good_and_0_is_bad(write, name):
    # Published: Uniformance PHD gives 100 to good and 0 to bad values.
    loop = read_loop(write(table(PV, (name, [100] * 17 + [0, 30, 80]), OP)))
    assert loop.good.tolist() == [True] * 17 + [False, False, True]
    assert np.isfinite(loop.pv).all(), "the values are kept"
    assert f"FIC1.PV: 2 values of bad quality by {name!r} (below 50 %)." in loop.notes


def test_all_confident_discards_nothing(write):
    assert read_loop(write(table(PV, ("FIC1.PV.Confidence", 100), OP, ("FIC1.OP.Confidence", 100)))).good.all()


def test_confidence_of_a_long_table(write):
    rows = "".join(f"FIC1.PV,{i},{i % 5},{0 if i == 3 else 100}\nFIC1.OP,{i},50,100\n" for i in range(N))
    loop = read_loop(write("TagName,Time,Value,Confidence\n" + rows))
    assert loop.good.tolist() == [i != 3 for i in range(N)]
    assert any("FIC1.PV: 1 value of bad quality by 'Confidence'" in note for note in loop.notes)


@pytest.mark.parametrize(
    ("name", "owner"),
    [
        ("FIC1.PV.ST", ["PV"]),
        ("FIC1.PV_STS", ["PV"]),
        ("FIC1.PV.Q", ["PV"]),
        ("FIC1.PV Status", ["PV"]),
        ("Quality FIC1.PV", ["PV"]),
        ("FIC1.Quality", ["PV", "OP"]),
        ("Quality", ["PV", "OP"]),
        ("StatusCode", ["PV", "OP"]),
    ],
)
def test_whose_quality_it_is(write, name, owner):
    loop = read_loop(write(table(PV, OP, (name, ["Good"] * (N - 1) + ["Bad"]))))
    assert [signal for signal in ("PV", "OP") if not loop.log.good(signal)[-1]] == owner
    assert loop.good[:-1].all()
    assert loop.pv[-1] == PV[1][-1], "a status is never read as the value"


def test_status_of_deltav_beside_its_value(write):
    # Published: Foundation Fieldbus status, 128 good (non-cascade), 192 good (cascade), 64 uncertain.
    text = table(("PID1/PV.CV", PV[1]), ("PID1/PV.ST", [128] * (N - 1) + [64]), ("PID1/OUT.CV", OP[1]))
    loop = read_loop(write(text))
    assert loop.good.tolist() == [True] * (N - 1) + [False]
    assert loop.pv.tolist() == PV[1]


def test_status_of_pcs7_in_hexadecimal(write):
    text = table(("FIC1.PV#Value", PV[1]), ("FIC1.PV#ST", ["16#80"] * (N - 1) + ["16#00"]), ("FIC1.MV#Value", OP[1]))
    assert read_loop(write(text)).good.tolist() == [True] * (N - 1) + [False]


@pytest.mark.parametrize(
    "codes",
    [[0] * N, [0] * (N - 1) + [1], [0] * (N - 1) + [3], [1] * (N - 1) + [7], ["Running"] * N],
    ids=["zeros", "mostly zeros", "small codes", "other codes", "words of a pump"],
)
@pytest.mark.parametrize("name", ["FIC1.PV.Status", "Status"])
def test_doubtful_codes_are_said_and_discard_nothing(write, name, codes):
    loop = read_loop(write(table(PV, OP, (name, codes))))
    assert loop.good.all()
    assert f"The quality in {name!r} cannot be recognised and is not used." in loop.notes


def test_a_running_pump_is_no_quality(write):
    loop = read_loop(write(table(PV, OP, ("Status", [1] * (N - 1) + [0]))))
    assert loop.good.all()


def test_a_flag_that_says_good_is_believed(write):
    log = read_log(write(table(PV, ("FIC1.PV.Good", [0] * (N - 1) + [1]))))
    assert log.good("FIC1.PV").tolist() == [False] * (N - 1) + [True]


def test_one_bad_cell_is_one_gap(write):
    """A blank or a bad cell leaves the rows beside it as they are: time goes on, the cell is missing."""
    for cell in ("", "Bad Input", "****", "#N/A"):
        loop = read_loop(write(table(("PV", [cell if i == 7 else i for i in range(N)]), ("OP", OP[1]))))
        assert loop.t.tolist() == list(range(N))
        assert np.flatnonzero(np.isnan(loop.pv)).tolist() == [7]
        assert np.flatnonzero(~loop.good).tolist() == [7]
        assert loop.op.tolist() == OP[1]


def test_measurements_are_never_read_as_codes(write):
    total = [100 + 2 * i for i in range(N)]
    log = read_log(write(table(PV, OP, ("FIC1.Q", total))))
    assert log["FIC1.Q"].tolist() == total
    odd = [100.5 + i for i in range(N)]
    assert read_loop(write(table(PV, OP, ("FIC1.PV.Q", odd)))).good.all()

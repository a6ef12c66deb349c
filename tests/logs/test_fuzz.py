"""Whatever the bytes, reading gives a record or a ReadError, never another fault."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from stickslip.logs import LoopRecord, ReadError, read_log, read_loop

pytestmark = pytest.mark.filterwarnings("error::RuntimeWarning")

CELLS = st.sampled_from(
    (
        "0", "1", "2", "3.5", "-1", "1e3", "1,5", "", " ", "nan", "inf", "Bad Input", "AUTO", "x", '"', "'", "#", "%",
        "13-Jun-24 21:55:00", "2024-06-13", "13.06.2024 21:55", "6/13/2024 9:55 PM", "21:55:00", "99999999999999",
        "99-Foo-99 99:99:99", "2024-13-45 25:61:61", "31.12.9999 23:59:59", "01/01/0000", "45456.9", "\u00b0C", "\t",
        "133627965000000000", "1718315700000", "739416.5", "-9223372036854775809", "16#80", "Good", "100", "m3/h",
        "Okt",
    )
)  # fmt: skip
NAMES = st.sampled_from(
    (
        "time",
        "PV",
        "OP",
        "SP",
        "MV",
        "MODE",
        "FIC1.PV",
        "FIC1.OP",
        "PV.quality",
        "tag",
        "value",
        "Date",
        "",
        "PV [%]",
        "Quality",
        "FIC1.PV.ST",
        "Confidence",
        "ZT1",
        "FV1.POS",
        "time_ms",
        "Datum",
        "Uhrzeit",
        "T",
        "timestamp",
    )
)


@st.composite
def tables(draw):
    width = draw(st.integers(1, 5))
    header = draw(st.lists(NAMES, min_size=width, max_size=width))
    rows = draw(st.lists(st.lists(CELLS, min_size=max(1, width - 1), max_size=width), max_size=5))
    separator = draw(st.sampled_from([",", ";", "\t", "|", " "]))
    end = draw(st.sampled_from(["\n", "\r\n", "\r"]))
    return end.join(separator.join(row) for row in [header, *rows])


def attempt(path):
    for read in (read_log, read_loop):
        try:
            record = read(path)
        except ReadError as refusal:
            assert str(path) in str(refusal)
        else:
            assert len(record) >= 1
            if isinstance(record, LoopRecord):
                assert record.notes
                record.segments()


@settings(max_examples=400)
@given(text=tables())
def test_any_table(text, tmp_path_factory):
    path = tmp_path_factory.getbasetemp() / "fuzz.csv"
    path.write_text(text, encoding="utf-8")
    attempt(path)


@settings(max_examples=150)
@given(raw=st.binary(max_size=200))
def test_any_bytes(raw, tmp_path_factory):
    path = tmp_path_factory.getbasetemp() / "fuzz.bin"
    path.write_bytes(raw)
    attempt(path)


@settings(max_examples=100)
@given(cut=st.integers(0, 3000), flip=st.integers(0, 3000))
def test_damaged_parquet(cut, flip, tmp_path_factory):
    from stickslip.logs import Log

    path = tmp_path_factory.getbasetemp() / "fuzz.parquet"
    Log(t=range(20), signals={"PV": range(20), "OP": range(20)}).to_parquet(path)
    raw = bytearray(path.read_bytes())
    raw[4 + flip % (len(raw) - 4)] ^= 0xFF
    path.write_bytes(bytes(raw[: max(4, len(raw) - cut % 7)]))
    attempt(path)

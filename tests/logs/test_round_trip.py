"""What is written is read back: exactly, whole or not at all."""

from datetime import UTC, datetime

import numpy as np
import polars as pl
import pytest
from hypothesis import given
from hypothesis import strategies as st
from stickslip.logs import Log, read_log, read_loop

floats = st.floats(allow_nan=True, allow_infinity=True, width=64)
names = st.text(st.characters(exclude_categories=["Cs", "Cc", "Zl", "Zp", "Zs"]), min_size=1, max_size=8).filter(
    lambda name: name != "time" and name.strip() == name
)


@st.composite
def logs(draw):
    n = draw(st.integers(1, 8))
    t = draw(st.lists(st.floats(-1e12, 1e12), min_size=n, max_size=n, unique=True).map(sorted))
    shown = draw(st.lists(names, min_size=1, max_size=4, unique=True))
    signals = {name: draw(st.lists(floats, min_size=n, max_size=n)) for name in shown}
    marked = draw(st.lists(st.sampled_from(shown), unique=True))
    return Log(
        t=t,
        signals=signals,
        units={name: draw(st.text(max_size=4)) for name in marked},
        spans={name: (-1.5, draw(st.floats(0, 1e6))) for name in marked},
        quality={name: draw(st.lists(st.booleans(), min_size=n, max_size=n)) for name in marked},
        origin=draw(st.text(max_size=10)),
        start=draw(st.none() | st.datetimes() | st.datetimes(timezones=st.just(UTC))),
        notes=tuple(draw(st.lists(st.text(max_size=10), max_size=2))),
    )


def same(a: Log, b: Log) -> None:
    assert np.array_equal(a.t, b.t)
    assert a.names == b.names
    for name in a.names:
        assert np.array_equal(a[name], b[name], equal_nan=True), name
        assert (name in a.quality) == (name in b.quality)
        if name in a.quality:
            assert np.array_equal(a.quality[name], b.quality[name])
    assert a.units == b.units
    assert a.spans == b.spans
    assert a.origin == b.origin
    assert a.start == b.start
    assert a.notes == b.notes


@given(log=logs())
def test_csv_and_parquet_round_trip(log, tmp_path_factory):
    """Property: every finite, missing and infinite value and all metadata come back bit for bit."""
    folder = tmp_path_factory.mktemp("trip", numbered=True)
    log.to_csv(folder / "log.csv")
    same(log, read_log(folder / "log.csv"))
    log.to_parquet(folder / "log.parquet")
    same(log, read_log(folder / "log.parquet"))


LOG = Log(
    t=[0.1, 0.2, 0.30000000000000004],
    signals={"SP": [5, 5, 5], "PV": [4.0, np.nan, 1 / 3], "OP": [0.2, 0.4, 0.1], "OP.good": [7, 8, 9]},
    units={"PV": "m3/h"},
    quality={"OP": [True, False, True]},
    origin="simulated: ideal_high, seed 0",
    start=datetime(2024, 6, 13, 21, 55, tzinfo=UTC),
    notes=('A "quoted", noted thing.',),
)


def test_quality_column_does_not_hide_a_signal_of_that_name(tmp_path):
    LOG.to_csv(tmp_path / "log.csv")
    same(LOG, read_log(tmp_path / "log.csv"))


def test_a_loop_of_our_own_file_is_not_guessed_at(tmp_path):
    LOG.to_csv(tmp_path / "log.csv")
    loop = read_loop(tmp_path / "log.csv")
    assert loop.op_percent is None, "no span was written, so none is known"
    assert loop.notes[0] == 'A "quoted", noted thing.'
    assert loop.log.quality["OP"].tolist() == [True, False, True]


def test_the_csv_is_plain_for_others(tmp_path):
    LOG.to_csv(tmp_path / "log.csv")
    lines = (tmp_path / "log.csv").read_text(encoding="utf-8").splitlines()
    table = [line for line in lines if not line.startswith("# ")]
    assert lines[0] == "# stickslip log 1"
    assert table[0] == "time [s],SP,PV,OP,OP.good,OP.good'"
    assert table[2] == "0.2,5.0,,0.4,8.0,0"


def test_a_spoilt_heading_does_not_stop_the_numbers(tmp_path):
    path = tmp_path / "log.csv"
    LOG.to_csv(path)
    path.write_text(path.read_text(encoding="utf-8").replace("origin: ", "origin: {"), encoding="utf-8")
    log = read_log(path)
    assert log.origin == ""
    assert np.array_equal(log["PV"], LOG["PV"], equal_nan=True)


@pytest.mark.parametrize("method", ["to_csv", "to_parquet"])
def test_a_failed_write_leaves_the_old_file(tmp_path, monkeypatch, method):
    path = tmp_path / "log"
    path.write_text("old")

    def fail(*args, **kwargs):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.replace", fail)
    with pytest.raises(OSError, match="No space"):
        getattr(LOG, method)(path)
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path], "no temporary file is left"


def test_parquet_of_others(tmp_path):
    path = tmp_path / "export.dat"  # the content tells, not the name
    frame = pl.DataFrame(
        {
            "timestamp": pl.datetime_range(
                datetime(2024, 6, 13, 21, 55), datetime(2024, 6, 13, 21, 55, 20), "10s", eager=True
            ),
            "FIC1.PV": [1, None, 3],
            "FIC1.OP": [50.0, 51.0, 52.0],
            "remark": ["a", "b", "c"],
        }
    )
    frame.write_parquet(path)
    loop = read_loop(path)
    assert loop.t.tolist() == [0, 10, 20]
    assert loop.log.start == datetime(2024, 6, 13, 21, 55)
    assert loop.good.tolist() == [True, False, True]
    assert read_log(path).names == ("FIC1.PV", "FIC1.OP")


@pytest.mark.parametrize("write", [Log.to_csv, Log.to_parquet])
def test_what_cannot_be_written_is_named_as_it_was_given(write, tmp_path):
    log = Log(t=[0.0, 1.0], signals={"PV": [1.0, 2.0]})
    (tmp_path / "taken").mkdir()
    for path, words in ((tmp_path / "absent" / "x", "no folder"), (tmp_path / "taken", "folder; name a file")):
        with pytest.raises(OSError, match=words) as error:
            write(log, path)
        assert error.value.filename == str(path)
    assert [path.name for path in tmp_path.iterdir()] == ["taken"]


@pytest.mark.parametrize("write", [Log.to_csv, Log.to_parquet])
def test_a_pipe_survives_and_a_link_keeps_pointing_where_it_did(write, tmp_path):
    import os
    import stat

    if not hasattr(os, "mkfifo"):
        pytest.skip("no pipes on this system: NOT TESTED")
    log = Log(t=[0.0, 1.0], signals={"PV": [1.0, 2.0]})
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(OSError, match="device or a pipe"):
        write(log, tmp_path / "pipe")
    assert stat.S_ISFIFO(os.stat(tmp_path / "pipe").st_mode)  # it was not replaced by a file
    (tmp_path / "file").touch()
    (tmp_path / "link").symlink_to(tmp_path / "file")
    write(log, tmp_path / "link")
    assert (tmp_path / "link").is_symlink() and (tmp_path / "file").stat().st_size > 0

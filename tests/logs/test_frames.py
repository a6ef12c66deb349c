"""Frames of pandas, polars, pyarrow and others read as a file with the same cells does."""

from datetime import UTC, datetime

import numpy as np
import polars as pl
import pytest
from stickslip.logs import ReadError, read_log, read_loop

N = 40
PV, OP = 4.0 + np.sin(np.arange(N) / 3.0), 50.0 + np.arange(N) % 7
START = datetime(2024, 6, 13, 21, 55)
CLOCK = np.datetime64(START) + np.arange(N) * np.timedelta64(10, "s")
FILE = "time,FIC1.PV [m3/h],FIC1.OP [%]\n" + "".join(
    f"{moment.item():%Y-%m-%d %H:%M:%S},{pv!r},{op!r}\n"
    for moment, pv, op in zip(CLOCK.astype("M8[us]"), PV.tolist(), OP.tolist(), strict=True)
)


def small() -> pl.DataFrame:
    return pl.DataFrame({"time": CLOCK, "FIC1.PV [m3/h]": PV, "FIC1.OP [%]": OP})


class Foreign:
    """A frame of no known library that speaks Arrow."""

    def __arrow_c_stream__(self, requested_schema=None):
        return small().__arrow_c_stream__(requested_schema)


@pytest.mark.parametrize("frame", [small(), small().lazy(), Foreign()], ids=["polars", "lazy", "Arrow"])
def test_a_frame_reads_as_its_file(write, frame):
    assert_equal_to_file(write, read_loop(frame))


def assert_equal_to_file(write, loop):
    same = read_loop(write(FILE))
    assert np.array_equal(loop.t, same.t) and np.array_equal(loop.pv, same.pv) and np.array_equal(loop.op, same.op)
    assert (loop.name, loop.process, loop.op_span) == (same.name, same.process, same.op_span)
    assert (dict(loop.log.units), loop.log.start, loop.notes) == (dict(same.log.units), START, same.notes)


def test_a_frame_is_a_log_too():
    log = read_log(small())
    assert log.names == ("FIC1.PV", "FIC1.OP")
    assert log.origin == "read from a polars frame"


def test_a_frame_of_text_is_cleaned_as_a_file():
    frame = pl.DataFrame({"t_ms": [0, 100, 200], "PV": ["1.5", "Bad Input", None], "OP": [1, 2, 3]})
    loop = read_loop(frame)
    assert loop.name == "loop" and loop.t.tolist() == pytest.approx([0, 0.1, 0.2])
    assert loop.log.good("PV").tolist() == [True, False, False]


@pytest.mark.parametrize(
    ("given", "words"),
    [
        (5, ["int", "neither a path nor a data frame"]),
        ({"PV": [1]}, ["dict", "neither a path nor a data frame"]),
        (pl.Series([1.0]), ["single column"]),
        (pl.DataFrame({"PV": [1.0]}), ["polars frame: ", "1 column"]),
        (pl.DataFrame({"time": [0.0, 1.0], "FT": [1.0, 2.0]}), ["polars frame: ", "no column is plainly the PV"]),
        (small().clear(), ["no rows"]),
    ],
    ids=["number", "dict", "series", "one column", "no PV", "no rows"],
)
def test_what_is_no_loop_is_refused(given, words):
    with pytest.raises(ReadError) as caught:
        read_loop(given)
    assert all(word in str(caught.value) for word in words), str(caught.value)


class TestPandas:
    """Needs pandas, which this package does not."""

    @pytest.fixture(autouse=True)
    def pandas(self):
        self.pd = pytest.importorskip("pandas", reason="PANDAS NOT TESTED: install the extra 'test'")

    def frame(self):
        return self.pd.DataFrame({"FIC1.PV [m3/h]": PV, "FIC1.OP [%]": OP}, index=self.pd.DatetimeIndex(CLOCK))

    def test_time_as_index_column_objects_or_extension_type(self, write):
        plain = self.frame().rename_axis("time").reset_index()
        as_objects = plain.assign(time=[moment.to_pydatetime() for moment in plain["time"]]).astype({"time": object})
        for frame in (self.frame(), self.frame().rename_axis("ts"), plain, as_objects, plain.convert_dtypes()):
            assert_equal_to_file(write, read_loop(frame))

    def test_time_zones_give_utc(self):
        loop = read_loop(self.frame().tz_localize("Europe/Berlin"))
        assert loop.log.start == datetime(2024, 6, 13, 19, 55, tzinfo=UTC)
        assert loop.dt == 10.0

    def test_levels_of_columns_are_joined(self):
        frame = self.frame().set_axis(self.pd.MultiIndex.from_tuples([("FIC1", "PV"), ("FIC1", "OP")]), axis=1)
        assert read_loop(frame).name == "FIC1"

    def test_missing_and_states_in_a_column_of_objects(self):
        frame = self.frame()
        frame["FIC1.PV [m3/h]"] = ["Bad Input", None, *PV[2:].tolist()]
        loop = read_loop(frame)
        assert loop.good.tolist() == [False, False] + [True] * (N - 2)

    def test_a_count_of_rows_is_no_time_where_there_is_one(self):
        frame = self.frame().rename_axis("time").reset_index().iloc[::2]
        assert read_loop(frame).dt == 20.0

    def test_parquet_with_the_index_of_pandas(self, tmp_path, write):
        pytest.importorskip("pyarrow", reason="PANDAS AND PARQUET NOT TESTED: install the extra 'test'")
        self.frame().to_parquet(tmp_path / "trend.parquet")
        assert_equal_to_file(write, read_loop(tmp_path / "trend.parquet"))

    def test_one_column_and_twins_are_refused(self):
        with pytest.raises(ReadError, match="single column"):
            read_loop(self.frame()["FIC1.OP [%]"])
        with pytest.raises(ReadError, match="'PV' more than once"):
            read_loop(self.frame().set_axis(["PV", "PV"], axis=1))


def test_pyarrow_tables(write):
    pa = pytest.importorskip("pyarrow", reason="PYARROW NOT TESTED: install the extra 'test'")
    table = pa.table({"time": pa.array(CLOCK), "FIC1.PV [m3/h]": PV, "FIC1.OP [%]": OP})
    assert_equal_to_file(write, read_loop(table))

"""The loop record: parts of a log, quality, segments."""

import pickle
from datetime import UTC, datetime, timedelta, timezone

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from stickslip.logs import Log, LogError, LoopRecord

N = 6


def log() -> Log:
    return Log(
        t=np.arange(N),
        signals={
            "SP": np.full(N, 5.0),
            "PV": np.arange(N),
            "OP": np.linspace(4, 20, N),
            "MV": np.linspace(4, 19, N),
            "MODE": [1, 1, 0, 2, np.nan, 1],
        },
        units={"PV": "m3/h", "OP": "mA"},
        spans={"OP": (4, 20)},
    )


def test_parts_and_derived_signals():
    loop = log().loop(name="FIC211")
    assert loop.e.tolist() == [5, 4, 3, 2, 1, 0]
    assert loop.op_percent[0] == 0.0
    assert loop.op_percent[-1] == 100.0
    assert loop.mv_name == "MV"
    assert loop.mode_name == "MODE"
    assert (loop.measurement, loop.dt, len(loop)) == ("flow", 1.0, N)
    # Process is told by the caller or by the reader, never here.
    assert loop.process == "unknown"


def test_good_wants_automatic_or_cascade():
    assert log().loop().good.tolist() == [True, True, False, True, False, True]


def test_good_wants_all_signals():
    holes = log().with_signals(SP=[np.nan, 5, 5, 5, 5, 5], PV=[0, np.nan, 2, 3, 4, 5], MODE=np.ones(N))
    assert holes.loop().good.tolist() == [False, False, True, True, True, True]
    # A stem that is missing does not spoil the loop.
    assert holes.with_signals(MV=np.full(N, np.nan)).loop().good.sum() == 4


def test_sp_is_left_out_if_not_logged():
    plain = Log(t=[0, 1], signals={"PV": [1, 2], "OP": [50, 51]})
    loop = plain.loop()
    assert (loop.sp, loop.e, loop.mv, loop.mode) == (None, None, None, None)
    assert "SP is not logged: e = SP - PV is not known." in loop.notes
    with pytest.raises(LogError, match="no signal 'SETP'"):
        plain.loop(sp="SETP")


@pytest.mark.parametrize(
    ("parts", "words"),
    [
        ({"pv": "FLOW"}, "no signal 'FLOW'"),
        ({"pv": "OP"}, "'OP' is given as pv and as op"),
        ({"pv": None}, "pv = None"),
        ({"process": "runaway"}, "process = 'runaway'"),
    ],
)
def test_refused_with_reason(parts, words):
    with pytest.raises(LogError, match=words):
        log().loop(**parts)


def test_from_arrays():
    loop = LoopRecord.from_arrays([0, 1], pv=[1, 2], op=[50, 51], sp=[1, 1], mv=[49, 49], unit_pv="bar")
    assert loop.log.units == {"SP": "bar", "PV": "bar", "OP": "%", "MV": "%"}
    assert loop.op_percent.tolist() == [50, 51]
    assert LoopRecord.from_arrays([0, 1], pv=[1, 2], op=[50, 51], op_span=None).op_percent is None
    with pytest.raises(LogError, match="'PV' has 3 samples and time has 2"):
        LoopRecord.from_arrays([0, 1], pv=[1, 2, 3], op=[50, 51])


def test_segments_are_cut_at_bad_samples_and_gaps():
    t = [0, 1, 2, 3, 20, 21, 22, 23]
    pv = [1, 1, np.nan, 1, 1, 1, 1, 1]
    loop = LoopRecord.from_arrays(t, pv=pv, op=np.ones(8), sp=np.ones(8), name="LIC7", process="integrating")
    parts = loop.segments(min_samples=1)
    assert [part.t.tolist() for part in parts] == [[0, 1], [3], [20, 21, 22, 23]]
    assert [len(part) for part in loop.segments(min_samples=3)] == [4]
    assert (parts[0].name, parts[0].process, parts[0].sp_name) == ("LIC7", "integrating", "SP")
    with pytest.raises(LogError, match="min_samples"):
        loop.segments(min_samples=0)
    with pytest.raises(LogError, match="gap_factor"):
        loop.segments(gap_factor=-1.0)


@given(st.lists(st.booleans(), min_size=1, max_size=30), st.lists(st.booleans(), min_size=30, max_size=30))
def test_segments_hold_every_good_sample_once(good, gap_after):
    """Property: with min_samples = 1 the segments partition the good samples, in order."""
    n = len(good)
    steps = np.where(gap_after[: n - 1], 50.0, 1.0)
    t = np.concatenate([[0.0], np.cumsum(steps)])
    loop = LoopRecord.from_arrays(t, pv=np.where(good, 1.0, np.nan), op=np.ones(n))
    parts = loop.segments(min_samples=1)
    assert [s for part in parts for s in part.t] == t[good].tolist()
    for part in parts:
        assert part.good.all()
        assert (np.diff(part.t) <= 5.0 * loop.dt).all() if len(part) > 1 else True


def test_pickle_for_process_pools():
    loop = log().loop(name="FIC211")
    loop.good  # noqa: B018 - fills the cache, which must not be in the way
    again = pickle.loads(pickle.dumps(loop))
    assert again.good.tolist() == loop.good.tolist()
    assert again.name == "FIC211"


def test_text_of_a_loop():
    assert repr(log().loop(name="FIC211")) == (
        "<LoopRecord: FIC211: 6 samples, dt 1 s, PV, OP, SP, MV, MODE; flow, unknown>"
    )


MOMENTS = [datetime(2024, 6, 13, 21, 55) + i * timedelta(seconds=10) for i in range(5)]


@pytest.mark.parametrize("unit", ["s", "ms", "us", "ns"])
def test_moments_become_seconds(unit):
    loop = LoopRecord.from_arrays(np.array(MOMENTS, dtype=f"datetime64[{unit}]"), pv=range(5), op=range(5))
    assert loop.t.tolist() == [0, 10, 20, 30, 40]
    assert loop.log.start == MOMENTS[0]


def test_datetime_objects_and_durations_become_seconds():
    assert LoopRecord.from_arrays(MOMENTS, pv=range(5), op=range(5)).dt == 10.0
    berlin = timezone(timedelta(hours=2))
    zoned = LoopRecord.from_arrays([moment.replace(tzinfo=berlin) for moment in MOMENTS], pv=range(5), op=range(5))
    assert zoned.log.start == datetime(2024, 6, 13, 19, 55, tzinfo=UTC)
    passed = np.array([0, 500, 1000], dtype="timedelta64[ms]")
    assert LoopRecord.from_arrays(passed, pv=[1, 2, 3], op=[1, 2, 3]).t.tolist() == [0, 0.5, 1.0]
    assert Log(t=np.array(MOMENTS, dtype="M8[ns]"), signals={}).start == MOMENTS[0]


def test_a_moment_that_is_none_is_refused():
    with pytest.raises(LogError, match=r"t\[1\] is no time \(NaT\)"):
        LoopRecord.from_arrays(np.array(["2024-01-01", "NaT"], dtype="M8[s]"), pv=[1, 2], op=[1, 2])

"""Recorded data and staircases: exact at the knots, numpy's interpolation in between as the oracle."""

from datetime import UTC, datetime, timedelta

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st
from stickslip.blocks import FirstOrder
from stickslip.blocks.ports import BlockError
from stickslip.blocks.recorded import Recorded, Staircase
from stickslip.diagram import simulate, wire


def at(block, t):
    return float(block.output(t, [], [])[0])


@st.composite
def tables(draw):
    gaps = draw(st.lists(st.floats(1e-3, 100.0), min_size=1, max_size=30))
    t = draw(st.floats(-50.0, 50.0)) + np.cumsum(gaps)
    values = draw(st.lists(st.floats(-1e3, 1e3), min_size=len(t), max_size=len(t)))
    return t, np.array(values)


@given(table=tables(), where=st.floats(-100.0, 3500.0))
def test_lines_agree_with_numpy_and_knots_are_exact(table, where):
    t, values = table
    block = Recorded("PV", t, values)
    assert [at(block, s) for s in t] == values.tolist()
    scale = 1e-9 * (1.0 + np.abs(values).max())
    assert at(block, where) == pytest.approx(np.interp(where, t, values), abs=scale)


@given(table=tables(), where=st.floats(-100.0, 3500.0))
def test_holding_keeps_the_last_value_passed(table, where):
    t, values = table
    block = Recorded("PV", t, values, hold="previous")
    passed = np.searchsorted(t, where, side="right")
    assert at(block, where) == values[max(passed - 1, 0)]


@pytest.mark.parametrize("hold", ["linear", "previous"])
def test_compiled_playback_is_exact_at_irregular_knots(hold):
    rng = np.random.default_rng(5)
    t = np.cumsum(rng.uniform(0.01, 2.0, 500))
    values = rng.normal(size=500)
    log = simulate(wire([Recorded("PV", t, values, hold=hold)], outputs=["PV"]), float(t[-1]), times=t).log
    np.testing.assert_array_equal(log["PV"], values)


def test_staircase_by_dwell_and_by_times():
    even = Staircase("OP", [0.1, 0.2, 0.4], dwell=5.0, start=10.0)
    assert [at(even, t) for t in (0.0, 14.9, 15.0, 20.0, 1e9)] == [0.1, 0.1, 0.2, 0.4, 0.4]
    uneven = Staircase("OP", [0.1, 0.2, 0.4], at=[0.0, 1.0, 7.0])
    assert [at(uneven, t) for t in (0.5, 1.0, 6.9, 7.0)] == [0.1, 0.2, 0.2, 0.4]


def test_a_run_that_starts_inside_the_table_sees_the_value_in_force():
    t, values = np.arange(10.0), np.arange(10.0) ** 2
    for hold, before in (("previous", 9.0), ("linear", 12.5)):
        source = wire([Recorded("PV", t, values, hold=hold)], outputs=["PV"])
        log = simulate(source, 2.0, times=[3.5, 4.0, 5.25], t0=3.5).log
        assert log["PV"].tolist()[:2] == [before, 16.0]


def test_of_a_table_nothing_is_copied_into_a_run():
    long = wire([Recorded("MV", np.arange(1e5), np.zeros(100_000)), FirstOrder(K=1.0, tau=5.0)])
    (_, _, W), *_ = simulate(long, 1.0).ends
    assert len(W) < 2000
    assert len(long["MV"].p) < 10


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Recorded("PV", [0.0, 1.0], [1.0]), ["(2,)", "(1,)", "one value per time"]),
        (lambda: Recorded("PV", [], []), ["n >= 1"]),
        (lambda: Recorded("PV", [0.0, 1.0, 1.0], [1.0, 2.0, 3.0]), ["t[1] = 1.0", "strictly", "drop repeated"]),
        (lambda: Recorded("PV", [0.0, 1.0], [1.0, np.nan]), ["1 of 2 samples", "index 1", "fill the gaps"]),
        (lambda: Recorded("PV", [0.0], [1.0], hold="prev"), ["hold = 'prev'", "did you mean 'previous'"]),
        (lambda: Staircase("OP", [1.0, 2.0]), ["either dwell=", "at="]),
        (lambda: Staircase("OP", [1.0, 2.0], dwell=-1.0), ["dwell = -1.0", "positive"]),
    ],
)
def test_misuse_is_refused_with_value_rule_and_remedy(refuses, make, words):
    refuses(make, words)


STAMPS = pd.date_range("2024-05-06 07:00", periods=3, freq="10s")
LATER = pd.timedelta_range(0, periods=3, freq="10s")


@pytest.mark.parametrize(
    "t",
    [STAMPS, STAMPS.tz_localize("Europe/Oslo"), STAMPS.to_numpy(), list(STAMPS.to_pydatetime()), pd.Series(STAMPS),
     LATER, LATER.to_numpy(), [timedelta(seconds=s) for s in (0, 10, 20)]],
    ids=lambda t: f"{type(t).__name__}-{getattr(t, 'dtype', type(t[0]).__name__)}",
)  # fmt: skip
def test_moments_and_durations_are_seconds_from_the_first(t):
    for block in (Recorded("PV", t, [1.0, 2.0, 4.0], hold="previous"), Staircase("PV", [1.0, 2.0, 4.0], at=t)):
        assert [at(block, s) for s in (0.0, 9.9, 10.0, 25.0)] == [1.0, 1.0, 2.0, 4.0]  # analytic


def test_the_moment_of_time_zero_is_kept():
    assert Recorded("PV", STAMPS, [1.0, 2.0, 4.0]).clock == datetime(2024, 5, 6, 7)
    assert Recorded("PV", STAMPS.tz_localize("UTC"), [1.0, 2.0, 4.0]).clock == datetime(2024, 5, 6, 7, tzinfo=UTC)
    assert Recorded("PV", LATER, [1.0, 2.0, 4.0]).clock is None


def test_a_moment_that_is_none_is_refused():
    with pytest.raises(BlockError, match=r"PV: t\[1\] is no time"):
        Recorded("PV", STAMPS.where([True, False, True]), [1.0, 2.0, 4.0])


def test_one_run_has_one_clock():
    """Each table counts from its own first moment; beside each other that would shift one silently."""
    a, b = Recorded("a", STAMPS, [1.0, 2.0, 4.0]), Recorded("b", STAMPS + pd.Timedelta("5s"), [1.0, 2.0, 4.0])
    with pytest.raises(ValueError, match=r"time 0 is 2024-05-06 07:00:00 for 'a', but 2024-05-06 07:00:05 for 'b'"):
        simulate(wire([a, b], outputs=["a", "b"]), 20.0)
    run = simulate(wire([a, Recorded("b", STAMPS, [1.0, 2.0, 4.0])], outputs=["a", "b"]), 20.0)
    np.testing.assert_array_equal(run.log["a"], run.log["b"])

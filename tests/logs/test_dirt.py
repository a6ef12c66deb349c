"""Historian dirt: bounded, repeatable, and like the real thing."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from stickslip.logs import Log, LogError
from stickslip.logs.dirt import bad_states, drop_out, jitter_time, quantise, swinging_door, swinging_door_kept

N = 400


def noisy(seed: int = 0) -> Log:
    t = np.arange(float(N))
    noise = np.random.default_rng(seed).normal(size=N)
    return Log(
        t=t,
        signals={"PV": np.sin(t / 20) + 0.05 * noise, "OP": 50 + np.cos(t / 20)},
        units={"OP": "%"},
        spans={"OP": (0, 100)},
        quality={"OP": np.arange(N) != 7},
    )


@given(
    st.lists(st.floats(-1e3, 1e3), min_size=1, max_size=60),
    st.lists(st.floats(0.1, 10), min_size=60, max_size=60),
    st.floats(0, 100),
)
def test_swinging_door_keeps_its_promise(values, steps, deviation):
    """Property: the line between archived samples passes every sample within the deviation."""
    t = np.cumsum(steps[: len(values)])
    log = Log(t=t, signals={"PV": values})
    error = np.abs(swinging_door(log, deviation)["PV"] - values)
    assert error.max() <= deviation + 1e-9 * (1 + np.max(np.abs(values)))  # rounding of the line


def test_swinging_door_compresses():
    kept = swinging_door_kept(noisy().t, noisy()["PV"], 0.15)
    assert kept[0]
    assert kept[-1]
    assert kept.sum() < N / 5
    # A straight line needs its ends only (analytic).
    assert swinging_door_kept(np.arange(50.0), 3 * np.arange(50.0), 1e-9).sum() == 2
    # No tolerance and no two samples in line: all are kept.
    assert swinging_door_kept(np.arange(4.0), [0, 1, 0, 1], 0.0).all()


def test_swinging_door_leaves_missing_values_and_other_signals():
    holes = noisy().with_signals(PV=np.where(np.arange(N) % 50 == 25, np.nan, noisy()["PV"]))
    log = swinging_door(holes, {"PV": 0.1})
    assert np.array_equal(np.isnan(log["PV"]), np.isnan(holes["PV"]))
    assert np.array_equal(log["OP"], holes["OP"])
    assert np.nanmax(np.abs(log["PV"] - holes["PV"])) <= 0.1 + 1e-12
    with pytest.raises(LogError, match="deviation"):
        swinging_door(noisy(), -0.1)
    with pytest.raises(LogError, match="missing"):
        swinging_door_kept([0, 1], [0, np.nan], 0.1)


def test_quantise():
    log = quantise(noisy(), "PV", 0.25)
    assert np.array_equal(log["PV"] / 0.25, np.round(log["PV"] / 0.25))
    assert np.abs(log["PV"] - noisy()["PV"]).max() <= 0.125
    with pytest.raises(LogError, match="step"):
        quantise(noisy(), "PV", 0.0)


@pytest.mark.parametrize("length", [1, 10])
def test_drop_out_loses_the_share_asked_for(length):
    log = drop_out(noisy(), 0.25, seed=1, length=length)
    assert N - len(log) == pytest.approx(0.25 * N, abs=2)  # the first and the last row stay
    assert (log.t[0], log.t[-1]) == (0, N - 1)
    rows = log.t.astype(int)
    assert np.array_equal(log["PV"], noisy()["PV"][rows])
    assert np.array_equal(log.quality["OP"], noisy().quality["OP"][rows])


def test_bad_states():
    log = bad_states(noisy(), "OP", 0.1, seed=2, length=8)
    bad = ~log.quality["OP"]
    assert bad.sum() in (40, 41)  # a tenth of 400, and sample 7 that was bad before
    assert bad[7]
    assert np.isnan(log["OP"]).sum() == 40
    assert log.good("PV").all()
    with pytest.raises(LogError, match="share"):
        bad_states(noisy(), "OP", 1.5)
    with pytest.raises(LogError, match="length"):
        bad_states(noisy(), "OP", 0.5, length=0)


def test_jitter_keeps_the_order():
    log = jitter_time(noisy(), 0.4, seed=3)
    assert (np.diff(log.t) > 0).all()
    assert 0.3 < np.abs(log.t - noisy().t).max() <= 0.4
    with pytest.raises(LogError, match="half the shortest step"):
        jitter_time(noisy(), 0.5)


@pytest.mark.parametrize(
    "soil",
    [
        lambda log, seed: drop_out(log, 0.2, seed),
        lambda log, seed: bad_states(log, "PV", 0.2, seed),
        lambda log, seed: jitter_time(log, 0.2, seed),
    ],
    ids=["drop_out", "bad_states", "jitter_time"],
)
def test_seeds_repeat_and_differ(soil):
    def image(seed):
        log = soil(noisy(), seed)
        return log.t.tobytes() + log["PV"].tobytes()

    assert image(1) == image(1)
    assert image(1) != image(2)


def test_dirty_log_still_has_its_units_and_spans():
    log = quantise(bad_states(drop_out(jitter_time(noisy(), 0.1), 0.1), "PV", 0.1), "OP", 0.5)
    assert log.units["OP"] == "%"
    assert log.spans["OP"] == (0, 100)

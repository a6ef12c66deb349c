"""The closed forms against the exact automaton and against the areas they stand for."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from stickslip.cases.exact import (
    IDEAL_HALF_GAIN,
    IDEAL_HIGH,
    IDEAL_NORMAL,
    INTEGRATOR_HIGH,
    ExactLoop,
    ExactLoopError,
    closed_form_R,
    cycle_period,
    exact_run,
    oscillating_references,
    symmetric_error,
    symmetric_start,
)

CYCLES = {"high": IDEAL_HIGH, "normal": IDEAL_NORMAL, "half gain": IDEAL_HALF_GAIN}


def slip_times(loop: ExactLoop) -> np.ndarray:
    return np.array([event.t for event in exact_run(loop).events if event.kind == "slip"])


@pytest.mark.parametrize("name", CYCLES)
def test_period_against_the_exact_loop(name: str) -> None:
    loop = symmetric_start(CYCLES[name])
    times = slip_times(loop)
    assert times.size >= 4
    # Analytic, less the 0.07 s of each slip (quasi-static limit): 1 %.
    assert np.mean(np.diff(times)) == pytest.approx(0.5 * cycle_period(loop), rel=0.01)


@pytest.mark.parametrize(("name", "period"), [("high", 117.0), ("normal", 200.0), ("half gain", 233.0)])
def test_published_design_periods(name: str, period: float) -> None:
    assert cycle_period(CYCLES[name]) == pytest.approx(period, abs=0.5)  # analytic: S T_i / (K_p K J) * 4


def test_period_of_an_unsymmetric_cycle() -> None:
    """A reference off the symmetric one moves x_ss inside the jump; the period follows 1/(alpha (1 - alpha))."""
    loop = replace(IDEAL_HIGH, SP=0.42, duration=1200.0)
    run = exact_run(loop)
    sticks = [event.MV for event in run.events if event.kind == "stick"][-2:]
    alpha = (loop.x_rest - min(sticks)) / (max(sticks) - min(sticks))
    assert not 0.4 < alpha < 0.6
    times = slip_times(loop)
    assert times[-1] - times[-3] == pytest.approx(cycle_period(loop, alpha), rel=0.02)


@pytest.mark.parametrize("name", CYCLES)
def test_error_shape_against_the_exact_loop(name: str) -> None:
    loop = replace(symmetric_start(CYCLES[name]), duration=0.4 * cycle_period(CYCLES[name]))
    run = exact_run(loop)
    # Started after an upward slip, where e is the mirror image of the documented half cycle.
    np.testing.assert_allclose(run.e, -symmetric_error(loop, run.t), rtol=0, atol=1e-12)


@pytest.mark.parametrize("half_period", [20.0, 58.3, 116.7, 400.0])
def test_R_is_the_ratio_of_areas(half_period: float) -> None:
    """Analytic: e falls from its peak to zero after one slip, and rises from there to the next peak."""
    tau = 10.0
    t = np.linspace(0.0, half_period, 200_001)
    shape = 1.0 - 2.0 * np.exp(-t / tau) / (1.0 + np.exp(-half_period / tau))
    rising = np.trapezoid(np.where(shape > 0, shape, 0.0), t)
    falling = np.trapezoid(np.where(shape < 0, -shape, 0.0), t)
    assert closed_form_R(half_period, tau) == pytest.approx(rising / falling, rel=1e-6)


def test_oscillating_references_bound_the_cycles() -> None:
    """Near either end x_ss lies close to an end of the jump and the period grows without bound: 4000 s."""
    low, high = oscillating_references(IDEAL_HIGH)
    loop = replace(IDEAL_HIGH, duration=4000.0, log_interval=10.0)
    for SP, cycles in ((low * 0.97, False), (low * 1.03, True), (high * 0.97, True), (high * 1.03, False)):
        assert (len(exact_run(replace(loop, SP=SP)).events) > 4) is cycles


def test_integrator_amplitude_and_period() -> None:
    run = exact_run(INTEGRATOR_HIGH)
    # Analytic (quasi-static): PV amplitude S / (2 K_p) = 0.1667, period 4 S / (K_p K/tau J) = 233.3 s.
    assert 0.5 * np.ptp(run.PV) == pytest.approx(1.0 / 6.0, rel=0.03)
    assert np.mean(np.diff(slip_times(INTEGRATOR_HIGH))) == pytest.approx(0.5 * 233.3, rel=0.01)


def test_refusals() -> None:
    with pytest.raises(ExactLoopError, match="T_i"):
        cycle_period(ExactLoop(T_i=12.0))
    with pytest.raises(ExactLoopError, match="integrating"):
        symmetric_start(INTEGRATOR_HIGH)
    with pytest.raises(ExactLoopError, match="alpha"):
        cycle_period(IDEAL_HIGH, 1.0)
    with pytest.raises(ExactLoopError, match="jump"):
        cycle_period(ExactLoop(F_s=1250.0))
    with pytest.raises(ExactLoopError, match="K_p K"):
        oscillating_references(IDEAL_HALF_GAIN)
    with pytest.raises(ExactLoopError, match="half_period"):
        closed_form_R(0.0, 10.0)

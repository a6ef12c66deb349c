"""The exact automaton against simulators of other hands: PathSim's events, and plain C with fixed steps."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from stickslip.cases.exact import IDEAL_HIGH, IDEAL_NORMAL, INTEGRATOR_HIGH, ExactLoop, exact_run

from benchmarks.peers import c_loop


@pytest.mark.parametrize(
    "loop",
    [replace(IDEAL_HIGH, duration=130.0), replace(INTEGRATOR_HIGH, duration=130.0)],
    ids=["high", "integrator"],
)
def test_pathsim_agrees_to_1e_6(loop: ExactLoop) -> None:
    pytest.importorskip("pathsim", reason="pathsim is not installed: the independent oracle is SKIPPED")
    from benchmarks.peers import pathsim_loop

    ours, theirs = exact_run(loop), pathsim_loop.run(loop)
    np.testing.assert_allclose(theirs.t, ours.t, rtol=0, atol=1e-9)
    np.testing.assert_allclose(theirs.e, ours.e, rtol=0, atol=1e-6)
    np.testing.assert_allclose(theirs.OP, ours.OP, rtol=0, atol=1e-6)
    later = [event.t for event in ours.events if event.t > 0.0]  # theirs starts in the right mode, without an event
    assert len(later) >= 2
    np.testing.assert_allclose(theirs.event_times, later, rtol=0, atol=1e-4)


@pytest.mark.parametrize("loop", [IDEAL_HIGH, IDEAL_NORMAL], ids=["high", "normal"])
def test_c_agrees_to_1e_8(loop: ExactLoop) -> None:
    try:
        rows = c_loop.run(loop)
    except c_loop.NoCompiler as missing:
        pytest.skip(str(missing))
    run = exact_run(loop)
    assert rows.n_events == len(run.events)
    np.testing.assert_allclose(rows.e, run.e, rtol=0, atol=1e-8)
    np.testing.assert_allclose(rows.rows[:, 4], run.MV, rtol=0, atol=1e-6)


def test_c_converges_with_the_fourth_power_of_the_slip_step() -> None:
    try:
        coarse, fine = c_loop.run(h_slip=1e-3), c_loop.run(h_slip=5e-4)
    except c_loop.NoCompiler as missing:
        pytest.skip(str(missing))
    e = exact_run(IDEAL_HIGH).e
    ratio = np.abs(coarse.e - e).max() / np.abs(fine.e - e).max()
    assert ratio == pytest.approx(2.0**4, rel=0.2)  # analytic: order of RK4, with the events located exactly

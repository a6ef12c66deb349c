"""Behaviour of the exact automaton that follows from the equations, and an independent integrator."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from stickslip.cases.exact import (
    IDEAL_HALF_GAIN,
    IDEAL_HIGH,
    INTEGRATOR_HIGH,
    ExactLoop,
    ExactLoopError,
    exact_run,
)


def dop853(loop: ExactLoop) -> tuple[np.ndarray, list[float]]:
    """PV at the log times and the event times, by scipy's DOP853 at 1e-12 with its own event location."""
    t_log = np.arange(round(loop.duration / loop.log_interval) + 1) * loop.log_interval
    PV, events, s, t = np.empty_like(t_log), [], 0, 0.0
    state = np.array([loop.PV_0, loop.z_0, loop.x_0, 0.0])

    def pull(w: np.ndarray) -> float:
        return loop.K_p * (loop.SP - w[0]) + w[1] - w[2]

    while t < t_log[-1]:
        if s == 0 and loop.k * abs(pull(state)) > loop.F_s * (1 - 1e-12):
            events.append(t)
            s = int(np.sign(pull(state)))

        def slope(_t: float, w: np.ndarray, s: int = s) -> list[float]:
            force = loop.k * pull(w) - s * loop.F_c - loop.F_v * w[3]
            stem = [w[3], force / loop.M] if s else [0.0, 0.0]
            return [loop.a * w[0] + loop.b * w[2], loop.K_i * (loop.SP - w[0]), *stem]

        def boundary(_t: float, w: np.ndarray, s: int = s) -> float:
            return -s * w[3] if s else loop.k * abs(pull(w)) - loop.F_s

        boundary.terminal, boundary.direction = True, 1  # type: ignore[attr-defined]
        part = solve_ivp(
            slope,
            (t, t_log[-1]),
            state,
            method="DOP853",
            rtol=1e-12,
            atol=1e-14,
            events=boundary,
            dense_output=True,
            max_step=2e-3 if s else 1.0,
        )
        inside = (t_log >= t) & (t_log <= part.t[-1])
        if inside.any():
            PV[inside] = part.sol(t_log[inside])[0]
        t, state = part.t[-1], part.y[:, -1].copy()
        if part.status == 1 and s:
            events.append(t)
            state[3], s = 0.0, 0
    return PV, events


@pytest.mark.parametrize("loop", [IDEAL_HIGH, INTEGRATOR_HIGH], ids=["high", "integrator"])
def test_agrees_with_dop853(loop: ExactLoop) -> None:
    run, (PV, events) = exact_run(loop), dop853(loop)
    # Analytic: two solutions of one problem; the bound is DOP853's event error, measured 3e-12 s.
    np.testing.assert_allclose([event.t for event in run.events], events, rtol=0, atol=1e-9)
    np.testing.assert_allclose(run.PV, PV, rtol=0, atol=1e-9)


def test_events_alternate_at_their_thresholds() -> None:
    run = exact_run(IDEAL_HIGH)
    assert [event.kind for event in run.events] == ["slip", "stick"] * 11  # snapshot of the count
    for slip, stick in zip(run.events[2::2], run.events[3::2], strict=True):
        assert abs(slip.OP - slip.MV) == pytest.approx(2250 / 52500, abs=1e-14)  # analytic: F_s / k
        assert np.sign(stick.MV - slip.MV) == slip.direction
        assert abs(stick.OP - stick.MV) < 2250 / 52500
        # The stem coasts to J = (F_s - F_c)/k from the other side only asymptotically; it falls short of it by the
        # OP ramp, 1e-3 /s times the 0.07 s of the slip, at most.
        assert abs(stick.MV - slip.MV) == pytest.approx(1000 / 52500, abs=1e-4)


def test_rests_where_the_reference_holds_it() -> None:
    """Half gain from rest: the first slip falls short of x = SP/K and the stem slides there without sticking."""
    run = exact_run(IDEAL_HALF_GAIN)
    assert [event.kind for event in run.events] == ["slip"]
    assert run.MV[-1] == pytest.approx(0.5 / 3.0, abs=1e-12)  # analytic
    assert run.PV[-1] == pytest.approx(0.5, abs=1e-12)


def test_nothing_moves_at_rest() -> None:
    run = exact_run(replace(IDEAL_HIGH, SP=0.0))
    assert run.events == ()
    assert not np.any(run.PV) and not np.any(run.MV)


def test_no_log_row_is_lost_and_time_is_exact() -> None:
    run = exact_run(IDEAL_HIGH)
    assert run.t.shape == run.v.shape == (6001,)
    assert run.t[-1] == pytest.approx(600.0, abs=1e-12)
    np.testing.assert_allclose(run.OP, 0.4 * run.e + run.z, rtol=0, atol=1e-16)


@settings(max_examples=25)
@given(
    SP=st.floats(-2.0, 2.0).filter(lambda r: abs(r) > 1e-3),
    K_p=st.floats(0.05, 1.0),
    T_i=st.floats(2.0, 60.0),
    F_s=st.floats(1250.0, 4000.0),
    integrating=st.booleans(),
)
def test_mirror_image_and_balances(SP: float, K_p: float, T_i: float, F_s: float, integrating: bool) -> None:
    loop = ExactLoop(SP=SP, K_p=K_p, T_i=T_i, F_s=F_s, integrating=integrating, duration=60.0)
    run, mirror = exact_run(loop), exact_run(replace(loop, SP=-SP))
    scale = max(1.0, float(np.abs(run.PV).max()))
    np.testing.assert_allclose(mirror.MV, -run.MV, rtol=0, atol=1e-9 * scale)
    stuck = run.v == 0.0
    assert np.all(np.abs(run.OP - run.MV)[stuck][1:] <= loop.f_s + 1e-12)
    # The integral part can be had from the log alone: z = K_i int e dt (trapezoid, log_interval^2 / 12 * T * e'').
    area = np.concatenate([[0.0], np.cumsum(0.5 * (run.e[1:] + run.e[:-1]))]) * loop.log_interval
    np.testing.assert_allclose(run.z, loop.K_i * area, rtol=0, atol=2e-2 * loop.K_i * scale)


@pytest.mark.parametrize(
    ("change", "word"),
    [
        ({"F_s": 1000.0}, "F_s"),
        ({"tau": 0.0}, "tau"),
        ({"SP": np.nan}, "SP"),
        ({"duration": -1.0}, "duration"),
        ({"log_interval": 0.0}, "log_interval"),
    ],
)
def test_bad_parameters_are_named(change: dict[str, float], word: str) -> None:
    with pytest.raises(ExactLoopError, match=word):
        ExactLoop(**change)


def test_coinciding_eigenvalues_are_refused() -> None:
    # At K_p -> 0 the controller is absent and the slip modes are those of the stem: equal at F_v = 2 sqrt(k M).
    critical = ExactLoop(K_p=1e-14, F_v=2.0 * np.sqrt(52500.0 * 1.36), x_0=0.2)
    with pytest.raises(ExactLoopError, match="coincide"):
        exact_run(critical)

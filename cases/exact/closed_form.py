"""Closed forms of the ideal loop's stick-slip cycle, in the limit of an instantaneous slip.

They hold when the controller's zero cancels the process pole (T_i = tau, lag process). Then, in every mode,

    dOP/dt = -K_p K / T_i (x - x_ss),    x_ss = SP / K,

so OP is a ramp while the stem is stuck and the cycle needs no simulation.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from stickslip.cases.exact.parameters import ExactLoop, ExactLoopError

Array = NDArray[np.float64]


def _require_cancellation(loop: ExactLoop) -> None:
    if loop.integrating or not np.isclose(loop.T_i, loop.tau, rtol=1e-12):
        raise ExactLoopError(
            f"T_i = {loop.T_i!r} s, tau = {loop.tau!r} s, integrating = {loop.integrating!r}: the closed form needs"
            " a lag process whose pole the controller cancels; set T_i = tau, or use exact_run"
        )


def cycle_period(loop: ExactLoop, alpha: float = 0.5) -> float:
    """Period of the cycle [s]: S T_i / (K_p K J) / (alpha (1 - alpha)), S = (F_s + F_c)/k, J = (F_s - F_c)/k.

    ``alpha`` in (0, 1) is the place of x_ss inside the jump; nothing attracts it to the symmetric 0.5. The formula
    neglects the slip itself (0.07 s). Raises ExactLoopError without pole cancellation, or when there is no jump.

    >>> round(cycle_period(ExactLoop()), 2)
    116.67
    """
    _require_cancellation(loop)
    if not 0.0 < alpha < 1.0:
        raise ExactLoopError(f"alpha = {alpha!r} must lie inside the jump; give 0 < alpha < 1")
    if loop.J <= 0.0:
        raise ExactLoopError(f"F_s = F_c = {loop.F_s!r} N leaves no jump, hence no cycle; raise F_s")
    return loop.S * loop.T_i / (loop.K_p * loop.K * loop.J) / (alpha * (1.0 - alpha))


def oscillating_references(loop: ExactLoop) -> tuple[float, float]:
    """Open interval of reference steps from rest that end in a cycle: 0 < r (K_p - 1/K) - f_c < J.

    The middle one gives the symmetric cycle. It assumes that the first slip, at t = 0, ends before PV moves; by
    ``exact_run`` the interval for the default loop is 0.3549 to 0.6410. Raises ExactLoopError when K_p K <= 1, where
    the first slip always stops short of x_ss.

    >>> low, high = oscillating_references(ExactLoop())
    >>> round(low, 3), round(high, 3)
    (0.357, 0.643)
    """
    _require_cancellation(loop)
    lead = loop.K_p - 1.0 / loop.K
    if lead <= 0.0:
        raise ExactLoopError(f"K_p K = {loop.K_p * loop.K!r} must exceed 1; start from symmetric_start instead")
    return loop.f_c / lead, (loop.f_c + loop.J) / lead


def symmetric_error(loop: ExactLoop, t: Array) -> Array:
    """Control error e during the half cycle that follows a downward slip at t = 0, shape as t.

    e = A [1 - 2 exp(-t/tau) / (1 + exp(-h/tau))],  A = K J / 2,  0 <= t <= h = half the period [s].

    >>> h = 0.5 * cycle_period(ExactLoop())
    >>> symmetric_error(ExactLoop(), np.array([0.0, h])).round(4)
    array([-0.0284,  0.0284])
    """
    h = 0.5 * cycle_period(loop)
    decay = 2.0 * np.exp(-np.asarray(t, dtype=np.float64) / loop.tau) / (1.0 + np.exp(-h / loop.tau))
    error: Array = 0.5 * loop.K * loop.J * (1.0 - decay)
    return error


def closed_form_R(half_period: float, tau: float) -> float:
    """Stiction index R of the symmetric cycle: area of |e| before its peak over the area after it, zero to zero.

    R(h) = [h - t0 - tau (1 + q)(exp(-t0/tau) - exp(-h/tau))] / [tau (1 + q)(1 - exp(-t0/tau)) - t0],
    q = tanh(h / (2 tau)), t0 = tau ln(1 + q), for half period h and process time constant tau [s], of the
    algorithm without the one-sample lag of the printed Algorithm 1. Raises ExactLoopError for h or tau <= 0.

    >>> [round(closed_form_R(h, 10.0), 2) for h in (58.333, 100.0, 116.667)]
    [13.65, 27.08, 32.5]
    """
    if not (half_period > 0.0 and tau > 0.0):
        raise ExactLoopError(f"half_period = {half_period!r}, tau = {tau!r} s must both be positive")
    q = np.tanh(0.5 * half_period / tau)
    t0 = tau * np.log1p(q)
    after = tau * (1.0 + q) * (1.0 - np.exp(-t0 / tau)) - t0
    before = half_period - t0 - tau * (1.0 + q) * (np.exp(-t0 / tau) - np.exp(-half_period / tau))
    return float(before / after)


def symmetric_start(loop: ExactLoop) -> ExactLoop:
    """The same loop, started on its symmetric cycle just after an upward slip: x = x_ss + J/2, OP = x + f_c.

    Raises ExactLoopError as ``cycle_period`` does.

    >>> start = symmetric_start(ExactLoop())
    >>> round(start.x_0, 4), round(start.PV_0, 4)
    (0.1762, 0.4716)
    """
    e_0 = -float(symmetric_error(loop, np.zeros(1))[0])
    x_0 = loop.x_rest + 0.5 * loop.J
    return replace(loop, PV_0=loop.SP - e_0, x_0=x_0, z_0=x_0 + loop.f_c - loop.K_p * e_0)

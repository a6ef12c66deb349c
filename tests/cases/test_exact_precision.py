"""The exact automaton against the same loop in 50-digit arithmetic, by Taylor series: another method, other numbers."""

from __future__ import annotations

from decimal import Decimal, getcontext

import numpy as np
import pytest
from stickslip.cases.exact import IDEAL_HIGH, IDEAL_NORMAL, INTEGRATOR_HIGH, ExactLoop, exact_run, symmetric_start

TERMS = 26
ZERO = Decimal(0)


class Taylor:
    """The loop from (y, z, x, v), slipping in direction s or stuck (s = 0), as power series of the time in one step."""

    def __init__(self, loop: ExactLoop, state: list[Decimal], s: int) -> None:
        self.loop, self.s = loop, s
        number = {name: Decimal(getattr(loop, name)) for name in ("a", "b", "K_i", "K_p", "SP", "M", "k", "F_v", "F_c")}
        a, b, K_i, K_p, SP, M, k, F_v, F_c = number.values()
        series = [[value] for value in state]
        for n in range(TERMS):
            y, z, x, v = (column[n] for column in series)
            constant = Decimal(n == 0)
            force = k * (K_p * (SP * constant - y) + z - x) - F_v * v - s * F_c * constant
            slopes = (a * y + b * x, K_i * (SP * constant - y), v, force / M)
            for column, slope, moves in zip(series, slopes, (True, True, s != 0, s != 0), strict=True):
                column.append(slope / (n + 1) if moves else ZERO)
        self.series = series

    def at(self, t: Decimal) -> list[Decimal]:
        values = []
        for column in self.series:
            value = ZERO
            for coefficient in reversed(column):
                value = value * t + coefficient
            values.append(value)
        return values

    def past(self, t: Decimal) -> bool:
        y, z, x, v = self.at(t)
        if self.s:
            return t > 0 and self.s * v <= 0
        pull = Decimal(self.loop.K_p) * (Decimal(self.loop.SP) - y) + z - x
        return abs(pull) * Decimal(self.loop.k) > Decimal(self.loop.F_s)


def fifty_digits(loop: ExactLoop, t_log: np.ndarray) -> tuple[np.ndarray, list[Decimal]]:
    """States at the log times, shape (n, 4), and the event times."""
    getcontext().prec = 50
    state = [Decimal(loop.PV_0), Decimal(loop.z_0), Decimal(loop.x_0), ZERO]
    t, s, events, logged = ZERO, 0, [], []
    end = Decimal(float(t_log[-1]))
    while len(logged) < t_log.size:
        step = Decimal("0.002") if s else Decimal(1)
        piece = Taylor(loop, state, s)
        if s == 0 and piece.past(ZERO):
            step, found = ZERO, True
        else:
            found = piece.past(step)
        if found and step > 0:
            low, high = ZERO, step
            for _ in range(110):
                middle = (low + high) / 2
                low, high = (low, middle) if piece.past(middle) else (middle, high)
            step = high
        while len(logged) < t_log.size and Decimal(float(t_log[len(logged)])) <= t + step:
            logged.append(piece.at(Decimal(float(t_log[len(logged)])) - t))
        t, state = t + step, piece.at(step)
        if found:
            events.append(t)
            y, z, x, _ = state
            pull = Decimal(loop.K_p) * (Decimal(loop.SP) - y) + z - x
            state[3] = ZERO
            s = 0 if s else int(pull.copy_sign(1) / pull)
        if t > end:
            break
    return np.array(logged, dtype=float), events


@pytest.mark.parametrize(
    "loop",
    [
        IDEAL_HIGH,
        symmetric_start(IDEAL_NORMAL),
        INTEGRATOR_HIGH,
        ExactLoop(K_p=0.7, T_i=4.0, SP=0.3, duration=200.0),  # no pole cancellation
    ],
    ids=["high", "normal", "integrator", "tight"],
)
def test_signals_and_event_times_to_1e_12(loop: ExactLoop) -> None:
    """Analytic: both solve the same equations; 1e-12 is about ten times the rounding error met."""
    run = exact_run(loop)
    states, events = fifty_digits(loop, run.t)
    assert len(run.events) == len(events)
    assert len(events) >= 8  # otherwise this test has compared next to nothing
    np.testing.assert_allclose([event.t for event in run.events], [float(t) for t in events], rtol=0, atol=1e-11)
    for name, column, atol in zip(("PV", "z", "MV", "v"), states.T, (1e-13, 1e-13, 1e-12, 1e-10), strict=True):
        np.testing.assert_allclose(getattr(run, name), column, rtol=0, atol=atol, err_msg=name)

"""Dead time: everything arrives later by theta.

    y(t) = u(t - theta)         y = theta_start before the first value has arrived

in   in   any signal          out  out  the same signal, later          theta  dead time [s], >= 0

The engine delays exactly, breakpoints included (a ring buffer, no lags).  Python-control cannot; it sees the Pade
approximation of order 4 over 5, strictly proper: gain within 1 % and phase within 0.4 degrees up to omega theta = 5,
but a jump arrives smeared over 0.8 to 1.2 theta, with ripples of up to 16 % of it before.  The class ``Delayed``
gives the same two views to any block with one input and a dead time in front of it.
See also: first_order, second_order, integrator (theta=).
"""

import math
from collections.abc import Mapping
from typing import Any, Self

import numpy as np
from stickslip.blocks.block import Block, Floats, Kernels
from stickslip.blocks.ports import BlockError, Port, require
from stickslip.blocks.role import Role

ORDER = 5


def pade() -> tuple[Floats, Floats]:
    """Return A [1/theta] and C of the Pade approximation (ORDER - 1 over ORDER) of a dead time; B is (1, 0, ..).

    numerator  sum of m! (2n-1-k)! / ((2n-1)! k! (m-k)!) (-s)^k, k = 0 .. m;   denominator the same with n for m
    and s for -s;  n = ORDER, m = n - 1.  Controller form; every state rests at a finite multiple of the input.
    """
    n, m = ORDER, ORDER - 1
    top = [math.comb(m, k) * math.factorial(n + m - k) * (-1.0) ** k for k in range(m + 1)]
    bottom = [math.comb(n, k) * math.factorial(n + m - k) for k in range(n + 1)]
    A = np.zeros((n, n))
    A[0] = [-bottom[k] / bottom[n] for k in range(n - 1, -1, -1)]
    A[1:, :-1] = np.eye(n - 1)
    C = np.array([top[k] / bottom[n] for k in range(m, -1, -1)])
    return A, C


class Delayed(Block):
    """A block with one input that the engine delays by ``theta`` [s]; python-control sees a Pade approximation.

    Subclasses have the parameters ``theta`` and ``theta_start`` (the input before the start) among ``params``.
    """

    role = Role.PROCESS
    dead_time_param = "theta"
    before_param = "theta_start"

    @property
    def theta(self) -> float:
        """Dead time [s]."""
        return float(self.p[self.param_index("theta")])

    def seen_states(self) -> tuple[str, ...]:
        """Return the own states and, behind them, those of the Pade approximation if there is a dead time."""
        return (*self.state_names, *(f"pade_{i + 1}" for i in range(ORDER if self.theta > 0.0 else 0)))

    def seen_start(self) -> Floats:
        """Return the start values of ``seen_states``: the approximation rests at ``theta_start``."""
        if self.theta == 0.0:
            return self.x0
        A, _ = pade()
        rest = np.zeros(ORDER)
        rest[-1] = -self.value_before / A[0, -1]
        return np.concatenate([self.x0, rest])

    def with_params(self, **changes: float) -> Self:
        """Return a copy with other parameter values; see ``Block.with_params``."""
        other = super().with_params(**changes)
        other.set_states(list(other.seen_states()))
        return other

    def _update_params(self, params: Mapping[str, float] | None) -> None:
        super()._update_params(params)
        theta = float(self._p_now[self.param_index("theta")])
        if (theta > 0.0) != (self.theta > 0.0):
            raise BlockError(
                f"{self.name}: theta = {theta} changes the number of states that python-control sees; "
                f"build the block with a dead time, or use with_params(theta={theta})"
            )

    def _late(self, x: Floats, u: Floats) -> Floats:
        return np.array([pade()[1] @ x[len(self.x0) :]])

    def _rhs(self, t: float, x: Floats, u: Floats) -> Floats:
        if self.theta == 0.0:
            return super()._rhs(t, x, u)
        own = super()._rhs(t, x[: len(self.x0)], self._late(x, u))
        rate = pade()[0] @ x[len(self.x0) :]
        rate[0] += u[0]
        return np.concatenate([own, rate / self._p_now[self.param_index("theta")]])

    def _out(self, t: float, x: Floats, u: Floats) -> Floats:
        if self.theta == 0.0:
            return super()._out(t, x, u)
        return super()._out(t, x[: len(self.x0)], self._late(x, u))


def check_dead_time(params: Mapping[str, float], name: str) -> None:
    """Raise ``BlockError`` unless theta >= 0 and theta_start is finite."""
    theta, before = float(params["theta"]), float(params["theta_start"])
    require(0.0 <= theta < math.inf, name, "theta", theta, "a dead time is finite and not negative", "give 0 or more")
    require(math.isfinite(before), name, "theta_start", before, "it must be a finite number", "give a number")


def _out(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    y[0] = u[0]


class DeadTime(Delayed):
    """A pure dead time of ``theta`` [s]; ``start`` is its output until the first input arrives.

    ``start`` has the unit of the input [unit of in].
    Raises ``BlockError`` for a negative or infinite dead time.

    >>> from stickslip.diagram import drive
    >>> late = DeadTime(1.5, inputs="flow", outputs="late")
    >>> drive(late, 4.0, every=1.0, flow=([0, 4], [0.0, 4.0])).log["late"].round(6).tolist()
    [0.0, 0.0, 0.5, 1.5, 2.5]
    """

    ports_in = (Port("in"),)
    ports_out = (Port("out"),)
    kernels = Kernels(out=_out)

    def __init__(self, theta: float, *, start: float = 0.0, name: str = "dead_time", **labels: Any) -> None:
        super().__init__(name=name, params={"theta": theta, "theta_start": start}, **labels)

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` unless theta >= 0 and the start is finite."""
        check_dead_time(params, name)

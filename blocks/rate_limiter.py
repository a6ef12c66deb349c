"""Rate limiter: the output follows its input, but no faster than a rate up and a rate down.

    following   y = u                       while -down <= du/dt <= up
    rising      dy/dt = up                  until y meets u
    falling     dy/dt = -down               until y meets u

in   in  any signal, named second          out  out  the same signal, slowed down, named first
up, down   largest rates [unit of the signal per s], > 0; inf: not limited on this side
start      y at the start [unit of the signal]; without it y starts at u

It lets go of u where the slope of u passes a limit, or u jumps, and meets u again where they cross; both instants are
located and logged.  A slope within a millionth of a limit is still followed.  Python-control, which knows neither
events nor slopes, sees y = u; with ``start``, dy/dt = CHASE (u - y) within the limits, which lags by 5 ms.
Valid for any signal; noise makes it let go and meet at every sample.  Source: textbook.
See also: saturation, lead_lag, first_order (a lag is slower the nearer it comes; a rate limiter is not).
"""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from stickslip.blocks.block import Floats, Kernels
from stickslip.blocks.one_to_one import OneToOne
from stickslip.blocks.ports import require
from stickslip.blocks.role import Role

FOLLOWING, RISING, FALLING = 0.0, 1.0, -1.0
TIE = 1.0 + 1e-6  # a slope is known so exactly: one at the limit must not let go and meet for ever
CHASE = 200.0  # [1/s]
NEAR = 2e-6  # [s]: output and input have met if the limiter needs no longer to close the gap.  Slopes are looked at
#              so far ahead, so that it may let go of u this much before a kink


def _out(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    y[0] = u[0] if d[0] == FOLLOWING else x[0]


def _der(t: float, x: Any, d: Any, u: Any, p: Any, dx: Any) -> None:
    if d[0] == FOLLOWING:
        dx[0] = 0.0
    else:
        dx[0] = p[0] if d[0] == RISING else -p[1]


def _zc(t: float, x: Any, d: Any, u: Any, p: Any, g: Any) -> None:
    g[1] = -1.0
    if d[0] == FOLLOWING:
        g[0] = u[1] - p[0] * TIE
        g[1] = -u[1] - p[1] * TIE
    else:
        beyond = d[0] * (x[0] - u[0])
        limit = p[0] if d[0] == RISING else p[1]
        g[0] = max(min(beyond, limit - d[0] * u[1]), beyond - NEAR * limit)


def _jump(t: float, x: Any, d: Any, u: Any, p: Any, k: Any) -> None:
    if d[0] == FOLLOWING:
        x[0] = u[0]
    gap = u[0] - x[0]
    near = NEAR * min(p[0], p[1])
    if abs(gap) <= near:
        x[0] = u[0]
    if p[0] < math.inf and (gap > near or (gap >= -near and u[1] > p[0] * TIE)):
        d[0] = RISING
    elif p[1] < math.inf and (gap < -near or (gap <= near and u[1] < -p[1] * TIE)):
        d[0] = FALLING
    else:
        d[0] = FOLLOWING


class RateLimiter(OneToOne):
    """``signal`` is ``source``, rising by at most ``up`` and falling by at most ``down`` [unit per s].

    ``down``: as ``up`` unless given.  Raises ``BlockError`` unless both are positive and one is finite.

    >>> from stickslip.blocks import Step
    >>> from stickslip.diagram import drive
    >>> step = Step("SP", 0.25, at=1.0)
    >>> drive(RateLimiter("SP_r", "SP", 0.1), 4.0, every=1.0, SP=step).log["SP_r"].round(3).tolist()
    [0.0, 0.0, 0.1, 0.2, 0.25]
    """

    role = Role.ARITHMETIC
    kernels = Kernels(out=_out, der=_der, zc=_zc, jump=_jump, n_events=2, rates=True, linear=True)
    modes = {"following": FOLLOWING, "rising": RISING, "falling": FALLING}
    same_unit = True

    def __init__(
        self,
        signal: str,
        source: str,
        up: float,
        down: float | None = None,
        *,
        start: float | None = None,
        unit: str = "",
        name: str = "",
    ) -> None:
        params = {"up": up, "down": up if down is None else down}
        mode = FOLLOWING if start is None else RISING if params["up"] < math.inf else FALLING
        states = {"y": 0.0 if start is None else start}
        super().__init__(signal, source, params, states=states, memory={"mode": mode}, unit=unit, name=name)

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` unless up, down > 0 and one of them is finite."""
        for key in ("up", "down"):
            rate = float(params[key])
            require(rate > 0.0, name, key, rate, "a rate is positive on either side", "give units per second")
        up, down = float(params["up"]), float(params["down"])
        require(min(up, down) < math.inf, name, "up", up, "one of up and down is finite", "give the rate to limit")

    def unseen(self) -> str:
        """Return the limits while it follows; with ``start`` they are seen."""
        return "the limits" if self.d0[0] == FOLLOWING else ""

    def _rhs(self, t: float, x: Floats, u: Floats) -> Floats:
        up, down = self._p_now
        follows = self.d0[0] == FOLLOWING
        return np.zeros(1) if follows else np.array([min(max(CHASE * (u[0] - x[0]), -down), up)])

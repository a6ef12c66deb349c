"""Saturation: a signal kept between a low and a high limit.

    y = low if u < low,   high if u > high,   else u

in   in  any signal, named second          out  out  the same signal within its limits, named first
low, high  limits [unit of the signal], low < high; -inf and inf lift them

The instants at which a limit takes hold and lets go are located and logged (modes of limits).
Valid for any signal; a static block.  Source: textbook.
See also: dead_zone, rate_limiter, sensor (limits of a transmitter), pi (limits with anti-windup).
"""

import math
from collections.abc import Mapping
from typing import Any

from stickslip.blocks.block import Kernels
from stickslip.blocks.limits import FREE, MODES, limit_events, limit_transition
from stickslip.blocks.one_to_one import OneToOne
from stickslip.blocks.role import Role
from stickslip.blocks.rules import check_limits


def _out(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    y[0] = min(max(u[0], p[0]), p[1])


def _zc(t: float, x: Any, d: Any, u: Any, p: Any, g: Any) -> None:
    limit_events(u[0], p[0], p[1], d, g)


class Saturation(OneToOne):
    """A limiter: ``signal`` is ``source`` kept within ``low`` ... ``high`` [unit of the signal].

    Raises ``BlockError`` unless low < high.

    >>> valve = Saturation("x", "OP", low=0.0, high=1.0)
    >>> [float(valve.output(0.0, [], [OP])[0]) for OP in (-0.2, 0.3, 1.4)]
    [0.0, 0.3, 1.0]
    """

    role = Role.ARITHMETIC
    kernels = Kernels(out=_out, zc=_zc, jump=limit_transition, n_events=2, linear=True)
    modes = MODES
    same_unit = True

    def __init__(
        self,
        signal: str,
        source: str,
        low: float = -math.inf,
        high: float = math.inf,
        *,
        unit: str = "",
        name: str = "",
    ) -> None:
        super().__init__(signal, source, {"low": low, "high": high}, memory={"mode": FREE}, unit=unit, name=name)

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` unless low < high."""
        check_limits(params, name)

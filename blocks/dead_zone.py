"""Dead zone: nothing comes through until the signal leaves a zone, from there on the rest of it.

    y = u - high if u > high,   u - low if u < low,   0 in between

in   in  any signal, named second          out  out  what exceeds the zone, named first
low, high  edges of the zone [unit of the signal], low < high; inf or -inf: the zone does not end on this side

The edges are located and logged: modes "inside", "above", "below".  It has no memory; play, which has one and is what
a worn linkage does, is deadband.  A controller with a gap on its error has a dead zone: it does nothing for small
errors.  Valid for any signal; a static block.  Source: textbook, for example Khalil, Nonlinear Systems, 3rd ed. 2002,
section 1.2.7.
See also: deadband (play, with memory), saturation.
"""

import math
from collections.abc import Mapping
from typing import Any, Self

import numpy as np
from stickslip.blocks.block import Floats, Kernels
from stickslip.blocks.limits import FREE, HIGH, LOW, limit_events, limit_transition
from stickslip.blocks.one_to_one import OneToOne
from stickslip.blocks.ports import require
from stickslip.blocks.role import Role
from stickslip.blocks.rules import check_limits


def _out(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    if d[0] == FREE:
        y[0] = 0.0
    else:
        y[0] = u[0] - (p[1] if d[0] == HIGH else p[0])


def _zc(t: float, x: Any, d: Any, u: Any, p: Any, g: Any) -> None:
    limit_events(u[0], p[0], p[1], d, g)


class DeadZone(OneToOne):
    """The excess of ``source`` beyond ``low`` ... ``high`` [unit of the signal]; 0 in between.

    ``DeadZone.of_width`` gives a zone around 0.  Raises ``BlockError`` unless low < high.

    >>> gap = DeadZone("e_gap", "e", low=-0.1, high=0.2)
    >>> [round(float(gap.output(0.0, [], [e])[0]), 9) for e in (-0.3, 0.0, 0.5)]
    [-0.2, 0.0, 0.3]
    """

    role = Role.ARITHMETIC
    kernels = Kernels(out=_out, zc=_zc, jump=limit_transition, n_events=2, linear=True)
    modes = {"inside": FREE, "above": HIGH, "below": LOW}
    same_unit = True

    def __init__(self, signal: str, source: str, low: float, high: float, *, unit: str = "", name: str = "") -> None:
        super().__init__(signal, source, {"low": low, "high": high}, memory={"mode": FREE}, unit=unit, name=name)

    @classmethod
    def of_width(cls, signal: str, source: str, width: float, **keywords: Any) -> Self:
        """Return the zone -width/2 ... width/2; raise ``BlockError`` unless the width is positive.

        >>> DeadZone.of_width("e_gap", "e", 0.2).p.tolist()
        [-0.1, 0.1]
        """
        name = str(keywords.get("name", signal))
        require(0.0 < width < math.inf, name, "width", width, "a zone has a positive, finite width", "give one")
        return cls(signal, source, -0.5 * width, 0.5 * width, **keywords)

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` unless low < high."""
        check_limits(params, name)

    def seen_memory(self, x: Floats, u: Floats) -> Floats:
        """Return the mode, shape (1,), that the present input calls for."""
        low, high = self._p_now
        return np.array([HIGH if u[0] > high else LOW if u[0] < low else FREE])

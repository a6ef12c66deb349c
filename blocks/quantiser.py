"""Quantiser: a signal known in whole steps only, as a converter of few bits gives it.

    y = step floor(u/step + 1/2)

in   in  any signal, named second          out  out  the nearest multiple of ``step``, named first
step  [unit of the signal], > 0

The instants at which y moves on to the next multiple are located.  Having crossed an edge, y goes back over the same
edge only when u has gone back by 1 % of a step more: a controller that sees y would else be drawn over an edge and back
without end.  Half way between two multiples the higher one is taken.
Valid for any signal; a noisy one crosses an edge at every turn.  Source: textbook.
See also: sensor (SampledSensor: quantisation at scan times), saturation, lookup_1d.
"""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from stickslip.blocks.block import Floats, Kernels
from stickslip.blocks.limits import BAND
from stickslip.blocks.one_to_one import OneToOne
from stickslip.blocks.role import Role
from stickslip.blocks.rules import positive

BACK = 0.01  # of a step: how far back over an edge before it counts
MOST = 2.0**52  # steps: beyond, every number is a whole number of them


def _out(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    y[0] = p[0] * d[0]


def _zc(t: float, x: Any, d: Any, u: Any, p: Any, g: Any) -> None:
    above = u[0] - p[0] * d[0]
    band = BAND * (p[0] + abs(u[0]))
    g[0] = above - 0.5 * p[0] - (BACK * p[0] if d[1] < 0.0 else band)
    g[1] = -above - 0.5 * p[0] - (BACK * p[0] if d[1] > 0.0 else band)


def _jump(t: float, x: Any, d: Any, u: Any, p: Any, k: Any) -> None:
    nearest = math.floor(u[0] / p[0] + 0.5) if abs(u[0]) < MOST * p[0] else d[0]
    if k[0] == 0.0:
        d[0] = max(nearest, d[0] + 1.0)
        d[1] = 1.0
    else:
        d[0] = min(nearest, d[0] - 1.0)
        d[1] = -1.0


class Quantiser(OneToOne):
    """``source`` rounded to multiples of ``step`` [unit of the signal].

    Raises ``BlockError`` unless step > 0.

    >>> from stickslip.diagram import drive
    >>> drive(Quantiser("y", "u", step=0.5), 2.0, every=0.5, u=([0.0, 2.0], [0.1, 1.1])).log["y"].tolist()
    [0.0, 0.5, 0.5, 1.0, 1.0]
    """

    role = Role.ARITHMETIC
    kernels = Kernels(out=_out, zc=_zc, jump=_jump, n_events=2, jumps=True)
    discrete = ("multiple",)
    same_unit = True

    def __init__(self, signal: str, source: str, step: float, *, unit: str = "", name: str = "") -> None:
        super().__init__(signal, source, {"step": step}, memory={"multiple": 0.0, "came": 0.0}, unit=unit, name=name)

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` unless step > 0."""
        positive(params, name, "step", remedy="give the resolution; without one leave the quantiser out")

    def seen_memory(self, x: Floats, u: Floats) -> Floats:
        """Return the multiple that is nearest to the present input, shape (2,): nothing was crossed before."""
        return np.array([math.floor(u[0] / self._p_now[0] + 0.5), 0.0])

"""A tank that empties through a hole and runs over at its rim.

    A dh/dt = q_in - k sqrt(h)              while h < top
    h = top                                 while q_in - k sqrt(h), which runs over, is not negative

in   q_in   inflow [unit of k sqrt(h)]        out  h       level
A    area [inflow s per unit of h], > 0            q_out   outflow k sqrt(h) [as q_in]
k    outlet [as q_in per sqrt(level)], >= 0        start   h at the start [unit of h]
top  the rim [unit of h], > 0; inf: no rim

Torricelli's law; the instants at which it starts and ceases to run over are located and logged.  Levels below 0 count
as 0 for the outlet.  What runs over follows the inflow at once, so it is a block of its own (``Overflow``), and the
tank may stand in a level loop.  Valid for an open tank of constant area and a short outlet with turbulent flow; not for
a closed vessel (separator, plenum).  Source: textbook; Schoukens and Noel, Three benchmarks addressing open challenges
in nonlinear system identification, IFAC 2017 (two such tanks, which run over).  See also: overflow, integrator.
"""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from stickslip.blocks.block import Block, Floats, Kernels
from stickslip.blocks.limits import BAND
from stickslip.blocks.ports import Port, require
from stickslip.blocks.role import Role
from stickslip.blocks.rules import not_negative, positive

FILLING, FULL = 0.0, 1.0

# p = A, k, top; x = h; d = mode


def _out(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    y[0] = x[0]
    y[1] = p[1] * math.sqrt(max(x[0], 0.0))


def _der(t: float, x: Any, d: Any, u: Any, p: Any, dx: Any) -> None:
    dx[0] = 0.0 if d[0] == FULL else (u[0] - p[1] * math.sqrt(max(x[0], 0.0))) / p[0]


def _zc(t: float, x: Any, d: Any, u: Any, p: Any, g: Any) -> None:
    net = u[0] - p[1] * math.sqrt(max(x[0], 0.0))
    band = BAND * (1.0 + abs(u[0]))
    if d[0] == FULL:
        g[0] = -net - band
    else:
        g[0] = x[0] - p[2] if net > band else -1.0


def _jump(t: float, x: Any, d: Any, u: Any, p: Any, k: Any) -> None:
    if d[0] == FULL:
        d[0] = FILLING
    else:
        d[0] = FULL
        x[0] = p[2]


class Tank(Block):
    """A tank of area ``A`` with an outlet ``k`` and a rim at ``top``; units as in the module's page.

    ``start``: level at the start [unit of h].  Raises ``BlockError`` unless A, top > 0 and k >= 0.

    >>> from stickslip.diagram import drive
    >>> log = drive(Tank(A=2.0, k=0.0, top=1.0), 4.0, every=1.0, q_in=1.0).log
    >>> log["h"].round(6).tolist(), log["q_out"].tolist()
    ([0.0, 0.5, 1.0, 1.0, 1.0], [0.0, 0.0, 0.0, 0.0, 0.0])
    """

    role = Role.PROCESS
    ports_in = (Port("q_in"),)
    ports_out = (Port("h"), Port("q_out"))
    kernels = Kernels(out=_out, der=_der, zc=_zc, jump=_jump, n_events=1, feeds=False, jumps=True)
    modes = {"filling": FILLING, "running over": FULL}

    def __init__(
        self, A: float = 1.0, k: float = 1.0, top: float = math.inf, *, start: float = 0.0, name: str = "tank",
        **labels: Any,
    ) -> None:  # fmt: skip
        super().__init__(
            name=name,
            params={"A": A, "k": k, "top": top},
            states={"h": start},
            memory={"mode": FILLING},
            **labels,
        )

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` unless A > 0, k >= 0 and top > 0."""
        positive(params, name, "A")
        not_negative(params, name, "k")
        top = float(params["top"])
        require(top > 0.0, name, "top", top, "the rim lies above the bottom", "give a level, or inf for no rim")

    def seen_memory(self, x: Floats, u: Floats) -> Floats:
        """Return the mode, shape (1,): whether the tank is full and more flows in than out."""
        full = x[0] >= self._p_now[2] and u[0] >= self._p_now[1] * math.sqrt(max(x[0], 0.0))
        return np.array([FULL if full else FILLING])

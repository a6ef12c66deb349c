"""Liquid that runs over the rim of a tank.

    q_over = q_in - q_out     while h = top and that is not negative, else 0

in   q_in, q_out, h   of the tank (``Tank``): inflow, outflow, level       out  q_over  what runs over [as q_in]
top  the rim, the same as the tank's [unit of h], > 0

The tank holds its level at the rim, and locates the instants at which it starts and ceases to run over.
Valid behind a ``Tank`` of the same ``top``; not behind a level that something else limits or measures.
Source: mass balance.  See also: tank.
"""

import math
from collections.abc import Mapping
from typing import Any

from stickslip.blocks.block import Block, Kernels
from stickslip.blocks.ports import Port, require
from stickslip.blocks.role import Role


def _out(q_in: float, q_out: float, h: float, top: float) -> float:
    return max(q_in - q_out, 0.0) if h >= top else 0.0


class Overflow(Block):
    """The flow over the rim at ``top`` [unit of h] of a tank; the block reads the flows and the level of the tank.

    Raises ``BlockError`` unless top > 0.

    >>> from stickslip.blocks import Step, Tank
    >>> from stickslip.diagram import simulate, wire
    >>> tank = wire([Step("q_in", 1.0), Tank(A=2.0, k=0.0, top=1.0), Overflow(top=1.0)])
    >>> simulate(tank, 4.0, every=1.0).log["q_over"].round(6).tolist()
    [0.0, 0.0, 1.0, 1.0, 1.0]
    """

    role = Role.ARITHMETIC
    ports_in = (Port("q_in"), Port("q_out"), Port("h"))
    ports_out = (Port("q_over"),)
    kernels = Kernels(out=_out)

    def __init__(self, top: float = math.inf, *, name: str = "overflow", **labels: Any) -> None:
        super().__init__(name=name, params={"top": top}, **labels)

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` unless top > 0."""
        top = float(params["top"])
        require(top > 0.0, name, "top", top, "the rim lies above the bottom", "give the tank's, or inf for no rim")

"""Gas cooler and scrubber between separator and compressor: ideal, only their pressure loss is felt.

    p_out = p - dp

in   p  pressure before the cooler [Pa]    out  p_out  pressure behind the scrubber [Pa]      dp  loss [Pa], >= 0

Cooler and scrubber are one block, for the thesis lets them act without dynamics and leaves one extra pressure drop.
The cooler's fall of temperature is a constant, too: the separator computes with T_sep (308.15 K), plena and compressor
behind the cooler with the speed of sound c_01 at T_c (302.95 K), so no signal carries it.  What condenses is neglected.
Valid for a constant loss; one that grows with the flow belongs into the flow coefficient of the valve behind it.
Not for: the cooler's duty, cooling water, liquid carried over.
Source: thesis section 3.3; the size of the loss is an engineering choice [E].  See also: separator, plenum.
"""

import math
from collections.abc import Mapping
from typing import Any

from stickslip.blocks.block import Block, Kernels
from stickslip.blocks.ports import Port, require
from stickslip.blocks.role import Role


def _out(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    y[0] = u[0] - p[0]


class Scrubber(Block):
    """Cooler and scrubber with the pressure loss ``dp`` [Pa].

    Raises ``BlockError`` for a negative loss.

    >>> float(Scrubber(0.1e5).output(0.0, [], [30e5])[0])
    2990000.0
    """

    role = Role.PROCESS
    ports_in = (Port("p", "Pa"),)
    ports_out = (Port("p_out", "Pa"),)
    kernels = Kernels(out=_out)

    def __init__(self, dp: float = 0.1e5, *, name: str = "scrubber", **labels: Any) -> None:
        super().__init__(name=name, params={"dp": dp}, **labels)

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` for a negative loss."""
        dp = float(params["dp"])
        require(0.0 <= dp < math.inf, name, "dp", dp, "a pressure loss is not negative", "give Pa")

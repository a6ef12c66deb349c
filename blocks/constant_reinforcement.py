"""Constant reinforcement: OP is pushed on by a constant in the way in which the controller moves it.

    OP = OP_c + a way,   way = sgn(OP_c(k) - OP_c(k-1)), kept while OP_c stands still

in   OP_c  output of the controller [unit of OP]        out  OP  to the valve [unit of OP]
a    what is added [unit of OP]: the dead travel S - J is made good by (S - J)/2, stick by up to (S + J)/2; 0: off
hold how far OP_c must go back before ``way`` turns [unit of OP]: above the noise in OP_c
dt   scan [s]

It takes the dead travel of the valve out of the loop, as an inverse of play does.
Not for: OP_c with noise above ``hold`` (the stem is shaken from side to side), S that is not known or changes (too much
of it makes a limit cycle of its own), a valve with positioner.
Source: L. Z. X. Ivan, S. Lakshminarayanan, A new unified approach to valve stiction quantification and compensation,
Ind. Eng. Chem. Res. 48 (2009) 3474-3483; ``hold`` is ours, 0 gives theirs.
See also: knocker, two_move.
"""

from collections.abc import Mapping
from typing import Any

from stickslip.blocks.block import Block, Kernels
from stickslip.blocks.ports import Port
from stickslip.blocks.role import Role
from stickslip.blocks.rules import check_scan, not_negative


def _step(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    moved = u[0] - d[0]  # d: farthest OP_c on this way, way
    if d[1] != 0.0 and moved * d[1] >= 0.0:
        d[0] = u[0]
    elif abs(moved) > p[1]:
        d[0] = u[0]
        d[1] = 1.0 if moved > 0.0 else -1.0
    y[0] = u[0] + p[0] * d[1]


class ConstantReinforcement(Block):
    """``a`` [unit of OP] on top of OP_c, in the way it goes; it turns when OP_c has gone back by ``hold``.

    ``start``: OP_c before the first scan [unit of OP]; ``offset``: first scan [s].
    Raises ``BlockError`` unless a, hold >= 0 and dt > 0.

    >>> from stickslip.diagram import drive
    >>> more = ConstantReinforcement(a=0.02, dt=1.0)
    >>> drive(more, 4.0, every=1.0, OP_c=([0.0, 2.0, 4.0], [0.0, 0.2, 0.0])).log["OP"].round(3).tolist()
    [0.0, 0.12, 0.22, 0.08, -0.02]
    """

    role = Role.ARITHMETIC
    ports_in = (Port("OP_c"),)
    ports_out = (Port("OP"),)
    kernels = Kernels(step=_step)
    discrete = ("way",)
    period_param = "dt"
    offset_param = "offset"

    def __init__(
        self,
        a: float,
        dt: float,
        *,
        hold: float = 0.0,
        offset: float = 0.0,
        start: float = 0.0,
        name: str = "reinforcement",
        **labels: Any,
    ) -> None:
        super().__init__(
            name=name,
            params={"a": a, "hold": hold, "dt": dt, "offset": offset},
            memory={"OP_last": start, "way": 0.0},
            start_output=start,
            **labels,
        )

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` unless a, hold >= 0 and dt > 0."""
        check_scan(params, name)
        not_negative(params, name, "a", "hold")

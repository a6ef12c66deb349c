"""Diagrams near an operating point, for control engineers.

operating_point   where a diagram rests            linearise   transfer functions, poles, loops, RGA of it
open_loop         one loop opened at its OP        rga         relative gain array
"""

from stickslip.diagram.linear.gain_arrays import Rga
from stickslip.diagram.linear.linearisation import Linear, linearise, open_loop, rga
from stickslip.diagram.linear.loop import Loop
from stickslip.diagram.linear.operating_points import NoOperatingPoint, OperatingPoint, operating_point
from stickslip.diagram.linear.poles import Pole

__all__ = [
    "Linear",
    "Loop",
    "NoOperatingPoint",
    "OperatingPoint",
    "Pole",
    "Rga",
    "linearise",
    "open_loop",
    "operating_point",
    "rga",
]

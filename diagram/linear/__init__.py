"""Diagrams near an operating point, for control engineers.

operating_point   where a diagram rests            linearise   transfer functions, poles, loops, RGA of it
open_loop         one loop opened at its OP        rga         relative gain array
"""

from diagram.linear.gain_arrays import Rga
from diagram.linear.linearisation import Linear, linearise, open_loop, rga
from diagram.linear.loop import Loop
from diagram.linear.operating_points import NoOperatingPoint, OperatingPoint, operating_point
from diagram.linear.poles import Pole

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

"""Diagrams near an operating point, for control engineers.

operating_point   where a diagram rests            linearise   transfer functions, poles, loops, RGA of it
open_loop         one loop opened at its OP        rga         relative gain array
"""

from plant.linear.linearise import Linear, linearise, open_loop, rga
from plant.linear.loop import Loop
from plant.linear.operating_point import NoOperatingPoint, OperatingPoint, operating_point
from plant.linear.poles import Pole
from plant.linear.rga import Rga

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

"""Join blocks into diagrams and run them.

wire       blocks and diagrams joined by signal names      Diagram    what it returns, a python-control system
simulate   the compiled engine                             drive      one block alone
ensemble   one diagram over thousands of parameter sets    reference  slow, independent integrators
linear     operating points, poles, loops, relative gains  study      sweeps, and what oscillates in them
"""

from plant.diagram import Diagram, wire
from plant.drive import drive
from plant.ensemble import ensemble
from plant.portfolio import Ensemble
from plant.simulate import Event, Run, simulate
from plant.wiring import WiringError

__all__ = ["Diagram", "Ensemble", "Event", "Run", "WiringError", "drive", "ensemble", "simulate", "wire"]

"""Join blocks into diagrams and run them.

wire       blocks and diagrams joined by signal names      Diagram    what it returns, a python-control system
simulate   the compiled engine                             drive      one block alone
ensemble   one diagram over thousands of parameter sets    reference  slow, independent integrators
linear     operating points, poles, loops, relative gains      held, interpolated   a log as input of a run
replay     a diagram held to a log at every logged time        residuals            what had to be added there
Settings   tolerances and method, for all of these alike
"""

from diagram.composition import wire
from diagram.diagram import Diagram
from diagram.ensembles import ensemble
from diagram.ensembles.result import Ensemble
from diagram.pins import replay, replays, residuals
from diagram.playback import held, interpolated
from diagram.settings import Settings
from diagram.simulation import Event, Run, simulate
from diagram.single_block import drive
from diagram.wiring import WiringError

__all__ = [
    "Diagram",
    "Ensemble",
    "Event",
    "Run",
    "Settings",
    "WiringError",
    "drive",
    "ensemble",
    "held",
    "interpolated",
    "replay",
    "replays",
    "residuals",
    "simulate",
    "wire",
]

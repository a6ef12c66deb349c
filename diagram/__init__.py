"""Join blocks into diagrams and run them.

wire       blocks and diagrams joined by signal names      Diagram    what it returns, a python-control system
simulate   the compiled engine                             drive      one block alone
ensemble   one diagram over thousands of parameter sets    reference  slow, independent integrators
linear     operating points, poles, loops, relative gains      held, interpolated   a log as input of a run
replay     a diagram held to a log at every logged time        residuals            what had to be added there
Settings   tolerances and method, for all of these alike
"""

from stickslip.diagram.composition import wire
from stickslip.diagram.diagram import Diagram
from stickslip.diagram.ensembles import ensemble
from stickslip.diagram.ensembles.result import Ensemble
from stickslip.diagram.pins import replay, replays, residuals
from stickslip.diagram.playback import held, interpolated
from stickslip.diagram.run_events import Event
from stickslip.diagram.settings import Settings
from stickslip.diagram.simulation import Run, simulate
from stickslip.diagram.single_block import drive
from stickslip.diagram.wiring import WiringError

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

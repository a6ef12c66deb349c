"""Sticky control valves: simulate them, find them in routine data, and say what a model of a loop lacks.

>>> import stickslip as ss
>>> process = ss.blocks.FirstOrder(3.0, 10.0, inputs="OP")
>>> loop = ss.wire([ss.blocks.Step("SP", after=0.5), ss.blocks.PI(0.4, 10.0), process])
>>> round(float(ss.simulate(loop, 60.0).log["PV"][-1]), 5)  # analytic: 0.5 (1 - exp(-1.2/10*60))
0.49963

wire       blocks joined to a diagram             read_loop  a file -> a ``LoopRecord``
simulate   a run, with its log                    diagnose   a record -> does the valve stick?
drive      one block alone                        compare    a record -> all methods side by side
ensemble   one diagram, many parameters           survey     the loops of one plant, judged together
replay     a diagram held to a log                fit        a record -> the loop as a model
residuals  what had to be added there             remedies   a fitted loop -> what to do about its valve

Rooms: blocks (``ss.blocks.PI``), diagram, logs, detect, gap (``ss.gap.diagnose``), remedy, study, scan, plant, cases.
Each is loaded when it is first used.
"""

import os
from importlib import import_module

if not os.path.isdir(os.path.join(__path__[0], "blocks")):  # a checkout: the rooms stand beside this folder
    __path__.append(os.path.dirname(__path__[0]))

__version__ = "0.2.0"
__all__ = [
    "Diagram", "Log", "LoopRecord", "Settings", "blocks", "cases", "compare", "detect", "diagnose", "diagram", "drive",
    "ensemble", "fit", "gap", "logs", "plant", "read_log", "read_loop", "read_loops", "remedies", "remedy", "replay",
    "residuals", "scan", "simulate", "study", "survey", "wire",
]  # fmt: skip

TYPE_CHECKING = False  # not of ``typing``, which a file of the user's may hide as long as ``__main__`` has not run
if TYPE_CHECKING:
    from stickslip import blocks, cases, detect, diagram, gap, logs, plant, remedy, scan, study
    from stickslip.detect import compare, diagnose, survey
    from stickslip.diagram import Diagram, Settings, drive, ensemble, replay, residuals, simulate, wire
    from stickslip.logs import Log, LoopRecord, read_log, read_loop, read_loops
    from stickslip.remedy import fit, remedies
else:
    _ROOM = {
        "detect": ("compare", "diagnose", "survey"),
        "diagram": ("Diagram", "Settings", "drive", "ensemble", "replay", "residuals", "simulate", "wire"),
        "logs": ("Log", "LoopRecord", "read_log", "read_loop", "read_loops"),
        "remedy": ("fit", "remedies"),
    }

    def __getattr__(name):
        """Load a room, or what a room gives, when it is asked for."""
        if name not in __all__:
            raise AttributeError(f"module 'stickslip' has no attribute '{name}'")
        for room, names in _ROOM.items():
            if name in names:
                return getattr(import_module(f"stickslip.{room}"), name)
        return import_module(f"stickslip.{name}")

    def __dir__():
        return [*__all__, "__version__"]

"""From a loop's own log to what to do about its valve: the fitted loop, and each remedy tried on it.

fit       a record -> a ``LoopFit``: controller, valve, process, load and noise, as loops about equally likely
remedies  a fit -> ``Advice``: each remedy simulated on these loops, one recommended until the shutdown and one at it
changes   two fits of one loop -> what has changed between them;  lacks: what a loop without stick lacks
cost      a fit -> what it costs to leave the stick: variability and travel
python_of a fit -> the loop as a Python file to edit
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from stickslip.remedy.advice import Advice, Cost, cost, remedies
    from stickslip.remedy.change import Change, Changes
    from stickslip.remedy.changing import changes, lacks
    from stickslip.remedy.fitting import fit
    from stickslip.remedy.loop_fit import LoopFit
    from stickslip.remedy.python_file import python_of
    from stickslip.remedy.refusal import FitError

__all__ = [
    "Advice", "Change", "Changes", "Cost", "FitError", "LoopFit", "changes", "cost", "fit", "lacks", "python_of",
    "remedies",
]  # fmt: skip

_FILE = {
    "advice": ("Advice", "Cost", "cost", "remedies"),
    "change": ("Change", "Changes"),
    "changing": ("changes", "lacks"),
    "fitting": ("fit",),
    "loop_fit": ("LoopFit",),
    "python_file": ("python_of",),
    "refusal": ("FitError",),
}


def __getattr__(name: str) -> Any:
    """Load what is asked for: a fit loads no simulator, and both take seconds to load."""
    for file, names in _FILE.items():
        if name in names:
            return getattr(import_module(f"{__name__}.{file}"), name)
    raise AttributeError(f"module '{__name__}' has no attribute '{name}'")

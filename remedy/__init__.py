"""From a loop's own log to what to do about its valve: the fitted loop, and each remedy tried on it.

fit       a record -> a ``LoopFit``: controller, valve, process, load and noise, as loops about equally likely
remedies  a fit -> ``Advice``: each remedy simulated on these loops, one recommended until the shutdown and one at it
changes   two fits of one loop -> what has changed between them;  lacks: what a loop without stick lacks
cost      a fit -> what it costs to leave the stick: variability and travel
python_of a fit -> the loop as a Python file to edit
"""

from stickslip.remedy.advice import Advice, Cost, cost, remedies
from stickslip.remedy.change import Change, Changes
from stickslip.remedy.changing import changes, lacks
from stickslip.remedy.fitting import FitError, fit
from stickslip.remedy.loop_fit import LoopFit
from stickslip.remedy.python_file import python_of

__all__ = [
    "Advice", "Change", "Changes", "Cost", "FitError", "LoopFit", "changes", "cost", "fit", "lacks", "python_of",
    "remedies",
]  # fmt: skip

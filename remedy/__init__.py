"""From a loop's own log to what to do about its valve: the fitted loop, and each remedy tried on it.

fit       a record -> a ``LoopFit``: controller, valve, process, load and noise, as loops about equally likely
remedies  a fit -> ``Advice``: each remedy simulated on these loops, one recommended until the shutdown and one at it
python_of a fit -> the loop as a Python file to edit
"""

from stickslip.remedy.advice import Advice, remedies
from stickslip.remedy.fitting import FitError, fit
from stickslip.remedy.loop_fit import LoopFit
from stickslip.remedy.python_file import python_of

__all__ = ["Advice", "FitError", "LoopFit", "fit", "python_of", "remedies"]

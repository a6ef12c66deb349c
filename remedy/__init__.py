"""From a loop's own log to what to do about its valve: the fitted loop, and each remedy tried on it.

fit       a record -> a ``LoopFit``: controller, valve, process, load and noise, as loops about equally likely
remedies  a fit -> ``Advice``: each remedy simulated on these loops, one recommended until the shutdown and one at it
"""

from remedy.advice import Advice, remedies
from remedy.fitting import FitError, fit
from remedy.loop_fit import LoopFit

__all__ = ["Advice", "FitError", "LoopFit", "fit", "remedies"]

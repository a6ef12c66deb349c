"""The sim-to-real gap: where a model and a log part, which effect would explain it, and how far it shrinks then.

diagnose   a diagram and a log -> a ``GapReport``      Effect     what an effect is; ``gap.effects`` has them all
calibrated a diagram and a log -> how often names are right there, counted on runs with known effects
"""

from gap.calibrate import calibrated
from gap.calibration import Calibration
from gap.diagnosis import diagnose
from gap.effect import Effect, EffectError, Parameter
from gap.record import GapError
from gap.report import GapReport

__all__ = ["Calibration", "Effect", "EffectError", "GapError", "GapReport", "Parameter", "calibrated", "diagnose"]

"""The sim-to-real gap: where a model and a log part, which effect would explain it, and how far it shrinks then.

diagnose   a diagram and a log -> a ``GapReport``      Effect     what an effect is; ``gap.effects`` has them all
"""

from gap.diagnosis import diagnose
from gap.effect import Effect, EffectError, Parameter
from gap.record import GapError
from gap.report import GapReport

__all__ = ["Effect", "EffectError", "GapError", "GapReport", "Parameter", "diagnose"]

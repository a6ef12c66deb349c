"""The sim-to-real gap: where a model and a log part, which effect would explain it, and how far it shrinks then.

diagnose   a diagram and a log -> a ``GapReport``      Effect     what an effect is; ``gap.effects`` has them all
calibrated a diagram and a log -> how often names are right there, counted on runs with known effects
latent_input a report and its log -> what the model would need beside its inputs, and what that goes with
replayed   a report and its log -> the log against the model, as it is and with the cause, over the worst stretch

The rooms, each of which uses those before it only; ``gap.diagnosis`` joins them:

answers        what a diagnosis answers with             effects       the catalogue: one file an effect
records        what a model and a log bring              fits          sizes of an effect, fitted to a record
insertion      how an effect gets into a diagram         explanations  one effect, two, none: side by side
floors         what a record without a gap would leave   telling       words, sizes, shrinkage, the next test
linearised     residuals of diagrams too large to replay between rows
filters        diagnosis by a Kalman filter, where loads are not measured and the loop is linear between scans
likelihood     one likelihood for any diagram, which is to take the place of the rest: not yet what ``diagnose`` asks
calibrating    how often names are right, on runs with known effects
"""

from gap.answers.report import GapReport
from gap.calibrating.calibrate import calibrated
from gap.calibrating.calibration import Calibration
from gap.diagnosis import diagnose
from gap.insertion.effect import Effect, EffectError, Parameter
from gap.records.record import GapError
from gap.telling.latent import LatentInput, latent_input
from gap.telling.replayed import Replayed, replayed

__all__ = [
    "Calibration", "Effect", "EffectError", "GapError", "GapReport", "LatentInput", "Parameter", "Replayed",
    "calibrated", "diagnose", "latent_input", "replayed",
]  # fmt: skip

"""The sim-to-real gap: where a model and a log differ, which effect explains it, and how far the gap shrinks then.

diagnose   a diagram and a log -> a ``GapReport``      Effect  what an effect is; all are in ``stickslip.gap.effects``
calibrated a diagram and a log -> how often names are right there, counted on runs with known effects
latent_input a report and its log -> what must be added to an input of the model, and with what it correlates
replayed   a report and its log -> the log against the model, as it is and with the cause, over the worst stretch

The rooms, each of which uses those before it only; ``stickslip.gap.diagnosis`` joins them:

answers        what a diagnosis answers with             effects       the catalogue: one file an effect
records        what a model and a log bring              insertion     how an effect gets into a diagram
null_model     what replays of a record without a gap leave
linearised     residuals of diagrams too large to replay between rows
fits           coordinates of sizes; plans, scans and digits that a log shows by itself
reporting      words, causes, places, pictures
exact          the Kalman filter of loops that are linear between scans
likelihood     how likely a record is, by a filter or by replays; the one search, test and report of all
hints          which mistake of the model or the log would explain what no effect does
calibrating    how often names are right, on runs with known effects
"""

from stickslip.gap.answers.report import GapReport
from stickslip.gap.calibrating.calibrate import calibrated
from stickslip.gap.calibrating.calibration import Calibration
from stickslip.gap.diagnosis import diagnose
from stickslip.gap.insertion.effect import Effect, EffectError, Parameter
from stickslip.gap.records.record import GapError
from stickslip.gap.reporting.latent import LatentInput, latent_input
from stickslip.gap.reporting.replayed import Replayed, replayed

__all__ = [
    "Calibration", "Effect", "EffectError", "GapError", "GapReport", "LatentInput", "Parameter", "Replayed",
    "calibrated", "diagnose", "latent_input", "replayed",
]  # fmt: skip

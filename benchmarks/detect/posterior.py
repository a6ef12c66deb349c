"""The stage that simulates loops like the record's, beside the calibrated model alone, on loops of another physics.

Both stages are asked about the same held-out loops; those whose stick lies above the detection limit known for them are
counted, too.  A record that shows too little counts with the probability 0.5.  What is asked is kept in a folder, a
line for every record, so that a second call goes on where the first was stopped.
"""

import statistics
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from math import inf
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from stickslip.calibration import LoopSpec, at_record, draw, simulate
from stickslip.calibration.by_simulation import together
from stickslip.calibration.posterior import log_odds
from stickslip.calibration.records import row as features_row
from stickslip.calibration.scoring import auc, calibration_error
from stickslip.detect.judge.answer import answer
from stickslip.detect.judge.model import calibrated
from stickslip.detect.prepare.prepared import Prepared
from stickslip.logs import LoopRecord

from benchmarks.report import Figures
from benchmarks.resumed import code_of, resumed

SEED = 73_001  # used for nothing else
RECORDS, QUICK = 60, 2
LOOPS, QUICK_LOOPS = 2000, 100
FOLDER = Path("calibration_parts")

NOTES = {
    "simulate_s": "median time of one record by simulation under its own conditions (goal: at most 10)",
    "simulate_loops": "loops that were simulated for each",
    "simulate_records": "held-out records of the setting other_physics",
    "simulate_auc": "chance that a sticky loop is more probable than another, by simulation",
    "model_auc": "the same by the calibrated model alone, on the same records",
    "unsure_records": "records that the calibrated answer leaves open",
    "unsure_simulate_auc": "simulate_auc of those",
    "unsure_model_auc": "model_auc of those",
    "unsure_together_auc": "the same by both together",
    "unsure_simulate_log_loss": "mean log loss over those, by simulation",
    "unsure_model_log_loss": "the same by the calibrated model alone",
    "unsure_together_log_loss": "the same by both together",
    "unsure_simulate_right": "share of those on the right side of one half, by simulation",
    "unsure_model_right": "the same by the calibrated model alone",
    "simulate_calibration_error": "expected calibration error, ten bins",
    "model_calibration_error": "the same by the calibrated model alone",
    "simulate_s_error": "median relative error of S over the sticky loops",
    "model_s_error": "the same by the calibrated model alone",
    "simulate_j_error": "median relative error of J over the sticky loops",
    "model_j_error": "the same by the calibrated model alone",
    "simulate_s_inside": "share of the sticky loops whose S lies in its 90 % interval",
    "limits_known": "share of the records for which a detection limit is known",
    "above_limit_probable": "of the sticky loops above their limit, share with a probability above one half",
}


@dataclass(frozen=True)
class Pair:
    """What both stages say of one record, and what is true.

    sticky : whether the valve sticks; S, J : true sizes [unit of the record]
    own, model : by simulation and by the model, None where the record shows too little
    unsure : whether the calibrated answer leaves the record open
    """

    sticky: bool
    S: float
    J: float
    own: "Own | None"
    model: tuple[float, float, float] | None
    unsure: bool = False


class Own(NamedTuple):
    """Of ``AtRecord``: probability, S and J, the 90 % interval of S, detection limit or None, seconds."""

    probability: float
    S: float
    J: float
    low: float
    high: float
    limit: float | None
    seconds: float


@dataclass(frozen=True)
class Loop:
    """A held-out loop, by its number."""

    number: int
    spec: LoopSpec
    loops: int

    @property
    def key(self) -> str:
        """Its number, and how many loops are simulated for it."""
        return f"{self.number}, {self.loops} loops"


def pairs(records: int, loops: int, seed: int = SEED, folder: Path | None = None) -> list[Pair]:
    """Ask both stages about held-out records; those in the folder are not asked again."""
    asked = [Loop(number, spec, loops) for number, spec in enumerate(draw(records, seed, "other_physics"))]
    code = code_of("blocks", "calibration", "detect", "diagram", "engine", "logs", "plant")
    rows = map(_row, asked) if folder is None else resumed(asked, _row, folder / f"posterior_{seed}_{code}.jsonl", inf)
    found = []
    for row in rows:
        print(f"\r{len(found) + 1} of {records} records", end="", file=sys.stderr, flush=True)
        own, model = row["own"], row["model"]
        found.append(Pair(row["sticky"], row["S"], row["J"], own and Own(*own), model and tuple(model), row["unsure"]))
    return found


def _row(asked: Loop) -> dict[str, Any]:
    """Ask both stages about one loop."""
    model, spec = calibrated(), asked.spec
    ((record, truth),) = simulate([spec])
    shown = features_row(record)
    said = None
    if shown is not None:
        opinion = model.judge(shown[0])
        said = (opinion.probability, opinion.S[0] * shown[1], opinion.J[0] * shown[1])
    first = answer(Prepared(record), model)
    scale = 1.0 if spec.span_known else spec.unit_op
    return {
        "key": asked.key, "sticky": truth.cause == "stiction", "S": truth.S * scale, "J": truth.J * scale,
        "own": _asked(record, asked.loops), "model": said,
        "unsure": first.word == "inconclusive" and first.probability is not None,
    }  # fmt: skip


def _asked(record: LoopRecord, loops: int) -> Own | None:
    try:
        found = at_record(record, loops=loops)
    except ValueError:
        return None
    limit = None if found.limit is None else found.limit[0]
    return Own(found.probability, found.S.value, found.J.value, found.S.low, found.S.high, limit, found.seconds)


def figures(quick: bool) -> Figures:
    """Return the figures; a quick run shows that it runs."""
    loops = QUICK_LOOPS if quick else LOOPS
    return summed_up(pairs(QUICK, loops) if quick else pairs(RECORDS, loops, folder=FOLDER), loops)


def summed_up(found: Sequence[Pair], loops: int) -> Figures:
    """Return the figures of pairs."""
    sticky = np.array([pair.sticky for pair in found])
    own = np.array([0.5 if pair.own is None else pair.own.probability for pair in found])
    model = np.array([0.5 if pair.model is None else pair.model[0] for pair in found])
    both = np.array([together(a, b) for a, b in zip(model.tolist(), own.tolist(), strict=True)])
    sized = [pair for pair in found if pair.sticky and pair.own is not None and pair.model is not None]
    unsure = np.array([pair.unsure for pair in found])
    limits = [pair.own.limit for pair in found if pair.own is not None]
    above = [pair for pair in sized if pair.own and pair.own.limit and pair.own.limit < pair.S]
    seconds = [pair.own.seconds for pair in found if pair.own is not None]
    return {
        "simulate_s": statistics.median(seconds) if seconds else None,
        "simulate_loops": loops,
        "simulate_records": len(found),
        "simulate_auc": auc(own, sticky),
        "model_auc": auc(model, sticky),
        "unsure_records": int(unsure.sum()),
        "unsure_simulate_auc": _auc(own[unsure], sticky[unsure]),
        "unsure_model_auc": _auc(model[unsure], sticky[unsure]),
        "unsure_together_auc": _auc(both[unsure], sticky[unsure]),
        "unsure_simulate_log_loss": _log_loss(own[unsure], sticky[unsure]),
        "unsure_model_log_loss": _log_loss(model[unsure], sticky[unsure]),
        "unsure_together_log_loss": _log_loss(both[unsure], sticky[unsure]),
        "unsure_simulate_right": _share(((own > 0.5) == sticky)[unsure].tolist()),
        "unsure_model_right": _share(((model > 0.5) == sticky)[unsure].tolist()),
        "simulate_calibration_error": calibration_error(own, sticky),
        "model_calibration_error": calibration_error(model, sticky),
        "simulate_s_error": _error([(pair.own.S, pair.S) for pair in sized if pair.own]),
        "model_s_error": _error([(pair.model[1], pair.S) for pair in sized if pair.model]),
        "simulate_j_error": _error([(pair.own.J, pair.J) for pair in sized if pair.own]),
        "model_j_error": _error([(pair.model[2], pair.J) for pair in sized if pair.model]),
        "simulate_s_inside": _share([pair.own.low <= pair.S <= pair.own.high for pair in sized if pair.own]),
        "limits_known": _share([limit is not None for limit in limits]),
        "above_limit_probable": _share([pair.own.probability > 0.5 for pair in above if pair.own]),
    }


def _auc(p: NDArray[np.float64], sticky: NDArray[np.bool_]) -> float | None:
    """The area, or None where one side is missing."""
    return auc(p, sticky) if 0 < int(sticky.sum()) < len(sticky) else None


def _log_loss(p: NDArray[np.float64], sticky: NDArray[np.bool_]) -> float | None:
    """The mean of -ln of the probability of what is true, or None where there is none."""
    return float(np.mean(np.logaddexp(0.0, np.where(sticky, -1.0, 1.0) * log_odds(p)))) if len(p) else None


def _error(pairs: Sequence[tuple[float, float]]) -> float | None:
    return statistics.median(abs(said / true - 1.0) for said, true in pairs) if pairs else None


def _share(found: Sequence[bool]) -> float | None:
    return sum(found) / len(found) if found else None

"""Calibrate a diagnosis: diagnose runs of the user's own model with known effects, and count what comes out.

A calibration that was stopped goes on where it was (``stickslip.gap.calibrating.calibration``).
"""

import json
import math
import time
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from stickslip.diagram.diagram import Diagram
from stickslip.diagram.progress import Progress, reporting
from stickslip.gap.answers.report import GapReport
from stickslip.gap.calibrating.calibration import Calibration, file_of, rows_of
from stickslip.gap.calibrating.injection import Injection, injections
from stickslip.gap.diagnosis import diagnose, held_against
from stickslip.gap.effects import CATALOGUE
from stickslip.gap.insertion.effect import Effect
from stickslip.gap.likelihood.hypothesis import Hypothesis
from stickslip.gap.likelihood.search import legal, model_alone
from stickslip.gap.null_model.null_model import without_gap
from stickslip.gap.records.record import GapError
from stickslip.logs import Log
from stickslip.logs.processes import one_thread


@one_thread
def calibrated(
    diagram: Diagram,
    log: Log | Any,
    *,
    catalogue: Sequence[Effect] = CATALOGUE,
    runs: int = 2,
    seed: int = 0,
    seconds: float = float("inf"),
    progress: Progress = None,
) -> Calibration:
    """Return how often names are right at the operating point of a log; ``diagnose`` then states these probabilities.

    Every effect is put into the model at every place where it may be, ``runs`` times with random sizes, with the set
    points, rows, rounding and logged signals of ``log``; each run is diagnosed.  Runs are kept beside the null
    model: a second call goes on where the first was stopped.  ``seconds`` after which it stops; ``seed`` of sizes and
    noise.

    Raises ``GapError`` if log and model do not fit together, or the model cannot be run.
    """
    log = getattr(log, "log", log)
    frame = held_against(diagram, log)
    plain = without_gap(frame.model, frame.record, 1, 900_000 + seed)
    if not plain:
        raise GapError("the model cannot be simulated on the set points of the log; check its parameters")
    null = model_alone(held_against(diagram, plain[0]))
    file = file_of(frame.model, frame.record)
    done = rows_of(file)
    base = null.hypothesis.frame
    of_log = (Hypothesis(base, one, at) for one in catalogue if one.of_log for at in one.places(base.model))
    plan = list(injections(null, [*legal(null, catalogue), *of_log], runs, seed))
    until = time.monotonic() + seconds
    with reporting(progress, len(plan), "runs with known effects") as tell:
        for k, one in enumerate(plan):
            if one.key not in done and time.monotonic() < until:
                made = one.made(frame)
                if made is not None:
                    report = diagnose(diagram, made, catalogue=catalogue, limits=False, progress=False)
                    done[one.key] = _row(one, report, base.model)
                    file.parent.mkdir(parents=True, exist_ok=True)
                    with file.open("a") as out:
                        out.write(json.dumps(done[one.key]) + "\n")
            tell(k + 1, len(plan))
    return Calibration(tuple(done.values()))


def _row(one: Injection, report: GapReport, model: Diagram) -> dict[str, Any]:
    named = [{cause.effect, *cause.ambiguous_with} for cause in report.causes]
    name = one.effect.name if one.effect else "none"
    places = set(report.where.confidence_set) if report.where else {""}
    unit = next((p.unit for p in one.effect.parameters if p.name == one.main), "") if one.effect else ""
    return {
        "key": one.key,
        "effect": name,
        "place": one.place,
        "values": {name: value for name, value in one.values.items() if math.isfinite(value)},
        "size": one.values.get(one.main, 0.0),
        "neutral": one.effect.nominal(model, one.place).get(one.main, 0.0) if one.effect else 0.0,
        "parameter": f"{one.main} [{unit}]" if one.main else "",
        "named": " and ".join(c.effect for c in report.causes) or "none",
        "right": not report.gap if one.effect is None else len(named) == 1 and name in named[0],
        "place_right": one.place in places,
        "evidence": asdict(report.evidence) if report.evidence else None,
    }

"""``calibrated``: how sure a diagnosis is at the operating point of a log, counted on runs of the user's own model."""

from collections.abc import Sequence
from typing import Any

from diagram.diagram import Diagram
from diagram.progress import Progress
from gap.calibrate import Calibration, calibrate
from gap.diagnosis import diagnose, prepared
from gap.effect import Effect
from gap.effects import CATALOGUE
from gap.floor import without_gap
from gap.record import GapError
from logs import Log


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
    points, rows, rounding and logged signals of ``log``; each run is diagnosed.  Runs are kept beside the floor of the
    model: a second call goes on where the first was stopped.  ``seconds`` after which it stops; ``seed`` of sizes and
    noise.

    Raises ``GapError`` if log and model do not fit together, or the model cannot be run.
    """
    log = getattr(log, "log", log)
    problem = prepared(diagram, log)
    problem = problem.before or problem  # its runs have the set points of the log, switching at its rows
    plain = without_gap(problem.model, problem.record, 1, 900_000 + seed)
    if not plain:
        raise GapError("the model cannot be simulated on the set points of the log; check its parameters")
    base = prepared(diagram, plain[0], floor=problem.floor)
    return calibrate(
        problem, diagram, base, diagnose,
        catalogue=catalogue, runs=runs, seed=seed, seconds=seconds, progress=progress,
    )  # fmt: skip

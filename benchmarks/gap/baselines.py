"""The three baselines that every figure of the benchmark stands beside: what is reached without naming any effect.

free run            the place of the signal with the largest free-run error
parameters only     gain and time constant of the process, K_p and T_i, each within a factor of two, and no effect
flexible residual   what random features of the last rows predict of the innovations, by ridge regression

The last two are fitted on the first part of a record and judged by held-out shrinkage, as a diagnosis is.
"""

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.gap.settings import SETTINGS

if TYPE_CHECKING:
    from stickslip.diagram.diagram import Diagram
    from stickslip.gap.floors.problem import Problem
    from stickslip.logs import Log

Floats = NDArray[np.float64]
LOOSE = {"process.K": 0.5, "process.tau": 0.5, "process.omega": 0.5, "process.T": 0.5,
         "controller.K_p": 0.5, "controller.T_i": 0.5}  # fmt: skip
BACK = 4  # rows that the flexible residual looks back
FEATURES, RIDGE, REACH = 300, 30.0, 3.0  # random features, their price, their range in standard deviations


def free_run_place(record: Any) -> dict[str, Any]:
    """Return the place of the channel with the largest free-run error."""
    noise = SETTINGS[record.setting].noise
    error = {s: float(((record.signals[s] - record.clean[s]) ** 2).mean() ** 0.5) / noise for s in ("PV", "OP")}
    return {"free_run_place": "process" if error["PV"] >= error["OP"] else "controller"}


def shrinkages(model: "Diagram", log: "Log") -> dict[str, float | None]:
    """Return the held-out shrinkage of the gap with other parameters only, and with a flexible residual."""
    from stickslip.gap.diagnosis import prepared

    problem = prepared(model, log)
    if problem.score <= problem.limit:
        return {"parameters_only": None, "flexible_residual": None}
    return {
        "parameters_only": _shrunk(problem, calibrated_alone(model, log, problem)),
        "flexible_residual": _shrunk(problem, without_what_is_predicted(problem)),
    }


def calibrated_alone(model: "Diagram", log: "Log", problem: "Problem") -> Floats:
    """Return the innovations (rows, signals) of the model with parameters fitted on the first part of a record."""
    from stickslip.gap.diagnosis import prepared
    from stickslip.gap.fits.search import Candidate
    from stickslip.gap.telling.sizes import SEEN

    loose = model.with_tolerances({key: share for key, share in LOOSE.items() if key in model.params})
    head = prepared(loose, log.samples(0, round(SEEN * len(log))), floor=problem.floor)
    values = dict(head.settled.values) if head.settled else {}
    whole = prepared(loose, log, floor=problem.floor)
    found: Floats = Candidate(whole, whole.quiet).tried([values])[0].e
    return found


def without_what_is_predicted(problem: "Problem") -> Floats:
    """Return innovations less what random features of earlier rows predict of them, fitted on the first part."""
    from stickslip.gap.telling.sizes import SEEN

    e = np.nan_to_num(problem.as_it_is)
    log, first = problem.record.log, problem.floor.skipped
    signals = np.stack([np.nan_to_num(log[s]) for s in log.names], axis=1)
    late = [np.roll(signals, k, axis=0)[first:] for k in range(1, BACK + 1)]
    ahead = [np.stack([log[s] for s in problem.record.played], axis=1)[first:]] if problem.record.played else []
    X = np.concatenate([*late, *ahead], axis=1)
    seen = np.arange(len(e)) < round(SEEN * len(log)) - first
    X = (X - X[seen].mean(axis=0)) / np.maximum(X[seen].std(axis=0), 1e-9)
    rng = np.random.default_rng(0)
    W, phase = rng.normal(size=(X.shape[1], FEATURES)) / REACH, rng.uniform(0.0, 2.0 * np.pi, FEATURES)
    Z = np.column_stack([X, np.cos(X @ W + phase), np.ones(len(X))])
    A = Z[seen].T @ Z[seen] + RIDGE * np.eye(Z.shape[1])
    found: Floats = e - Z @ np.linalg.solve(A, Z[seen].T @ e[seen])
    return found


def _shrunk(problem: "Problem", after: Floats) -> float:
    from stickslip.gap.telling.sizes import SEEN, shrinkage

    first = round(SEEN * len(problem.record.log)) - problem.floor.skipped
    return shrinkage(problem.as_it_is, after, problem.floor.mean / len(problem.record.pinned), first).fraction

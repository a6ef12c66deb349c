"""The three baselines that every figure of the benchmark stands beside: what is reached without naming any effect.

free run            the place of the signal with the largest free-run error
parameters only     gain and time constant of the process, K_p and T_i, each within a factor of two, and no effect
flexible residual   what random features of the last rows predict of the innovations, by ridge regression

The last two are fitted on the first part of a record and judged by held-out shrinkage, as a diagnosis is.
"""

from typing import TYPE_CHECKING, Any

import numpy as np

from benchmarks.gap.settings import SETTINGS

if TYPE_CHECKING:
    from stickslip.diagram.diagram import Diagram
    from stickslip.gap.likelihood.fit import Fit
    from stickslip.logs import Log

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
    from dataclasses import replace

    from stickslip.gap.diagnosis import held_against
    from stickslip.gap.likelihood.fit import unfitted
    from stickslip.gap.likelihood.held_out import shrunk
    from stickslip.gap.likelihood.left import judged_by_loss
    from stickslip.gap.likelihood.search import model_alone

    null = model_alone(held_against(model, log))
    if not judged_by_loss(null).unusual:
        return {"parameters_only": None, "flexible_residual": None}
    left = replace(null.best, e=without_what_is_predicted(null.hypothesis.frame, null.best.e))
    return {
        "parameters_only": shrunk(null, calibrated_alone(model, null)).fraction,
        "flexible_residual": shrunk(null, unfitted(left)).fraction,
    }


def calibrated_alone(model: "Diagram", null: "Fit") -> "Fit":
    """Return the model with parameters fitted on the first part of a record."""
    from dataclasses import replace

    from stickslip.gap.likelihood.fit import refined, unfitted
    from stickslip.gap.likelihood.hypothesis import Hypothesis
    from stickslip.gap.records.given import Given
    from stickslip.gap.reporting.sizes import SEEN

    loose = model.with_tolerances({key: share for key, share in LOOSE.items() if key in model.params})
    tolerances = {key: loose.tolerances[key] for key in loose.tolerances if key in null.hypothesis.frame.model.params}
    frame = replace(null.hypothesis.frame, given=Given(null.hypothesis.frame.model.with_tolerances(tolerances)))
    head = replace(frame, seen=SEEN)
    fit = refined(Hypothesis(head).filtered({}), tuple(head.free))
    return unfitted(Hypothesis(frame).filtered(fit.best.values))


def without_what_is_predicted(frame: Any, innovations: Any) -> Any:
    """Return innovations (rows, signals) less what random features of earlier rows predict of them."""
    from stickslip.gap.reporting.sizes import SEEN

    log, first = frame.record.log, frame.skipped
    e = np.nan_to_num(innovations[first:])
    signals = np.stack([np.nan_to_num(log[s]) for s in log.names], axis=1)
    late = [np.roll(signals, k, axis=0)[first:] for k in range(1, BACK + 1)]
    ahead = [np.stack([log[s] for s in frame.record.played], axis=1)[first:]] if frame.record.played else []
    X = np.concatenate([*late, *ahead], axis=1)
    seen = np.arange(len(e)) < round(SEEN * len(log)) - first
    X = (X - X[seen].mean(axis=0)) / np.maximum(X[seen].std(axis=0), 1e-9)
    rng = np.random.default_rng(0)
    W, phase = rng.normal(size=(X.shape[1], FEATURES)) / REACH, rng.uniform(0.0, 2.0 * np.pi, FEATURES)
    Z = np.column_stack([X, np.cos(X @ W + phase), np.ones(len(X))])
    A = Z[seen].T @ Z[seen] + RIDGE * np.eye(Z.shape[1])
    left = innovations.copy()
    left[first:] = e - Z @ np.linalg.solve(A, Z[seen].T @ e[seen])
    return left

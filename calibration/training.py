"""From tables of simulated loops to the calibrated model: trees on some seeds, all limits on others.

trees       fitted on the training parts, where a deadband counts less than the others
Platt       p = 1 / (1 + exp(-(a z + b))) by maximum likelihood on the holding parts
accuse      the least probability at which at most ``ALARMS`` of the loops without stiction are accused there
clear       the largest probability below which at most ``CLEARED`` of the sticky loops lie there
widths      what the outer quantiles of ln S and ln J need to hold 90 % there
"""

from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt
from stickslip.calibration.boosting import classifier, quantile, start, taken
from stickslip.calibration.records import Table
from stickslip.detect.judge.model import Model
from stickslip.detect.judge.trees import Trees

__all__ = ["fit"]

Values = npt.NDArray[np.float64]
Say = Callable[[str], None]

LEAVES = 10  # of a tree that accuses: more fit the loops learnt from alone
ALARMS = 0.015  # below the 2 % that are allowed: other physics may cost some, and nobody digs up a sound valve gladly
CLEARED = 0.02
TAILS = (0.05, 0.5, 0.95)
DEADBAND = 0.25  # weight of a loop whose valve has dead travel without a jump


def fit(training: Table, holding: Table, say: Say = print, seed: int = 0, trees: int = 400) -> Model:
    """The model of ``training``, calibrated on ``holding``; ``trees`` of the accusing part, ``say`` tells each step.

    Raises ValueError where the two tables have different features.
    """
    if training.names.tolist() != holding.names.tolist():
        raise ValueError("the tables have different features; make both with the same version")
    train, hold = training.rows(training.seen), holding.rows(holding.seen)
    say(f"{len(train)} loops to fit, {len(hold)} to calibrate on")
    found: dict[str, Any] = {}
    weight = _weights(train)
    sticky = classifier(train.x, train.sticky, trees, LEAVES, seed, weight)
    found["sticky"] = taken(sticky, start(sticky, train.x))
    say("stiction or not: fitted")
    rest = train.rows(~train.sticky)
    others = classifier(rest.x, rest.truth["cause"], max(trees // 8, 10), 8, seed)
    found["others"] = taken(others, start(others, rest.x))
    say("other causes: fitted")
    valves = train.rows(train.sticky)
    for which in ("S", "J"):
        found[which] = _sizes(valves, which, max(trees // 3, 10), seed, weight[train.sticky])
        say(f"size of {which}: fitted")
    kept = hold.rows(hold.truth["cause"] != "deadband")  # dead travel, too: an alarm there is not a false one
    z = found["sticky"](kept.x)[:, 0]
    a, b = _platt(z, kept.sticky)
    p = 1.0 / (1.0 + np.exp(-(a * z + b)))
    accuse = float(np.quantile(p[~kept.sticky], 1.0 - ALARMS))
    clear = float(np.quantile(p[kept.sticky], CLEARED))
    bad = hold.rows(hold.sticky)
    widths = np.array([_widths(found[which], bad, which) for which in ("S", "J")])
    seen = np.stack([np.nanmin(train.x, axis=0), np.nanmax(train.x, axis=0)])
    about = {"fitted_on": len(train), "calibrated_on": len(hold), "trees": trees, "seed": seed}
    return Model(
        tuple(train.names.tolist()), tuple(str(c) for c in others.classes_), found, (a, b), accuse, clear,
        widths, seen, about,
    )  # fmt: skip


def _weights(t: Table) -> Values:
    """A deadband is dead travel too, and differs from a stick by its jump alone: it counts less, (n,)."""
    return np.where(t.truth["cause"] == "deadband", DEADBAND, 1.0)


def _target(t: Table, which: str) -> Values:
    """ln of the true size over OP's travel, less what the network says of it: trees set it right, (n,)."""
    estimate = t.x[:, t.names.tolist().index(f"network_{which}")]
    return np.asarray(np.log(t.truth[which].astype(float) / t.unit) - estimate)


def _sizes(valves: Table, which: str, trees: int, seed: int, weight: Values) -> Trees:
    """The trees of the three quantiles of ln S or ln J over OP's travel, as three outputs."""
    parts = []
    for share in TAILS:
        model = quantile(valves.x, _target(valves, which), share, trees, 8, seed, weight)
        parts.append(taken(model, start(model, valves.x)))
    shift = np.cumsum([0, *[len(t.feature) for t in parts[:-1]]])
    joined = {name: np.concatenate([getattr(t, name) for t in parts]) for name in
              ("feature", "threshold", "value", "left", "right")}  # fmt: skip
    root = np.concatenate([t.root + s for t, s in zip(parts, shift, strict=True)])
    output = np.concatenate([np.full(len(t.root), k) for k, t in enumerate(parts)])
    return Trees(np.concatenate([t.base for t in parts]), root, output, **joined)


def _platt(z: Values, y: npt.NDArray[np.bool_]) -> tuple[float, float]:
    """a, b of the logistic curve, by Newton's method."""
    a, b = 1.0, 0.0
    design = np.column_stack([z, np.ones(len(z))])
    for _ in range(50):
        p = 1.0 / (1.0 + np.exp(-np.clip(a * z + b, -40, 40)))
        hessian = design.T @ (design * (p * (1 - p))[:, None]) + 1e-9 * np.eye(2)
        step = np.linalg.solve(hessian, design.T @ (y - p))
        a, b = a + float(step[0]), b + float(step[1])
        if np.abs(step).max() < 1e-10:
            break
    return a, b


def _widths(trees: Trees, bad: Table, which: str) -> Values:
    """What the outer quantiles lack on the holding loops (conformalised quantile regression, Romano et al. 2019)."""
    q, truth = np.sort(trees(bad.x), axis=1), _target(bad, which)
    return np.array([np.quantile(q[:, 0] - truth, 0.95), np.quantile(truth - q[:, 2], 0.95)])

"""How good the calibrated probability is on simulated loops of known cause: figures, by cause and by detectability.

    AUC                 chance that a sticky loop has a higher probability than another
    found, false alarm  shares of the sticky and of the other loops called sticky
    calibration error   mean over ten bins of |share sticky - mean probability|, weighted by the loops in each
    quiet               shares so improbable that the verdict clears them, where the record itself excludes dead travel
    S error, J error    median of |estimate / true - 1| over the sticky loops that are called so

A record that shows too little for any feature is never called sticky; it counts with the probability 0.5.
"""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt
from stickslip.calibration.records import Table
from stickslip.detect.judge.model import Model, Opinion
from stickslip.logs.arrays import Values

__all__ = ["auc", "calibration_error", "estimates", "opinions", "score"]

Flags = npt.NDArray[np.bool_]


def auc(p: Values, sticky: Flags) -> float:
    """Area under the curve of hits over false alarms (Mann-Whitney), ties count half.

    >>> auc(np.array([0.9, 0.4, 0.4, 0.1]), np.array([True, True, False, False]))
    0.875
    """
    from scipy.stats import rankdata

    rank, n, m = rankdata(p), int(sticky.sum()), int((~sticky).sum())
    return float((rank[sticky].sum() - n * (n + 1) / 2) / (n * m)) if n and m else float("nan")


def calibration_error(p: Values, sticky: Flags, bins: int = 10) -> float:
    """Expected calibration error over bins of equal width [-].

    >>> calibration_error(np.full(4, 0.5), np.array([True, False, True, False]))
    0.0
    """
    at = np.minimum((p * bins).astype(int), bins - 1)
    return float(sum(abs(float(np.sum(sticky[at == k] - p[at == k]))) for k in range(bins)) / len(p))


def opinions(model: Model, t: Table) -> list[Opinion | None]:
    """What the model says of each record; None of one that shows nothing."""
    names = t.names.tolist()
    rows = zip(t.x, t.seen, strict=True)
    return [model.judge(dict(zip(names, x.tolist(), strict=True))) if seen else None for x, seen in rows]


def estimates(model: Model, t: Table) -> tuple[Values, Flags, Values, Values]:
    """p(stiction) (n,), whether stiction is called, S and J (n, 3) [% of OP]: value, low, high."""
    said = opinions(model, t)
    p = np.array([0.5 if one is None else one.probability for one in said])
    needed = np.array([math.inf if one is None else one.needed for one in said])
    nothing = (math.nan,) * 3
    S, J = (
        np.array([nothing if one is None else getattr(one, which) for one in said]).reshape(-1, 3) * t.unit[:, None]
        for which in ("S", "J")
    )
    return p, p >= needed, S, J


def score(model: Model, t: Table) -> dict[str, Any]:
    """All figures of the model on a table, plain values."""
    p, called, S, J = estimates(model, t)
    sticky = t.sticky
    hit = called & sticky
    S_true, J_true = t.truth["S"].astype(float), t.truth["J"].astype(float)
    bad = t.seen & sticky
    group = t.truth["group"]
    quiet = t.seen & (p <= model.clear)
    return {
        "loops": len(t),
        "auc": auc(p, sticky),
        "false_alarm": float(np.mean(called[~sticky])),
        "coverage": float(np.mean(called[sticky])),
        "calibration_error": calibration_error(p, sticky),
        "s_error": float(np.nanmedian(np.abs(S[hit, 0] / S_true[hit] - 1))) if hit.any() else None,
        "j_error": float(np.nanmedian(np.abs(J[hit, 0] / J_true[hit] - 1))) if hit.any() else None,
        "s_inside": _inside(S[bad], S_true[bad]),
        "j_inside": _inside(J[bad], J_true[bad]),
        "quiet_others": float(np.mean(quiet[~sticky])),
        "quiet_sticky": float(np.mean(quiet[sticky])),
        "by_group": {
            str(g): {"loops": int((group == g).sum()), "called": float(np.mean(called[group == g])),
                     "quiet": float(np.mean(quiet[group == g])), "mean_p": float(np.mean(p[group == g]))}
            for g in np.unique(group)
        },
        "by_detectability": _by(t, called),
        "baselines": _baselines(t),
    }  # fmt: skip


def _inside(size: Values, true: Values) -> float:
    """Share of true sizes (n,) that lie inside their 90 % interval, (n, 3)."""
    return float(np.mean((true >= size[:, 1]) & (true <= size[:, 2])))


def _by(t: Table, called: Flags) -> dict[str, dict[str, float]]:
    """Share found of the sticky loops by OP's travel over S, process, J over S, cycle and points a turn."""
    sticky = t.sticky
    travel, ratio = t.truth["travel"].astype(float), t.truth["J"].astype(float) / t.truth["S"].astype(float)
    points = np.exp(t.x[:, t.names.tolist().index("samples")])
    sets = {
        "travel below 1.2 S": travel < 1.2, "travel 1.2 to 2 S": (travel >= 1.2) & (travel < 2),
        "travel 2 to 3 S": (travel >= 2) & (travel < 3), "travel above 3 S": travel >= 3,
        "self-regulating": t.truth["process"] == "self_regulating", "integrating": t.truth["process"] == "integrating",
        "J below 0.3 S": ratio < 0.3, "J 0.3 to 0.5 S": (ratio >= 0.3) & (ratio < 0.5),
        "J 0.5 to 0.8 S": (ratio >= 0.5) & (ratio < 0.8), "J above 0.8 S": ratio >= 0.8,
        "cycling": t.truth["cycling"].astype(bool), "not cycling": ~t.truth["cycling"].astype(bool),
        "below 10 samples a turn": points < 10.0, "above 10 samples a turn": points >= 10.0,
    }  # fmt: skip
    return {
        name: {"loops": float((here & sticky).sum()), "found": float(np.mean(called[here & sticky]))}
        for name, here in sets.items() if (here & sticky).any()
    }  # fmt: skip


def _baselines(t: Table) -> Mapping[str, float]:
    """AUC of single numbers that a first guess would use."""
    names = t.names.tolist()
    found = {"always sticky: false alarms": 1.0}
    for label, feature in (
        ("network", "network_sticky"), ("gain in nats", "dead_travel"), ("samples a turn", "samples"),
        ("turns", "turns"),
    ):  # fmt: skip
        x = t.x[:, names.index(feature)]
        ok = np.isfinite(x)
        found[f"AUC {label}"] = auc(x[ok], t.sticky[ok])
    return found

"""Boosted trees of scikit-learn (extra ``calibration``), fitted and taken over into ``stickslip.detect.judge.trees``.

A missing feature is given a number below all others, so that it goes left at every node.
"""

from typing import Any

import numpy as np
import numpy.typing as npt
from stickslip.detect.judge.trees import Trees

__all__ = ["classifier", "filled", "quantile", "start", "taken"]

Values = npt.NDArray[np.float64]
MISSING = -1e30


def filled(x: Values) -> Values:
    """Features (n, f) as the library gets them."""
    return np.where(np.isnan(x), MISSING, x)


def classifier(x: Values, y: npt.NDArray[Any], trees: int, leaves: int, seed: int, weight: Values | None = None) -> Any:
    """Fit classes y (n,) by features x (n, f); ``weight`` of each record (n,) [-], equal if not given."""
    from sklearn.ensemble import GradientBoostingClassifier

    model = GradientBoostingClassifier(
        n_estimators=trees, learning_rate=0.06, subsample=0.5, max_leaf_nodes=leaves, max_depth=None,
        min_samples_leaf=15, max_features=0.12, random_state=seed,
    )  # fmt: skip
    return model.fit(filled(x), y, sample_weight=weight)


def quantile(
    x: Values, y: Values, share: float, trees: int, leaves: int, seed: int, weight: Values | None = None
) -> Any:
    """Fit the quantile ``share`` [-] of y (n,) by features x (n, f); ``weight`` as in ``classifier``."""
    from sklearn.ensemble import GradientBoostingRegressor

    model = GradientBoostingRegressor(
        loss="quantile", alpha=share, n_estimators=trees, learning_rate=0.08, subsample=0.6, max_leaf_nodes=leaves,
        max_depth=None, min_samples_leaf=8, max_features=0.2, random_state=seed,
    )  # fmt: skip
    return model.fit(filled(x), y, sample_weight=weight)


def start(model: Any, x: Values) -> Values:
    """What the raw output (k,) is before the first tree: that of one record less the sum of its leaves."""
    one = filled(x[:1])
    raw = np.reshape(model.decision_function(one) if hasattr(model, "classes_") else model.predict(one), (1, -1))
    return np.asarray((raw - taken(model, np.zeros(raw.shape[1]))(one)).ravel())


def taken(model: Any, base: Values) -> Trees:
    """The trees of a fitted model, whose raw output (n, k) is ``base`` (k,) more than the sum of its leaves."""
    parts: dict[str, list[npt.NDArray[Any]]] = {k: [] for k in ("feature", "threshold", "value", "left", "right")}
    root, output, n = [], [], 0
    for stage in model.estimators_:
        for k, one in enumerate(stage):
            tree = one.tree_
            here = np.arange(tree.node_count)
            inner = tree.children_left >= 0
            parts["feature"].append(np.where(inner, tree.feature, 0))
            low = tree.threshold.astype(np.float32)
            low = np.where(low > tree.threshold, np.nextafter(low, np.float32(-np.inf)), low)  # never beyond the split
            parts["threshold"].append(np.where(inner, low, 0).astype(np.float32))
            parts["value"].append((model.learning_rate * tree.value[:, 0, 0]).astype(np.float32))
            parts["left"].append(np.where(inner, tree.children_left - here, 0))
            parts["right"].append(np.where(inner, tree.children_right - here, 0))
            root.append(n)
            output.append(k)
            n += tree.node_count
    joined = {k: np.concatenate(v) for k, v in parts.items()}
    return Trees(np.asarray(base, dtype=np.float64), np.array(root), np.array(output), **joined)

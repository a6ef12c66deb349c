"""Sums of decision trees in plain numpy: what a boosting library has fitted, kept in a small open file.

    raw_k(x) = base_k + sum over the trees of output k of the value of the leaf that x falls into

At a node x goes left where x[feature] <= threshold, or where it is missing and the node says so.  The file
(``numpy.savez``) holds the thresholds of each feature once, because a library that sorts its data into bins has at most
255 of them, and for every node the number of its feature, of its threshold, of its left and right child, and its value.
All trees are walked side by side, so that one record costs some ten steps over as many numbers as there are trees.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

__all__ = ["Trees"]

Values = npt.NDArray[np.float64]
Whole = npt.NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class Trees:
    """Trees of one or several outputs over the same features.

    base : (k,) start of each output
    root, output : (t,) first node and output of each tree
    feature : (n,) feature of each node; threshold, value : (n,)
    left, right : (n,) children; a leaf is its own child
    missing_left : (n,) whether a missing value goes left

    >>> stump = Trees(np.zeros(1), np.array([0]), np.array([0]), np.array([0, 0, 0]), np.array([1.5, np.inf, np.inf]),
    ...               np.array([0.0, -1.0, 1.0]), np.array([1, 1, 2]), np.array([2, 1, 2]), np.array([True] * 3))
    >>> stump(np.array([[1.0], [2.0], [np.nan]])).tolist()
    [[-1.0], [1.0], [-1.0]]
    """

    base: Values
    root: Whole
    output: Whole
    feature: Whole
    threshold: Values
    value: Values
    left: Whole
    right: Whole
    missing_left: npt.NDArray[np.bool_]

    def __call__(self, x: Values) -> Values:
        """The outputs (r, k) for records (r, features), NaN where a feature is missing."""
        rows = np.arange(len(x))[:, None]
        node = np.broadcast_to(self.root, (len(x), len(self.root)))
        while True:
            seen = x[rows, self.feature[node]]
            left = np.where(np.isnan(seen), self.missing_left[node], seen <= self.threshold[node])
            after = np.where(left, self.left[node], self.right[node])
            if np.array_equal(after, node):
                break
            node = after
        out = np.tile(self.base, (len(x), 1))
        for k in range(len(self.base)):
            out[:, k] += self.value[node[:, self.output == k]].sum(axis=1)
        return out

    def arrays(self, prefix: str) -> dict[str, npt.NDArray[np.generic]]:
        """What the file holds, each name after ``prefix``."""
        inner = np.isfinite(self.threshold)
        table, which = [], np.zeros(len(self.feature), dtype=np.uint16)
        start = np.zeros(int(self.feature.max()) + 2, dtype=np.uint32)
        for f in range(len(start) - 1):
            here = inner & (self.feature == f)
            values, number = np.unique(self.threshold[here], return_inverse=True)
            which[here] = number
            table.append(values)
            start[f + 1] = start[f] + len(values)
        step = np.where(inner, self.left - np.arange(len(self.left)), 0)
        far = np.where(inner, self.right - np.arange(len(self.right)), 0)
        return {
            f"{prefix}base": self.base, f"{prefix}root": self.root.astype(np.uint32),
            f"{prefix}output": self.output.astype(np.uint8), f"{prefix}feature": self.feature.astype(np.uint8),
            f"{prefix}which": which, f"{prefix}table": np.concatenate(table), f"{prefix}start": start,
            f"{prefix}left": step.astype(np.uint8), f"{prefix}right": far.astype(np.uint8),
            f"{prefix}value": self.value.astype(np.float32), f"{prefix}missing": np.packbits(self.missing_left),
        }  # fmt: skip

    @classmethod
    def read(cls, arrays: Mapping[str, npt.NDArray[np.generic]], prefix: str) -> Trees:
        """The trees that ``arrays`` has kept under the same prefix."""
        a = {name.removeprefix(prefix): np.asarray(arrays[name]) for name in arrays if name.startswith(prefix)}
        n, feature = len(a["feature"]), a["feature"].astype(np.intp)
        inner = a["left"] > 0
        start, here = a["start"].astype(np.intp), np.arange(n)
        threshold = np.full(n, np.inf)
        threshold[inner] = a["table"][start[feature[inner]] + a["which"][inner].astype(np.intp)]
        return cls(
            a["base"].astype(float), a["root"].astype(np.intp), a["output"].astype(np.intp), feature, threshold,
            a["value"].astype(float), here + a["left"].astype(np.intp), here + a["right"].astype(np.intp),
            np.unpackbits(a["missing"].astype(np.uint8))[:n].astype(bool),
        )  # fmt: skip

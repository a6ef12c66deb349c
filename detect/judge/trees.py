"""Sums of decision trees in plain numpy: what a boosting library has fitted, kept in a small open file.

    raw_k(x) = base_k + sum over the trees of output k of the value of the leaf that x falls into

At a node x goes left where x[feature] <= threshold or where it is missing, in single precision as the library does.
All trees are walked side by side, so that one record costs some ten steps over as many numbers as there are trees.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

__all__ = ["Trees"]

Values = npt.NDArray[np.float64]
Singles = npt.NDArray[np.float32]
Whole = npt.NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class Trees:
    """Trees of one or several outputs over the same features.

    base : (k,) start of each output
    root, output : (t,) first node and output of each tree
    feature : (n,) feature of each node; threshold, value : (n,)
    left, right : (n,) how many nodes further its children stand; a leaf is its own child, 0

    >>> stump = Trees(np.zeros(1), np.array([0]), np.array([0]), np.array([0, 0, 0]), np.float32([1.5, 0.0, 0.0]),
    ...               np.float32([0.0, -1.0, 1.0]), np.array([1, 0, 0]), np.array([2, 0, 0]))
    >>> stump(np.array([[1.0], [2.0], [np.nan]])).tolist()
    [[-1.0], [1.0], [-1.0]]
    """

    base: Values
    root: Whole
    output: Whole
    feature: Whole
    threshold: Singles
    value: Singles
    left: Whole
    right: Whole

    def __call__(self, x: Values) -> Values:
        """The outputs (r, k) for records (r, features), NaN where a feature is missing."""
        single, rows = x.astype(np.float32), np.arange(len(x))[:, None]
        node = np.broadcast_to(self.root, (len(x), len(self.root)))
        while True:
            right = single[rows, self.feature[node]] > self.threshold[node]  # false where it is missing
            step = np.where(right, self.right[node], self.left[node])
            if not step.any():
                break
            node = node + step
        out = np.tile(self.base, (len(x), 1))
        for k in range(len(self.base)):
            out[:, k] += self.value[node[:, self.output == k]].sum(axis=1, dtype=np.float64)
        return out

    @cached_property
    def expected(self) -> Values:
        """What each node stands for (n,): a leaf its value, another node the mean of its two children."""
        worth = self.value.astype(np.float64)
        for node in range(len(worth) - 1, -1, -1):  # children stand after their parent
            if self.right[node]:
                worth[node] = 0.5 * (worth[node + self.left[node]] + worth[node + self.right[node]])
        return worth

    def shares(self, x: Values) -> Values:
        """What each feature (f,) of one record adds to the first output: the sum over nodes that ask for it.

            share_j = sum over nodes on the way that ask for feature j of expected(child taken) - expected(node)

        The shares and the sum of ``base`` and the expected roots are the output, exactly.  Source: A. Saabas,
        Interpreting random forests, 2014.

        >>> stump = Trees(np.zeros(1), np.array([0]), np.array([0]), np.array([1, 0, 0]), np.float32([1.5, 0.0, 0.0]),
        ...               np.float32([0.0, -1.0, 3.0]), np.array([1, 0, 0]), np.array([2, 0, 0]))
        >>> stump.shares(np.array([0.0, 2.0])).tolist()  # the root stands for 1, and 3 is reached
        [0.0, 2.0]
        """
        single, node, found = x.astype(np.float32), self.root[self.output == 0], np.zeros(len(x))
        while True:
            right = single[self.feature[node]] > self.threshold[node]
            below = node + np.where(right, self.right[node], self.left[node])
            if np.array_equal(below, node):
                return found
            np.add.at(found, self.feature[node], self.expected[below] - self.expected[node])
            node = below

    def arrays(self) -> dict[str, npt.NDArray[np.generic]]:
        """The arrays that a file holds."""
        return {
            "base": self.base, "root": self.root.astype(np.uint32), "output": self.output.astype(np.uint8),
            "feature": self.feature.astype(np.uint8), "threshold": self.threshold, "value": self.value,
            "left": self.left.astype(np.uint8), "right": self.right.astype(np.uint8),
        }  # fmt: skip

    @classmethod
    def read(cls, arrays: Mapping[str, npt.NDArray[np.generic]]) -> Trees:
        """The trees that ``arrays`` has kept."""
        root, output, feature, left, right = (
            arrays[name].astype(np.intp) for name in ("root", "output", "feature", "left", "right")
        )
        threshold, value = (arrays[name].astype(np.float32) for name in ("threshold", "value"))
        return cls(arrays["base"].astype(np.float64), root, output, feature, threshold, value, left, right)

"""Runs sorted by an axis: the values as groups, or slices of a random axis, with the band of a number in each."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from stickslip.logs.arrays import Values
from stickslip.logs.oscillation import Band, band
from stickslip.study.axes import Axis
from stickslip.study.findings import Findings

SLICES = 5  # of a random axis
MOST = 12  # groups with a colour of their own in one picture


@dataclass(frozen=True)
class Group:
    """Some runs: what they share, where that lies on the axis (NaN for words), and which they are."""

    label: str
    at: float
    runs: NDArray[np.bool_]

    def band(self, values: Values) -> Band:
        """Return median and 5 to 95 % of a number over these runs."""
        return band(values[self.runs].tolist())


def groups(result: Findings, axis: Axis | None, most: int = MOST, slices: int = SLICES) -> list[Group]:
    """Return the runs that reached their end by the values of an axis, random axes in slices of equal count."""
    ok = np.asarray((result.table["status"] == "OK").to_numpy())
    if axis is None:
        return [Group("all runs", math.nan, ok)]
    if any(isinstance(value, str) for value in axis.values):
        words = result.table[axis.column].to_list()
        return [Group(word, math.nan, ok & np.array([w == word for w in words])) for word in dict.fromkeys(words)]
    values = result.column(axis.column)
    if axis.law is None and len(axis.values) <= most:
        return [Group(f"{v:.4g}", float(v), ok & (values == v)) for v in sorted(map(float, axis.values))]
    edges = np.quantile(values, np.linspace(0.0, 1.0, (slices if axis.law else most) + 1))
    found = []
    for low, high in pairwise(edges.tolist()):
        within = (values >= low) & ((values <= high) if high == edges[-1] else (values < high))
        found.append(Group(f"{low:.3g} to {high:.3g}", float(np.median(values[within])), ok & within))
    return found


def bands(group: Group, columns: Sequence[Values]) -> tuple[Values, Values, Values]:
    """Return median, low and high of several numbers over a group, each (numbers,)."""
    found = [group.band(column) for column in columns]
    return (
        np.array([b.median for b in found]), np.array([b.low for b in found]), np.array([b.high for b in found])
    )  # fmt: skip

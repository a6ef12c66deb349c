"""The findings of a study as numbers: one table with amplitudes in % and the axes that vary."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from stickslip.blocks.ports import nearest
from stickslip.logs.arrays import Values
from stickslip.logs.shown import Shown
from stickslip.study.axes import Axis, StudyError

if TYPE_CHECKING:
    import polars as pl


MOVES = 1e-3  # % of the operating point: a run whose signals move less, in the median along the chain, is at rest


@dataclass(frozen=True, eq=False, repr=False)
class Findings(Shown):
    """The runs of a study with what was asked for, all that a picture needs; the fields as in ``StudyResult``."""

    table: "pl.DataFrame"
    request: Mapping[str, Any]
    axes: tuple[Axis, ...]
    signals: tuple[str, ...]
    stages: Mapping[str, tuple[str, ...]]
    units: Mapping[str, str]

    def __len__(self) -> int:
        return len(self.table)

    @property
    def headline(self) -> str:
        """The result in one line."""
        counts = ", ".join(f"{count} {name}" for name, count in self.counts().items() if count)
        varied = ", ".join(axis.name for axis in self.varied()) or "nothing"
        return f"'{self.request['subject']}' over {varied}: {counts}"

    def counts(self) -> dict[str, int]:
        """Return how many runs are ok, infeasible, refused, failed."""
        status = self.table["status"]
        ok, infeasible, refused = (int((status == word).sum()) for word in ("OK", "INFEASIBLE", "REFUSED"))
        return {"ok": ok, "infeasible": infeasible, "refused": refused,
                "failed": len(status) - ok - infeasible - refused}  # fmt: skip

    def varied(self) -> list[Axis]:
        """Return the axes with more than one value."""
        return [axis for axis in self.axes if axis.law or len(axis.values) > 1]

    def column(self, name: str) -> Values:
        """Return a column as numbers, NaN where there is none, (runs,).

        Raises ``StudyError`` with the nearest name if there is no such column.
        """
        if name not in self.table.columns:
            raise StudyError(f"the study has no column '{name}'; {nearest(name, self.table.columns)}")
        return np.asarray(self.table[name].cast(float).fill_null(math.nan).to_numpy(), dtype=float)

    def percent(self, signal: str) -> Values:
        """Return the amplitude of a signal in % of its operating point, the mean of the run, (runs,).

        A signal that swings about zero has no such point: its amplitude is given in % of one unit, e.g. of full
        travel; see ``about_zero``.
        """
        amplitude, mean = self.column(f"{signal}.amplitude"), self.column(f"{signal}.mean")
        if self.about_zero(signal):
            return 100.0 * amplitude
        found = np.full(len(mean), math.nan)
        known = np.abs(mean) > 0.0
        found[known] = 100.0 * amplitude[known] / np.abs(mean[known])
        return found

    def about_zero(self, signal: str) -> bool:
        """Tell whether a signal swings about zero, in the median run."""
        amplitude, mean = self.column(f"{signal}.amplitude"), np.abs(self.column(f"{signal}.mean"))
        known = np.isfinite(mean)
        return bool(known.any() and np.median(mean[known]) <= np.median(amplitude[known]))

    def swings(self) -> NDArray[np.bool_]:
        """Return which runs reached their end and still move there, (runs,): the median signal by ``MOVES`` or more."""
        ok = np.asarray((self.table["status"] == "OK").to_numpy())
        percent = np.stack([self.percent(signal) for signal in self.signals])
        known = np.isfinite(percent)
        middle = np.array([np.median(x[k]) if k.any() else 0.0 for x, k in zip(percent.T, known.T, strict=True)])
        return ok & (middle >= MOVES)

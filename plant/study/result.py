"""What a study gave: one table, and the pictures of it."""

import math
import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from blocks.ports import nearest
from plant.study.axes import Axis, StudyError
from plant.study.folder import parquet, write

if TYPE_CHECKING:
    import polars as pl
    from matplotlib.figure import Figure

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False, repr=False)
class StudyResult:
    """The outcome of ``study``.

    Attributes
    ----------
    table : polars DataFrame, one row a run: run, point, kick, the axes, status, reason, ended [s], and for each
        signal ``.mean``, ``.amplitude`` (half of peak to peak), ``.sd``, ``.period`` [s], ``.saturated`` (share of
        time at a limit, controller outputs only); ``VALVE.slips``.  What a run has not is null.
    request : what was asked for, as plain values; ``axes`` the same as objects.
    signals : measured, in the order of the chain; ``stages`` of it: name -> signals; ``units`` of signals.
    complete : whether all runs are there; ``seconds`` that this call took.
    """

    table: "pl.DataFrame"
    request: Mapping[str, Any]
    axes: tuple[Axis, ...]
    signals: tuple[str, ...]
    stages: Mapping[str, tuple[str, ...]]
    units: Mapping[str, str]
    complete: bool
    seconds: float

    def __len__(self) -> int:
        return len(self.table)

    def __repr__(self) -> str:
        told = ", ".join(f"{count} {name}" for name, count in self.counts().items() if count)
        varied = ", ".join(axis.name for axis in self.varied()) or "nothing"
        return f"<Study of '{self.request['subject']}' over {varied}: {told}>"

    def counts(self) -> dict[str, int]:
        """Return how many runs are ok, infeasible, refused, failed."""
        status = self.table["status"]
        ok, infeasible, refused = (int((status == word).sum()) for word in ("OK", "INFEASIBLE", "REFUSED"))
        return {"ok": ok, "infeasible": infeasible, "refused": refused,
                "failed": len(status) - ok - infeasible - refused}  # fmt: skip

    def varied(self) -> list[Axis]:
        """Return the axes with more than one value."""
        return [axis for axis in self.axes if axis.law or len(axis.values) > 1]

    def column(self, name: str) -> Floats:
        """Return a column as numbers, NaN where there is none, (runs,).

        Raises ``StudyError`` with the nearest name if there is no such column.
        """
        if name not in self.table.columns:
            raise StudyError(f"the study has no column '{name}'; {nearest(name, self.table.columns)}")
        return np.asarray(self.table[name].cast(float).fill_null(math.nan).to_numpy(), dtype=float)

    def percent(self, signal: str) -> Floats:
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

    def plot(self) -> "Figure":
        """Draw amplitude and period along the chain of signals, one line a value of the first axis."""
        from plant.study.spread import draw_spread

        return draw_spread(self)

    def plot_growth(self) -> "Figure | None":
        """Draw amplitude and period over the first axis of numbers, one line a signal; None without such an axis."""
        from plant.study.growth import draw_growth

        return draw_growth(self)

    def plot_map(self) -> "Figure | None":
        """Draw amplitudes over two axes of numbers, one map a signal; None without two such axes."""
        from plant.study.maps import draw_maps

        return draw_maps(self)

    def figures(self) -> "dict[str, Figure]":
        """Return all pictures that the axes allow, by name: spread, growth, map."""
        drawn = {"spread": self.plot(), "growth": self.plot_growth(), "map": self.plot_map()}
        return {name: figure for name, figure in drawn.items() if figure is not None}

    def to_parquet(self, path: str | os.PathLike[str]) -> None:
        """Write the table with the request in the footer under the key "stickslip", whole or not at all."""
        write(Path(path), parquet(self.table, self.request))

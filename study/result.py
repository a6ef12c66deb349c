"""The result of a study: one table and its pictures."""

import os
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from stickslip.logs.files.resumable import parquet, write
from stickslip.study.findings import Findings
from stickslip.study.request import SCHEMA

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, eq=False, repr=False)
class StudyResult(Findings):
    """The outcome of ``study``.

    Attributes: ``table`` (polars DataFrame, one row a run: run, point, kick, the axes, status, reason, ended [s], and
    for each) signal ``.mean``, ``.amplitude`` (half of peak to peak), ``.sd``, ``.period`` [s], ``.saturated`` (share
    of time at a limit, controller outputs only); ``VALVE.slips``.  What a run has not is null; ``request`` (what was
    asked for, as plain values; ``axes`` the same as objects.); ``signals`` (measured, in the order of the chain;
    ``stages`` of it: name -> signals; ``units`` of signals.); ``complete`` (whether all runs are there; ``seconds``
    that this call took.).
    """

    complete: bool
    seconds: float

    def plot(self) -> "Figure":
        """Draw amplitude and period along the chain of signals, one line a value of the first axis."""
        from stickslip.study.spread import draw_spread

        return draw_spread(self)

    def plot_growth(self) -> "Figure | None":
        """Draw amplitude and period over the first axis of numbers, one line a signal; None without such an axis."""
        from stickslip.study.growth import draw_growth

        return draw_growth(self)

    def plot_map(self) -> "Figure | None":
        """Draw amplitudes over two axes of numbers, one map a signal; None without two such axes."""
        from stickslip.study.maps import draw_maps

        return draw_maps(self)

    def figures(self) -> "dict[str, Figure]":
        """Return all pictures that the axes allow, by name: spread, growth, map."""
        drawn = {"spread": self.plot(), "growth": self.plot_growth(), "map": self.plot_map()}
        return {name: figure for name, figure in drawn.items() if figure is not None}

    def to_parquet(self, path: str | os.PathLike[str]) -> None:
        """Write the table with the request in the footer under the key "stickslip", whole or not at all."""
        write(Path(path), parquet(self.table, {"schema": SCHEMA, "request": self.request}))

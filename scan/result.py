"""The result of a scan: the ranked table, its files and its picture."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from stickslip.logs.files.resumable import parquet, write
from stickslip.logs.shown import Shown
from stickslip.scan.changes import Change
from stickslip.scan.table import csv_bytes

if TYPE_CHECKING:
    import polars as pl
    from matplotlib.figure import Figure

__all__ = ["SCHEMA", "ScanResult"]

SCHEMA = "stickslip.scan/1"


@dataclass(frozen=True, eq=False, repr=False)
class ScanResult(Shown):
    """All loops of a scan, the valves to look at first on top.

    table : polars.DataFrame
        One row a loop, in the order of ``rank``; see ``stickslip.scan.table.COLUMNS``.
    source : str
    notes : tuple of str
        What was assumed of the source.
    changes : tuple of Change
        Loops whose verdict is another than in the scan before.
    """

    table: pl.DataFrame = field(repr=False)
    source: str
    notes: tuple[str, ...] = ()
    changes: tuple[Change, ...] = ()

    @property
    def headline(self) -> str:
        """The result in one line."""
        counts = ", ".join(f"{count} {word}" for word, count in self.counts.items())
        return f"{len(self.table)} loops of {self.source}: {counts}"

    @property
    def counts(self) -> dict[str, int]:
        """Number of loops by verdict; "error" for those that could not be read or judged."""
        found: dict[str, int] = {}
        for word in self.table["verdict"].to_list():
            found[word or "error"] = found.get(word or "error", 0) + 1
        return found

    def to_dict(self) -> dict[str, Any]:
        """The result as plain values, schema "stickslip.scan/1"."""
        return {
            "schema": SCHEMA,
            "source": self.source,
            "notes": list(self.notes),
            "counts": self.counts,
            "changes": [vars(change) for change in self.changes],
            "loops": self.table.drop("order").to_dicts(),
        }

    def to_parquet(self, path: str | os.PathLike[str]) -> None:
        """Write the table as Parquet."""
        write(Path(path), parquet(self.table))

    def to_csv(self, path: str | os.PathLike[str]) -> None:
        """Write the table as CSV that is safe to open in a spreadsheet."""
        write(Path(path), csv_bytes(self.table))

    def plot(self) -> Figure:
        """How many loops have which verdict, and the periods of those that oscillate."""
        from stickslip.scan.figures import plot_scan

        return plot_scan(self)

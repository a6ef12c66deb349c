"""Where the rows of a study live until all are there: in memory, or in a folder that survives an interruption."""

from typing import TYPE_CHECKING, Protocol

from stickslip.logs.files.resumable import Kept
from stickslip.study.axes import StudyError
from stickslip.study.request import SCHEMA, differences

if TYPE_CHECKING:
    import polars as pl

KEPT = Kept("study", SCHEMA, "run", StudyError, differences)


class Store(Protocol):
    """Keeps finished rows."""

    def rows(self) -> "list[pl.DataFrame]":
        """Return the rows kept so far, in tables of one schema."""

    def add(self, table: "pl.DataFrame") -> None:
        """Keep more rows."""


class Memory:
    """Keeps rows as long as the call lasts."""

    def __init__(self) -> None:
        self.tables: list[pl.DataFrame] = []

    def rows(self) -> "list[pl.DataFrame]":
        """Return the rows kept so far."""
        return self.tables

    def add(self, table: "pl.DataFrame") -> None:
        """Keep more rows."""
        self.tables.append(table)

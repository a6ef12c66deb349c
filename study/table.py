"""The table of a study: one row a run, the same columns however the runs came about."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Self

from stickslip.diagram.diagram import Diagram
from stickslip.study.design import Design
from stickslip.study.measures import NAMES, limits, valves
from stickslip.study.points import Refusal

if TYPE_CHECKING:
    import polars as pl

HEAD = ("run", "point", "kick")


@dataclass(frozen=True, eq=False)
class Schema:
    """The columns: run, point, kick, the axes, status, reason, ended [s], and the measures."""

    design: Design
    signals: tuple[str, ...]
    units: Mapping[str, str]
    words: tuple[bool, ...]  # which axes hold words
    measures: tuple[str, ...]

    @classmethod
    def of(
        cls, design: Design, diagrams: Sequence[Diagram], signals: Sequence[str], own: Sequence[str] | None = None
    ) -> Self:
        """Return the schema; saturation and slips are of all controllers and valves that these diagrams have.

        ``own``: the names of measures in place of the usual ones.
        """
        bounded = {signal for diagram in diagrams for signal in limits(diagram, signals)}
        names: list[str] = []
        for signal in signals:
            names += [f"{signal}.{name}" for name in NAMES] + [f"{signal}.saturated"] * (signal in bounded)
        names += [f"{valve}.slips" for valve in dict.fromkeys(v for diagram in diagrams for v in valves(diagram))]
        names = names if own is None else list(own)
        words = tuple(any(isinstance(value, str) for value in axis.values) for axis in design.axes)
        return cls(design, tuple(signals), diagrams[0].signal_units, words, tuple(names))

    def row(self, run: int, status: str, reason: str, ended: float, numbers: Mapping[str, float]) -> list[Any]:
        """Return a row; what a run has not is empty."""
        found = (numbers.get(name) for name in self.measures)
        return [
            *self._head(run),
            status,
            reason,
            ended,
            *(None if v is None or not math.isfinite(v) else v for v in found),
        ]

    def refusal(self, run: int, refusal: Refusal) -> list[Any]:
        """Return the row of a run that could not be made."""
        return self.row(run, refusal.status, refusal.reason, 0.0, {})

    def empty(self) -> "pl.DataFrame":
        """Return the table without rows."""
        return rows_of(self, [])

    def types(self) -> dict[str, Any]:
        """Return name -> type of the columns."""
        import polars as pl

        axes = zip(self.design.axes, self.words, strict=True)
        return {
            **dict.fromkeys(HEAD, pl.Int32),
            **{axis.column: pl.String if words else pl.Float64 for axis, words in axes},
            "status": pl.String, "reason": pl.String, "ended": pl.Float64,
            **{name: pl.Int32 if name.endswith(".slips") else pl.Float64 for name in self.measures},
        }  # fmt: skip

    def _head(self, run: int) -> list[Any]:
        point, kick = divmod(run, self.design.kicks)
        values = zip(self.design.at(point), self.words, strict=True)
        return [run, point, kick, *(_word(v) if words else v for v, words in values)]


def rows_of(schema: Schema, rows: Sequence[Sequence[Any]]) -> "pl.DataFrame":
    """Return rows as a table."""
    import polars as pl

    types = schema.types()
    columns = list(zip(*rows, strict=True)) if rows else [()] * len(types)
    return pl.DataFrame(
        [pl.Series(name, column, dtype=kind) for (name, kind), column in zip(types.items(), columns, strict=True)]
    )


def _word(value: object) -> str:
    return value if isinstance(value, str) else f"{value:g}"

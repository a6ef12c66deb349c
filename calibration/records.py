"""Features and truth of simulated loops, part by part: kept on disk, so that a run that was stopped goes on.

A part is ``PART`` loops of one setting, drawn with a seed of its own; parts of equal setting and seed are equal on
every machine but for rounding.  What is kept of a record is its features (``detect.judge.features``), not its signals.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from calibration.crossings import extent
from calibration.drawing import draw
from calibration.simulation import simulate
from calibration.spec import Setting, Truth
from detect.judge.features import features_of, view_of
from detect.prepare.prepared import Prepared
from logs import LoopRecord

__all__ = ["PART", "Table", "parts", "row", "table"]

Values = npt.NDArray[np.float64]
PART = 500  # loops


@dataclass(frozen=True, eq=False)
class Table:
    """Many records, one row each.

    names : (f,) of the features
    x : (n, f) features [-], all NaN for a record that shows too little for any
    unit : (n,) travel of OP that S is told in [% of OP span]; NaN without features
    truth : what is true of each, by name of the fields of ``calibration.Truth``, (n,)
    """

    names: npt.NDArray[np.str_]
    x: Values
    unit: Values
    truth: dict[str, npt.NDArray[np.generic]]

    def __len__(self) -> int:
        return len(self.x)

    @property
    def sticky(self) -> npt.NDArray[np.bool_]:
        """Whether the valve sticks, (n,)."""
        return np.asarray(self.truth["cause"] == "stiction")

    @property
    def seen(self) -> npt.NDArray[np.bool_]:
        """Whether the record shows enough for features, (n,)."""
        return np.asarray(np.isfinite(self.unit))

    def rows(self, keep: npt.NDArray[np.bool_]) -> "Table":
        """Only the rows kept (n,)."""
        return Table(self.names, self.x[keep], self.unit[keep], {k: v[keep] for k, v in self.truth.items()})

    @staticmethod
    def joined(tables: Sequence["Table"]) -> "Table":
        """Several tables of the same features, one after the other."""
        first = tables[0]
        truth = {k: np.concatenate([t.truth[k] for t in tables]) for k in first.truth}
        return Table(
            first.names, np.concatenate([t.x for t in tables]), np.concatenate([t.unit for t in tables]), truth
        )


def row(record: LoopRecord) -> tuple[dict[str, float], float] | None:
    """The features of a record and the travel of OP in its unit; None where it shows too little."""
    view = view_of(Prepared(record))
    return None if view is None else (features_of(view), view.travel * view.op_scale)


def table(told: Sequence[tuple[LoopRecord, Truth]]) -> Table:
    """The table of simulated records.

    >>> from calibration import draw, simulate
    >>> made = table(simulate(draw(2, seed=3)))
    >>> len(made), bool(made.sticky[0])
    (2, True)
    """
    found = [row(record) for record, _ in told]
    names = next((list(one[0]) for one in found if one is not None), [])
    x = np.full((len(told), len(names)), np.nan)
    unit = np.full(len(told), np.nan)
    for k, (one, (_, truth)) in enumerate(zip(found, told, strict=True)):
        shown = extent(told[k][0].op)
        if one is not None and shown > 0.0:
            x[k] = list(one[0].values())
            # the range of OP is known in % of its span from the simulation, the record may not tell the span
            unit[k] = one[1] * truth.op_range / shown
    truths = {f.name: np.array([getattr(t, f.name) for _, t in told]) for f in fields(Truth) if f.name != "defects"}
    truths["defects"] = np.array([" ".join(t.defects) for _, t in told])
    return Table(np.array(names), x, unit, truths)


def parts(folder: Path, setting: Setting, seed: int, count: int, workers: int | None = None) -> Iterator[Table]:
    """The tables of ``count`` parts of a setting from ``seed`` on; those that are not in the folder yet are made."""
    folder.mkdir(parents=True, exist_ok=True)
    for k in range(count):
        file = folder / f"{setting}_{seed + k}.npz"
        if not file.exists():
            made = table(simulate(draw(PART, seed + k, setting), workers))
            part = file.with_suffix(".part.npz")
            arrays: dict[str, Any] = {"names": made.names, "x": made.x, "unit": made.unit, **made.truth}
            np.savez_compressed(part, **arrays)
            part.replace(file)
        with np.load(file) as kept:
            own = {name: kept[name] for name in kept.files}
        yield Table(own.pop("names"), own.pop("x"), own.pop("unit"), own)

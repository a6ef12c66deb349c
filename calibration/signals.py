"""Training data of the network: signals of simulated loops, saved part by part, and the channels made of them."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from stickslip.calibration.crossings import extent
from stickslip.calibration.laws import Law, loops
from stickslip.calibration.spec import Kinds
from stickslip.detect.judge.features.channels import LOOKED_AT
from stickslip.detect.judge.features.network import seen_by
from stickslip.detect.judge.features.view import View, view_of
from stickslip.detect.prepare.prepared import Prepared
from stickslip.logs.files.resumable import Kept, differences, joined, opened

__all__ = ["Examples", "examples"]

PART = 500  # loops
KEPT = Kept(
    "signals", "stickslip.calibration.signals/1", "number", ValueError, partial(differences, phrases_of={})
)  # fmt: skip


@dataclass(frozen=True, eq=False)
class Examples:
    """Loops as the network sees them.

    x : of each loop (``CHANNELS``, points) [-] in half precision
    group : (n,) kind of loop; size : (n, 2) ln S and ln J over OP's travel, NaN where none sticks
    """

    x: Sequence[npt.NDArray[np.float16]]
    group: npt.NDArray[np.str_]
    size: npt.NDArray[np.float32]

    def __len__(self) -> int:
        return len(self.x)

    @property
    def length(self) -> npt.NDArray[np.int64]:
        """Points of each loop (n,)."""
        return np.array([one.shape[1] for one in self.x], dtype=np.int64)

    @staticmethod
    def joined(parts: Sequence["Examples"]) -> "Examples":
        """Several sets, one after the other."""
        x = [one for part in parts for one in part.x]
        return Examples(x, *(np.concatenate([getattr(part, name) for part in parts]) for name in ("group", "size")))


def examples(
    folder: Path, seed: int, count: int, setting: Law = "training", kinds: Kinds = "usual",
    workers: int | None = None,
) -> Examples:  # fmt: skip
    """The loops of ``count`` parts from ``seed`` on that show enough for a view, those made before from the folder.

    ``setting`` and ``kinds`` as in ``draw``.  Raises ``ValueError`` if the folder holds other loops.
    """
    import polars as pl

    with opened(folder, {"setting": setting, "seed": seed, "kinds": kinds, "part": PART}, KEPT, fresh=False) as place:
        place.note()
        there = place.firsts()
        for k in range(count):
            if k * PART not in there:
                place.add(pl.DataFrame(_columns(setting, seed + k, kinds, workers, k * PART)))
        rows = joined(place.rows(), KEPT.key).filter(pl.col(KEPT.key) < count * PART)
    x = [seen_by(_view(row)).astype(np.float16) for row in rows.iter_rows(named=True)]
    return Examples(x, rows["group"].to_numpy().astype(str), rows.select("S", "J").to_numpy().astype(np.float32))


def _columns(setting: Law, seed: int, kinds: Kinds, workers: int | None, first: int) -> dict[str, Any]:
    """One part as columns, its rows numbered from ``first`` on."""
    columns: dict[str, list[Any]] = {
        name: [] for name in ("number", "group", "S", "J", "turn", "u", "y", "e")
    }  # fmt: skip
    for loop, truth in loops(setting, PART, seed, kinds, workers):
        view, shown = view_of(Prepared(loop)), extent(loop.op)
        if view is None or not shown > 0.0:
            continue
        # the range of OP is known in % of its span from the simulation, the record may not tell the span
        unit = view.travel * view.op_scale * truth.op_range / shown
        own = {"number": first + len(columns["number"]), "group": truth.group, "turn": view.turn}
        sizes = np.log((truth.S / unit, truth.J / unit)) if truth.cause == "stiction" else (math.nan, math.nan)
        own |= {"S": float(sizes[0]), "J": float(sizes[1])}
        own |= {name: getattr(view, name)[:LOOKED_AT].astype(np.float32) for name in ("u", "y", "e")}
        for name, value in own.items():
            columns[name].append(value)
    return columns


def _view(row: dict[str, Any]) -> View:
    """A view with what the channels look at; all else is left open."""
    u, y, e = (np.array(row[name], dtype=np.float64) for name in ("u", "y", "e"))
    return View(
        u=u, y=y, e=e, turn=row["turn"], block=1, travel=float(np.ptp(u)), integrating=None, op_scale=1.0,
        seconds=float(len(u)),
    )  # fmt: skip

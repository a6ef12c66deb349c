"""Features and truth of simulated loops, part by part: kept on disk, so that a run that was stopped goes on.

A part is ``PART`` loops of one setting, drawn with a seed of its own; parts of equal setting and seed are equal on
every machine but for rounding.  Features are kept apart from signals (``chunks``), in
``stickslip.logs.files.resumable``.
"""

import hashlib
from collections.abc import Callable, Sequence
from concurrent.futures import as_completed
from dataclasses import dataclass, fields
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
import numpy.typing as npt
from stickslip.calibration.chunks import read, write
from stickslip.calibration.crossings import extent
from stickslip.calibration.laws import Law, loops
from stickslip.calibration.spec import Kinds, Truth
from stickslip.detect.judge.features import features_of, view_of
from stickslip.detect.judge.features.network import FILE as NETWORK
from stickslip.detect.judge.features.view import View
from stickslip.detect.prepare.prepared import Prepared
from stickslip.logs import LoopRecord
from stickslip.logs.arrays import Values
from stickslip.logs.files.resumable import Kept, differences, joined, opened
from stickslip.logs.processes import cores, processes

if TYPE_CHECKING:
    import polars as pl

__all__ = ["PART", "Table", "kept_table", "row", "table"]

Family: TypeAlias = Callable[[Prepared, View], dict[str, float]]
PART = 500  # loops
KEPT = Kept(
    "features", "stickslip.calibration.features/1", "number", ValueError,
    partial(differences, phrases_of={"code": "features or simulation have changed since"}),
)  # fmt: skip


@dataclass(frozen=True, eq=False)
class Table:
    """Many records, one row each.

    names : (f,) of the features
    x : (n, f) features [-], all NaN for a record that shows too little for any
    unit : (n,) travel of OP in which S is stated [% of OP span]; NaN without features
    truth : what is true of each, by name of the fields of ``stickslip.calibration.Truth``, (n,)
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


def row(record: LoopRecord, family: Family = features_of) -> tuple[dict[str, float], float] | None:
    """The features of a record and the travel of OP in its unit; None where it shows too little.

    ``family`` makes them of a record and its view: by default all of ``stickslip.detect.judge.features``.
    """
    loop = Prepared(record)
    view = view_of(loop)
    return None if view is None else (family(loop, view), view.travel * view.op_scale)


def table(labelled: Sequence[tuple[LoopRecord, Truth]], family: Family = features_of) -> Table:
    """The table of simulated records; ``family`` as in ``row``.

    >>> from stickslip.calibration import draw, simulate
    >>> made = table(simulate(draw(2, seed=3)))
    >>> len(made), bool(made.sticky[0])
    (2, True)
    """
    found = [row(record, family) for record, _ in labelled]
    names = sorted({name for one in found if one is not None for name in one[0]})
    x = np.full((len(labelled), len(names)), np.nan)
    unit = np.full(len(labelled), np.nan)
    for k, (one, (_, truth)) in enumerate(zip(found, labelled, strict=True)):
        shown = extent(labelled[k][0].op)
        if one is not None and shown > 0.0:
            x[k] = [one[0].get(name, np.nan) for name in names]
            # the range of OP is known in % of its span from the simulation, the record may not tell the span
            unit[k] = one[1] * truth.op_range / shown
    truths = {f.name: np.array([getattr(t, f.name) for _, t in labelled]) for f in fields(Truth) if f.name != "defects"}
    truths["defects"] = np.array([" ".join(t.defects) for _, t in labelled])
    return Table(np.array(names), x, unit, truths)


def kept_table(
    folder: Path, setting: Law, seed: int, count: int, workers: int | None = None, kinds: Kinds = "usual"
) -> Table:
    """The table of ``count`` parts of a setting from ``seed`` on; parts not yet in the folder are made and kept there.

    ``workers`` processes (default all cores); ``kinds`` as in ``draw``.  Loops of the engine, which take a tenth of a
    second each, are kept too (``chunks``), so that other features can be tried without simulating them again; those in
    sampled time are not.
    Raises ``ValueError`` if the folder holds features of another version.
    """
    from rich.progress import track

    asked = {"setting": setting, "seed": seed, "kinds": kinds, "part": PART, "code": _code()}
    with opened(folder / f"{setting}_{seed}", asked, KEPT, fresh=False) as place:
        place.note()
        there = place.firsts()
        missing = [k for k in range(count) if k * PART not in there]
        with processes(workers or cores()) as pool:
            waited = {pool.submit(made_part, folder, setting, seed + k, kinds): k for k in missing}
            for done in track(as_completed(waited), f"{setting} loops from seed {seed}", len(missing)):
                place.add(_frame(done.result(), waited[done] * PART))
        rows = joined(place.rows(), KEPT.key)
    return _unframed(rows.filter(rows[KEPT.key] < count * PART))


def made_part(folder: Path, setting: Law, seed: int, kinds: Kinds = "usual") -> Table:
    """One part, in this process."""
    if setting != "other_physics":
        return table(loops(setting, PART, seed, kinds))
    kept = folder / f"loops_{setting}_{seed}"
    write(kept, PART, seed, setting, 1, progress=False)
    return table([(record, truth) for _, record, truth in read(kept)])


ROOMS_OF_FEATURES = (
    "judge/features", "half_waves", "health", "likelihood", "oscillation", "prepare", "signals", "stem",
)  # fmt: skip


def _code() -> str:
    """What the features of simulated loops depend on, as a digest."""
    here = Path(__file__).parents[1]
    digest = hashlib.sha256()
    for place in ("calibration", *(f"detect/{room}" for room in ROOMS_OF_FEATURES)):
        for file in sorted((here / place).rglob("*.py")):
            digest.update(file.read_bytes())
    digest.update(NETWORK.read_bytes())
    return digest.hexdigest()[:16]


def _frame(made: Table, first: int) -> "pl.DataFrame":
    """A table as rows numbered from ``first`` on."""
    import polars as pl

    columns: dict[str, Any] = {KEPT.key: np.arange(first, first + len(made)), "unit": made.unit}
    columns |= {f"x {name}": made.x[:, k] for k, name in enumerate(made.names.tolist())}
    columns |= {f"truth {name}": values for name, values in made.truth.items()}
    return pl.DataFrame(columns)


def _unframed(rows: "pl.DataFrame") -> Table:
    """The table that rows hold."""
    names = [column[2:] for column in rows.columns if column.startswith("x ")]
    truth = {c.removeprefix("truth "): np.array(rows[c].to_list()) for c in rows.columns if c.startswith("truth ")}
    x = rows.select(f"x {name}" for name in names).to_numpy()
    return Table(np.array(names), x.astype(np.float64), rows["unit"].to_numpy().astype(np.float64), truth)

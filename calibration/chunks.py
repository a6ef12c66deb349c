"""Large sets of simulated loops on disk: one row a loop, in parts that are made one after the other and resumable.

set.json    what was asked for            parts/*.parquet    ``CHUNK`` loops each, in the order of their numbers

The folder is one of ``stickslip.logs.files.resumable``: a part appears whole or not at all, holds the same loops
whenever it is made, and a second call makes what is missing.
"""

import json
from collections.abc import Iterator
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from stickslip.calibration.drawing import draw
from stickslip.calibration.simulation import simulate
from stickslip.calibration.spec import LoopSpec, Setting, Truth
from stickslip.diagram.progress import Progress, reporting
from stickslip.logs import LoopRecord
from stickslip.logs.files.resumable import PARTS, Kept, differences, opened

CHUNK = 500
SCHEMA = "stickslip.calibration/2"
KEPT = Kept("set", SCHEMA, "number", ValueError, partial(differences, phrases_of={}))


def write(
    folder: Path,
    n: int,
    seed: int,
    setting: Setting = "training",
    workers: int | None = None,
    progress: Progress = None,
) -> int:
    """Simulate ``n`` loops into ``folder`` and return how many were missing; ``workers`` threads (default all cores).

    ``progress`` as in ``stickslip.diagram.ensemble``.  Raises ``ValueError`` if the folder holds another set of loops.
    """
    asked = {"loops": n, "seed": seed, "setting": setting, "chunk": CHUNK}
    made = 0
    with opened(folder, asked, KEPT, fresh=False) as kept:
        kept.note()
        there = kept.firsts()
        sizes = {first: min(CHUNK, n - first) for first in range(0, n, CHUNK) if first not in there}
        with reporting(progress, sum(sizes.values()), "loops") as tell:
            for first, size in sizes.items():
                specs = draw(size, seed, setting, first=first)
                kept.add(_table(first, specs, simulate(specs, workers)))
                made += size
                tell(made, sum(sizes.values()))
    return made


def read(folder: Path) -> Iterator[tuple[LoopSpec, LoopRecord, Truth]]:
    """Yield spec, record and truth of all loops of a folder, in order.

    Raises ``FileNotFoundError`` if the folder holds no set of loops.
    """
    import polars as pl

    files = sorted((folder / PARTS).glob("*.parquet"))
    if not files:
        raise FileNotFoundError(
            f"'{folder}' holds no simulated loops; make them with: python -m stickslip.calibration simulate"
        )
    for file in files:
        for row in pl.read_parquet(file).iter_rows(named=True):
            spec = LoopSpec(**json.loads(row["spec"]))
            given = json.loads(row["truth"])
            truth = Truth(**{**given, "defects": tuple(given["defects"])})
            op, pv, sp = (None if row[key] is None else np.array(row[key]) for key in ("OP", "PV", "SP"))
            yield spec, _record(row, spec, op, pv, sp), truth


def _record(row: dict[str, Any], spec: LoopSpec, op: Any, pv: Any, sp: Any) -> LoopRecord:
    return LoopRecord.from_arrays(
        np.arange(len(pv), dtype=np.float64) * spec.dt, pv=pv, op=op, sp=sp, name=row["name"], process=row["process"],
        op_span=(0.0, 100.0) if spec.span_known else None,
    )  # fmt: skip


def _table(first: int, specs: list[LoopSpec], made: list[tuple[LoopRecord, Truth]]) -> Any:
    """One part, whose loops are numbered from ``first`` on."""
    import polars as pl

    signals = pl.List(pl.Float64)
    return pl.DataFrame(
        {
            "number": range(first, first + len(specs)),
            "spec": [json.dumps(asdict(spec)) for spec in specs],
            "truth": [json.dumps(asdict(truth)) for _, truth in made],
            "name": [loop.name for loop, _ in made],
            "process": [loop.process for loop, _ in made],
            "OP": [loop.op.tolist() for loop, _ in made],
            "PV": [loop.pv.tolist() for loop, _ in made],
            "SP": [None if loop.sp is None else loop.sp.tolist() for loop, _ in made],
        },
        schema_overrides={"OP": signals, "PV": signals, "SP": signals},
    )

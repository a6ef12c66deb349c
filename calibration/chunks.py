"""Large sets of simulated loops on disk: chunks of Parquet, one row a loop, made one after the other and resumable.

set.json               what was asked for            chunk_00000.parquet ...  4,000 loops each, in the order of their numbers

A chunk appears whole or not at all, and holds the same loops whenever it is made; a second call makes what is missing.
"""

import json
from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from calibration.drawing import draw
from calibration.simulation import simulate
from calibration.spec import LoopSpec, Setting, Truth
from diagram.progress import Progress, reporting
from logs import LoopRecord
from logs.files.write import replacing

CHUNK = 4000
SCHEMA = "stickslip.calibration/1"


def write(
    folder: Path,
    n: int,
    seed: int,
    setting: Setting = "training",
    workers: int | None = None,
    progress: Progress = None,
) -> int:
    """Simulate ``n`` loops into ``folder`` and return how many were missing; ``workers`` threads (default all cores).

    ``progress`` as in ``diagram.ensemble``.  Raises ``ValueError`` if the folder holds another set of loops.
    """
    asked = {"schema": SCHEMA, "loops": n, "seed": seed, "setting": setting, "chunk": CHUNK}
    folder.mkdir(parents=True, exist_ok=True)
    manifest = folder / "set.json"
    if manifest.exists() and (kept := json.loads(manifest.read_text())) != asked:
        raise ValueError(f"'{folder}' holds {kept}, but {asked} was asked for; give another folder")
    with replacing(manifest) as part:
        part.write_text(json.dumps(asked, indent=1) + "\n")
    missing = [first for first in range(0, n, CHUNK) if not _file(folder, first).exists()]
    sizes = {first: min(CHUNK, n - first) for first in missing}
    made = 0
    with reporting(progress, sum(sizes.values()), "loops") as tell:
        for first, size in sizes.items():
            specs = draw(size, seed, setting, first=first)
            _keep(_file(folder, first), specs, simulate(specs, workers))
            made += size
            tell(made, sum(sizes.values()))
    return made


def read(folder: Path) -> Iterator[tuple[LoopSpec, LoopRecord, Truth]]:
    """Yield spec, record and truth of all loops of a folder, in order.

    Raises ``FileNotFoundError`` if the folder holds no set of loops.
    """
    import polars as pl

    files = sorted(folder.glob("chunk_*.parquet"))
    if not files:
        raise FileNotFoundError(f"'{folder}' holds no simulated loops; make them with: python -m calibration simulate")
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


def _file(folder: Path, first: int) -> Path:
    return folder / f"chunk_{first // CHUNK:05d}.parquet"


def _keep(file: Path, specs: list[LoopSpec], made: list[tuple[LoopRecord, Truth]]) -> None:
    """Write one chunk."""
    import polars as pl

    signals = pl.List(pl.Float64)
    table = pl.DataFrame(
        {
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
    with replacing(file) as part:
        table.write_parquet(part, compression="zstd")

"""How often a verdict changes its word where the record hardly changes: crops, every second sample, a little noise.

    python -m benchmarks.stability [--quick] [--json FILE] [--loops N] [--folder DIR]

The records of ``STICKSLIP_DATA`` (their labels play no part) and crossed loops of simulation, seed 5.  A word is kept,
given up (another becomes "inconclusive"), taken up (the other way), or turned: from stiction to no stiction or back.
``spread`` says whether the mean of the log odds over the crops would tell sticky loops better than the whole record.
"""

import argparse
import csv
import math
import os
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from stickslip.calibration.crossed.drawing import Drawn, draw
from stickslip.calibration.crossed.history import seen
from stickslip.detect.judge.answer import answer
from stickslip.detect.prepare.prepared import Prepared
from stickslip.logs import LoopRecord, read_loop

from benchmarks.other_physics.scoring import figures as scored
from benchmarks.report import Figures, publish
from benchmarks.resumed import code_of, resumed

DATA = Path(os.environ.get("STICKSLIP_DATA") or Path(__file__).parents[2] / "shared" / "data")
SEED = 5
CROPS = {f"{end} {100 * share:.0f} %": (end, share) for share in (0.7, 0.8, 0.9) for end in ("first", "last")}
VARIANTS = (*CROPS, "every second sample", "1 % noise")
DECIDED = ("stiction", "no_stiction")
FAR = 0.4  # of the probability: a move that a reader sees

NOTES = {
    "real_turned": "real records, all variants: stiction becomes no stiction or back (goal: at most 0)",
    "real_changed": "real records: another word than that of the whole record, both ways (goal: below 0.05)",
    "simulated_turned": "crossed loops: stiction becomes no stiction or back (goal: at most 0)",
    "simulated_changed": "crossed loops: another word than that of the whole record",
    "auc: whole record": "crossed loops, sticky against sound, by the probability of the whole record",
    "auc: mean over crops": "the same by the mean of the log odds of the whole and of all crops",
}


@dataclass(frozen=True)
class Case:
    """A record by its file, or a loop that was drawn."""

    key: str
    file: str
    drawn: Drawn | None

    def record(self) -> LoopRecord:
        """The whole record."""
        return read_loop(DATA / self.file) if self.drawn is None else seen(self.drawn).record


def cases(loops: int) -> list[Case]:
    """All real records, and so many simulated ones."""
    found = []
    if (DATA / "loops.csv").exists():
        with (DATA / "loops.csv").open(encoding="utf-8", newline="") as file:
            found = [Case(row["loop"], row["file"], None) for row in csv.DictReader(file)]
    else:
        print(f"real records not found at {DATA}: NOT COUNTED; set STICKSLIP_DATA", file=sys.stderr)
    return found + [Case(f"{SEED}_{i}", "", one) for i, one in enumerate(draw(loops, SEED))]


def variants(record: LoopRecord) -> Iterator[tuple[str, LoopRecord]]:
    """The record as it is, "", and each of ``VARIANTS``."""
    yield "", record
    t0, whole = float(record.t[0]), float(record.t[-1] - record.t[0])
    for name, (end, share) in CROPS.items():
        first = t0 + (1.0 - share) * whole * (end == "last")
        yield name, replace(record, log=record.log.between(first, first + share * whole))
    yield "every second sample", _of(record, slice(None, None, 2), 0.0)
    yield "1 % noise", _of(record, slice(None), 0.01)


def _of(record: LoopRecord, rows: slice, noise: float) -> LoopRecord:
    """Some rows of a record, with noise on PV of that share of what nine tenths of it lie within."""
    spread = float(np.subtract(*np.nanpercentile(record.pv, [95, 5])))
    pv = record.pv + noise * spread * np.random.default_rng(SEED).normal(size=len(record))
    kept: dict[str, npt.NDArray[np.float64]] = {
        name: x[rows] for name, x in (("op", record.op), ("sp", record.sp), ("mv", record.mv)) if x is not None
    }
    span = record.log.spans.get(record.op_name)
    return LoopRecord.from_arrays(
        record.t[rows], pv=pv[rows], op_span=span, name=record.name, process=record.process, **kept
    )  # fmt: skip


def judged(case: Case) -> dict[str, Any]:
    """A row: word and probability of the record and of each variant."""
    row: dict[str, Any] = {"key": case.key, "real": case.drawn is None}
    if case.drawn is not None:
        row["kind"] = case.drawn.kind
    for name, record in variants(case.record()):
        said = answer(Prepared(record))
        row[f"word {name}"], row[f"p {name}"] = said.word, said.probability
    return row


def figures(rows: Sequence[Mapping[str, Any]]) -> Figures:
    """The figures of all rows."""
    out: Figures = {}
    for name, real in (("real", True), ("simulated", False)):
        these = [row for row in rows if row["real"] == real and row["word "] != "not_applicable"]
        if not these:
            continue
        for change, of in (
            ("turned", _turned),
            ("changed", _changed),
            ("given_up", _given_up),
            ("taken_up", _taken_up),
        ):
            out[f"{name}_{change}"] = _share(these, VARIANTS, of)
        for variant in VARIANTS:
            out[f"{name}_changed: {variant}"] = _share(these, (variant,), _changed)
        moved = [abs(row[f"p {v}"] - row["p "]) for row in these for v in CROPS if _both(row, v)]
        out[f"{name}_moved_far: crops"] = float(np.mean(np.array(moved) > FAR)) if moved else None
    drawn = [dict(row) | {"p": row["p "], "word": row["word "], "S_told": None} for row in rows if not row["real"]]
    if drawn:
        for row in drawn:
            row["p_mean"] = _mean([row[f"p {v}"] for v in ("", *CROPS)])
        for label, key in (("whole record", "p"), ("mean over crops", "p_mean")):
            scores = scored(drawn, key)
            out |= {f"auc: {label}": scores.get("auc"), f"calibration error: {label}": scores.get("calibration_error")}
    return out


def _share(rows: Sequence[Mapping[str, Any]], names: Sequence[str], of: Callable[[str, str], bool]) -> float:
    return float(np.mean([of(row["word "], row[f"word {name}"]) for row in rows for name in names]))


def _turned(before: str, after: str) -> bool:
    return before != after and before in DECIDED and after in DECIDED


def _changed(before: str, after: str) -> bool:
    return before != after


def _given_up(before: str, after: str) -> bool:
    return before in DECIDED and after not in DECIDED


def _taken_up(before: str, after: str) -> bool:
    return before not in DECIDED and after in DECIDED


def _both(row: Mapping[str, Any], variant: str) -> bool:
    return row["p "] is not None and row[f"p {variant}"] is not None


def _mean(values: Sequence[float | None]) -> float | None:
    """The probability of the mean log odds; None where the whole record has none."""
    if values[0] is None:
        return None
    odds = [math.log(q / (1.0 - q)) for p in values if p is not None for q in (min(max(p, 1e-4), 1.0 - 1e-4),)]
    return 1.0 / (1.0 + math.exp(-float(np.mean(odds))))


def main() -> int:
    """Judge all and print the figures; 1 if a goal is missed."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="4 loops, no real record")
    parser.add_argument("--json", metavar="FILE")
    parser.add_argument("--loops", type=int, default=100)
    parser.add_argument("--folder", type=Path, default=Path("stability_rows"))
    given = parser.parse_args()
    asked = [one for one in cases(4) if one.drawn] if given.quick else cases(given.loops)
    file = given.folder / f"{code_of('detect', 'calibration/crossed', 'benchmarks/other_physics')}.jsonl"
    rows = []
    for row in resumed(asked, judged, file, 1e9):
        rows.append(row)
        print(f"\r{len(rows)} of {len(asked)}", end="", file=sys.stderr)
    print(file=sys.stderr)
    for row in rows:
        if row["real"]:
            words = ", ".join(f"{v}: {row[f'word {v}']}" for v in VARIANTS if row[f"word {v}"] != row["word "])
            print(f"{row['key']:32}{row['word ']:16}{_percent(row['p ']):>6}  {words}")
    return 0 if publish(figures(rows), NOTES, given.json, given.quick) else 1


def _percent(p: float | None) -> str:
    return "-" if p is None else f"{p:.0%}"


if __name__ == "__main__":
    raise SystemExit(main())

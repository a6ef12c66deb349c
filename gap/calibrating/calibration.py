"""A calibration: what came out of runs of the user's own model with known effects, as far as they have been made.

Each run is a line of a file of the model; ``diagnose`` states probabilities by what has been counted so far.
``stickslip.gap.calibrating.calibrate`` makes the runs.
"""

import hashlib
import json
import math
import os
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from stickslip.diagram.diagram import Diagram
from stickslip.gap.answers.hit_rates import HitRates, counted
from stickslip.gap.records.record import Record


@dataclass(frozen=True)
class Calibration:
    """What came out of runs with known effects: ``rows``, one a run."""

    rows: tuple[Mapping[str, Any], ...]

    @property
    def hit_rates(self) -> HitRates:
        """How often names were right, by the kind of answer."""
        return HitRates(counted(self.rows), len(self.rows))

    @property
    def confusion(self) -> dict[str, dict[str, int]]:
        """Effect that was put in ("none") -> what was named -> runs; a class that holds the truth counts as it."""
        found: dict[str, Counter[str]] = {}
        for row in self.rows:
            found.setdefault(row["effect"], Counter())[row["effect"] if row["right"] else row["named"]] += 1
        return {name: dict(counts) for name, counts in sorted(found.items())}

    @property
    def limits(self) -> dict[str, tuple[float, float, str]]:
        """Effect -> (smallest size named right, largest size missed, parameter with unit); NaN where there is none.

        Smallest and largest by how far they are from neutral, to either side.
        """
        found: dict[str, tuple[float, float, str]] = {}
        for name in sorted({row["effect"] for row in self.rows} - {"none"}):
            rows = [row for row in self.rows if row["effect"] == name]
            least = min((row for row in rows if row["right"]), key=_far, default=None)
            missed = max((row for row in rows if not row["right"]), key=_far, default=None)
            sizes = [float("nan") if row is None else row["size"] for row in (least, missed)]
            found[name] = sizes[0], sizes[1], rows[0]["parameter"]
        return found

    def to_dict(self) -> dict[str, Any]:
        """Return the counts as plain values for JSON."""
        limits = {k: {"named": _known(a), "missed": _known(b), "parameter": what}
                  for k, (a, b, what) in self.limits.items()}  # fmt: skip
        return {"runs": len(self.rows), "confusion": self.confusion, "limits": limits,
                "right": {k: list(v) for k, v in counted(self.rows).items()}}  # fmt: skip

    def __str__(self) -> str:
        lines = [f"{len(self.rows)} runs of this model with known effects."]
        for name, counts in self.confusion.items():
            right, of = counts.get(name, 0), sum(counts.values())
            wrong = ", ".join(f"{what} {n}" for what, n in sorted(counts.items()) if what != name)
            least, missed, what = self.limits.get(name, (float("nan"), float("nan"), ""))
            size = [f"named from {least:.4g} on"] if least == least else []
            size += [f"missed up to {missed:.4g}"] if missed == missed else []
            sizes = f"; {what} {', '.join(size)}" if size else ""
            lines.append(f"  {name}: {right} of {of}{sizes}" + (f"; instead: {wrong}" if wrong else ""))
        for of_kind, (right, of) in counted(self.rows).items():
            lines.append(f"  answers '{of_kind}': right {right} of {of}")
        return "\n".join(lines)


def kept_calibration(model: Diagram, record: Record) -> Calibration:
    """Return what has been counted so far for a model with such records; nothing at first."""
    return Calibration(tuple(rows_of(file_of(model, record)).values()))


def folder() -> Path:
    """Return the folder of calibrations: ``gap`` in STICKSLIP_CACHE, by default ``~/.cache/stickslip``."""
    named = os.environ.get("STICKSLIP_CACHE")
    return (Path(named) if named else Path.home() / ".cache" / "stickslip") / "gap"


def file_of(model: Diagram, record: Record) -> Path:
    """Return the file of the runs of a model (wiring, parameters) with such records (signals, interval, rounding)."""
    key: list[object] = [record.pinned, record.played, round(record.log.dt, 9)]
    key.append({s: float(f"{step:.3g}") for s, step in record.steps.items()})
    for block in model.blocks:
        labels = list(block.input_labels), list(block.output_labels)
        key.append((type(block).__name__, block.name, labels, np.asarray(block.p).round(12).tolist()))
    return folder() / f"{hashlib.sha256(repr(key).encode()).hexdigest()[:24]}.runs.jsonl"


def rows_of(file: Path) -> dict[str, Any]:
    """Return key -> row of a file; a line that was not written to its end is left out."""
    found: dict[str, Any] = {}
    try:
        lines = file.read_text().splitlines()
    except OSError:
        return found
    for line in lines:
        try:
            row = json.loads(line)
            found[row["key"]] = row
        except (ValueError, KeyError, TypeError):
            continue
    return found


def _far(row: Mapping[str, Any]) -> float:
    """Return how far the size of a run's effect is from neutral: a factor by its logarithm, a rate by its inverse."""
    size, neutral = float(row["size"]), float(row.get("neutral", 0.0))
    if neutral > 0.0 and size > 0.0:
        return 1.0 / size if math.isinf(neutral) else abs(math.log(size / neutral))
    return abs(size - neutral)


def _known(value: float) -> float | None:
    return value if value == value else None

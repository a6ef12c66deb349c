"""Self-calibration: diagnose runs of the user's own model with known effects, and count what comes out.

Each run is a line of a file beside the floor of the model, so that a calibration that was stopped goes on where it was;
``diagnose`` states probabilities by what has been counted so far.
"""

import json
import time
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from diagram.diagram import Diagram
from diagram.progress import Progress, reporting
from gap.cache import digest, folder
from gap.candidates import candidates
from gap.effect import Effect
from gap.effects import CATALOGUE
from gap.injection import Injection, injections
from gap.problem import Problem
from gap.record import Record
from gap.report import GapReport
from gap.search import Candidate
from gap.sureness import Sureness, counted

Diagnose = Callable[..., GapReport]


@dataclass(frozen=True)
class Calibration:
    """What came out of runs with known effects: ``rows``, one a run."""

    rows: tuple[Mapping[str, Any], ...]

    @property
    def sureness(self) -> Sureness:
        """How often names were right, by the kind of answer."""
        return Sureness(counted(self.rows), len(self.rows))

    @property
    def confusion(self) -> dict[str, dict[str, int]]:
        """Effect that was put in ("none") -> what was named -> runs; a class that holds the truth counts as it."""
        found: dict[str, Counter[str]] = {}
        for row in self.rows:
            found.setdefault(row["effect"], Counter())[row["effect"] if row["right"] else row["named"]] += 1
        return {name: dict(counts) for name, counts in sorted(found.items())}

    @property
    def limits(self) -> dict[str, tuple[float, float, str]]:
        """Effect -> (smallest size named right, largest size missed, parameter with unit); NaN where there is none."""
        found: dict[str, tuple[float, float, str]] = {}
        for row in self.rows:
            if row["effect"] == "none":
                continue
            least, missed, what = found.get(row["effect"], (float("nan"), float("nan"), row["parameter"]))
            size = row["size"]
            if row["right"]:
                least = size if not least < size else least
            else:
                missed = size if not missed > size else missed
            found[row["effect"]] = least, missed, what
        return dict(sorted(found.items()))

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
            size = f"; named from {least:.4g} {what} on" if least == least else ""
            size += f", missed up to {missed:.4g}" if missed == missed else ""
            lines.append(f"  {name}: {right} of {of}{size}" + (f"; instead: {wrong}" if wrong else ""))
        for of_kind, (right, of) in counted(self.rows).items():
            lines.append(f"  answers '{of_kind}': right {right} of {of}")
        return "\n".join(lines)


def kept_calibration(model: Diagram, record: Record) -> Calibration:
    """Return what has been counted so far for a model with such records; nothing at first."""
    return Calibration(tuple(_rows(_file(model, record)).values()))


def calibrate(
    problem: Problem,
    diagram: Diagram,
    base: Problem,
    diagnose: Diagnose,
    *,
    catalogue: Sequence[Effect] = CATALOGUE,
    runs: int = 2,
    seed: int = 0,
    seconds: float = float("inf"),
    progress: Progress = None,
) -> Calibration:
    """Return the calibration of a model at the operating point of ``problem``, going on where it was stopped.

    ``base`` the problem of a run without a gap at the same point, which sizes are measured by; ``diagnose`` what is
    calibrated; ``runs`` of each effect; ``seconds`` after which it stops.
    """
    file = _file(problem.model, problem.record)
    done = _rows(file)
    legal = [
        *candidates(base, base.quiet, catalogue),
        *(Candidate(base, base.model, one, at) for one in catalogue if one.of_log for at in one.places(base.model)),
    ]
    plan = list(injections(base, legal, runs, seed))
    until = time.monotonic() + seconds
    with reporting(progress, len(plan), "runs with known effects") as tell:
        for k, one in enumerate(plan):
            if one.key not in done and time.monotonic() < until:
                log = one.made(problem)
                if log is not None:
                    done[one.key] = _row(one, diagnose(diagram, log, catalogue=catalogue, limits=False, progress=False))
                    file.parent.mkdir(parents=True, exist_ok=True)
                    with file.open("a") as out:
                        out.write(json.dumps(done[one.key]) + "\n")
            tell(k + 1, len(plan))
    return Calibration(tuple(done.values()))


def _row(one: Injection, report: GapReport) -> dict[str, Any]:
    named = [{cause.effect, *cause.ambiguous_with} for cause in report.causes]
    name = one.effect.name if one.effect else "none"
    places = set(report.where.confidence_set) if report.where else {""}
    unit = next((p.unit for p in one.effect.parameters if p.name == one.main), "") if one.effect else ""
    return {
        "key": one.key,
        "effect": name,
        "place": one.place,
        "values": dict(one.values),
        "size": one.values.get(one.main, 0.0),
        "parameter": f"{one.main} [{unit}]" if one.main else "",
        "named": " and ".join(c.effect for c in report.causes) or "none",
        "right": not report.gap if one.effect is None else len(named) == 1 and name in named[0],
        "place_right": one.place in places,
        "evidence": asdict(report.evidence) if report.evidence else None,
    }


def _file(model: Diagram, record: Record) -> Path:
    return folder() / f"{digest(model, record)}.runs.jsonl"


def _rows(file: Path) -> dict[str, Any]:
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


def _known(value: float) -> float | None:
    return value if value == value else None

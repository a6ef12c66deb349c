"""How much noise, sparse sampling, quantisation, compression and shortness of a record each method bears.

    python -m benchmarks.tolerance [--quick] [--json FILE] [--loops N] [--out FOLDER]

Loops with a sticky valve that cycle, and as many that oscillate or rest without one (``stickslip.calibration.draw``),
are brought to one clean state: 1 % noise, 25 samples a period, 40 cycles, no other defect.  Then one condition at a
time grows worse and every method judges again.  Noise is in the loop, so that the controller sees it; sampling,
quantisation and compression are the historian's, so that the loop does not.  ``--out`` writes tolerance.csv and a
picture a condition.
"""

import argparse
import csv
import io
import math
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from stickslip.calibration import LoopSpec, Truth, draw, simulate
from stickslip.detect import METHODS, compare
from stickslip.detect.methods import stem_play
from stickslip.logs import Log, LoopRecord
from stickslip.logs.files.write import replacing

from benchmarks.report import Figures, publish

if TYPE_CHECKING:
    from matplotlib.figure import Figure

LOOPS, QUICK, SEED = 32, 4, 20_260_801
NOISE, POINTS, CYCLES = 0.01, 25.0, 40  # of the clean state
DENSE = 60.0  # samples a period of the records that are thinned
AGAINST = ("tight_tuning", "external_sine", "external_square", "healthy")  # groups without a sticky valve
COLUMNS = ("condition", "level", "method", "sticky", "found", "others", "false_alarms", "undecided")
TESTED = [method for method in METHODS if method is not stem_play]  # that one needs MV, and nothing else matters to it


@dataclass(frozen=True)
class Condition:
    """What grows worse: ``levels`` from clean to bad; how a spec, or its record with what is true of it, is made so."""

    name: str
    axis: str
    levels: tuple[float, ...]
    spec: Callable[[LoopSpec, float], LoopSpec] = lambda spec, level: spec
    record: Callable[[LoopRecord, Truth, float], LoopRecord] = lambda record, truth, level: record


def _cut(record: LoopRecord, truth: Truth, cycles: float) -> LoopRecord:
    """The last so many cycles of a record; all of it where the loop has no period."""
    wanted = cycles * truth.period / record.dt if math.isfinite(truth.period) else math.inf
    n = len(record)
    return replace(record, log=record.log.samples(max(0, n - math.ceil(min(wanted, n))), n))


def _thinned(record: LoopRecord, truth: Truth, points: float) -> LoopRecord:
    """Every k-th sample, so that ``points`` are left in a period; a loop without one is taken to have the dense one."""
    dense = truth.period / record.dt if math.isfinite(truth.period) else DENSE
    every = max(1, round(dense / points))
    log = record.log
    kept = Log(
        log.t[::every], {name: x[::every] for name, x in log.signals.items()}, log.units, log.spans,
        origin=log.origin, start=log.start, notes=log.notes,
    )  # fmt: skip
    return replace(record, log=kept)


CONDITIONS = (
    Condition("noise", "standard deviation of the noise, share of the range of PV", (0.01, 0.03, 0.06, 0.12, 0.25, 0.5),
              lambda spec, level: replace(spec, noise=level)),
    Condition("sampling", "logged samples a period", (50.0, 25.0, 12.0, 8.0, 5.0, 3.0),
              lambda spec, level: replace(spec, points=DENSE, samples=round(CYCLES * DENSE)), _thinned),
    Condition("quantisation", "steps in the range of PV", (1000.0, 100.0, 32.0, 16.0, 8.0, 4.0),
              lambda spec, level: replace(spec, step_pv=level)),
    Condition("compression", "deviation of the swinging door, share of the range", (0.0, 0.01, 0.03, 0.06, 0.12, 0.25),
              lambda spec, level: replace(spec, door=level)),
    Condition("length", "cycles in the record", (40.0, 20.0, 12.0, 8.0, 5.0, 3.0), record=_cut),
)  # fmt: skip


@dataclass(frozen=True)
class Point:
    """What one method said at one level: loops with and without a sticky valve, found, false alarms, undecided."""

    condition: str
    level: float
    method: str
    sticky: int
    found: int
    others: int
    false_alarms: int
    undecided: int


def clean(n: int, seed: int = SEED) -> list[LoopSpec]:
    """Return n loops in the clean state, half of them sticky and cycling, the rest spread over ``AGAINST``.

    >>> [spec.group for spec in clean(4)]
    ['cycling', 'tight_tuning', 'cycling', 'external_sine']
    """
    pool = draw(40 * n, seed)
    cycling = [spec for spec in pool if spec.group == "cycling"]
    others = {group: [spec for spec in pool if spec.group == group] for group in AGAINST}
    chosen = []
    for i in range(n // 2):
        chosen += [cycling[i], others[AGAINST[i % len(AGAINST)]][i // len(AGAINST)]]
    return [
        replace(
            spec, noise=NOISE, noise_time=0.0, coarse=0.0, walk=0.0, sp_move=0.0, points=POINTS,
            samples=round(POINTS * CYCLES), step_pv=0.0, step_op=0.0, door=0.0, stale=0.0, sp_logged=True,
            process_known=True, span_known=True,
        )
        for spec in chosen
    ]  # fmt: skip


def measure(specs: Sequence[LoopSpec], conditions: Sequence[Condition] = CONDITIONS, tell: bool = False) -> list[Point]:
    """Return a point for every condition, level and method."""
    points: list[Point] = []
    total = sum(len(condition.levels) for condition in conditions)
    for condition in conditions:
        for level in condition.levels:
            made = simulate([condition.spec(spec, level) for spec in specs])
            found = compare([condition.record(record, truth, level) for record, truth in made], TESTED)
            sticky = [truth.cause == "stiction" for _, truth in made]
            for k, method in enumerate(TESTED):
                words = [judged.verdicts[k].verdict for judged in found.loops]
                said = [word == "stiction" for word in words]
                points.append(
                    Point(
                        condition.name, level, method.CARD.name, sum(sticky),
                        sum(a and b for a, b in zip(said, sticky, strict=True)), len(sticky) - sum(sticky),
                        sum(a and not b for a, b in zip(said, sticky, strict=True)),
                        sum(word in ("inconclusive", "not_applicable") for word in words),
                    )
                )  # fmt: skip
            if tell:
                done = len(points) // len(TESTED)
                print(f"\r{done} of {total} levels", end="", file=sys.stderr, flush=True)
    return points


def to_csv(points: Sequence[Point]) -> str:
    """The points as CSV with a header."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(COLUMNS)
    writer.writerows([getattr(point, column) for column in COLUMNS] for point in points)
    return out.getvalue()


def read_csv(text: str) -> list[Point]:
    """The points of ``to_csv``.

    >>> points = [Point("noise", 0.1, "m", 4, 3, 4, 0, 2)]
    >>> read_csv(to_csv(points)) == points
    True
    """
    kinds = {"condition": str, "level": float, "method": str}
    rows = csv.DictReader(io.StringIO(text))
    return [Point(**{column: kinds.get(column, int)(row[column]) for column in COLUMNS}) for row in rows]


def figure(points: Sequence[Point], condition: Condition) -> "Figure":
    """A panel a method: share of the sticky loops found, and of the others accused, from clean to bad."""
    from stickslip.logs.picture import Picture
    from stickslip.logs.style import INK, RED, tidy

    names = [method.CARD.name for method in TESTED if method.CARD.accuses]
    columns = 5
    rows = -(-len(names) // columns)
    picture = Picture(figsize=(11.0, 0.9 + 1.45 * rows), layout="constrained")
    panels = picture.subplots(rows, columns, sharex=True, sharey=True, squeeze=False).ravel()
    at = range(len(condition.levels))
    for ax, name in zip(panels, names, strict=False):
        own = {p.level: p for p in points if p.condition == condition.name and p.method == name}
        row = [own[level] for level in condition.levels]
        ax.plot(at, [p.found / max(p.sticky, 1) for p in row], "-o", color=INK, ms=3, lw=1.2)
        ax.plot(at, [p.false_alarms / max(p.others, 1) for p in row], "--s", color=RED, ms=2.5, lw=1.0)
        ax.set_title(name.replace("_", " "), fontsize=8.5, loc="left")
        ax.set_ylim(-0.05, 1.05)
        ax.set_xticks(list(at), [f"{level:g}" for level in condition.levels], fontsize=7)
        tidy(ax)
    for ax in panels[len(names) :]:
        ax.axis("off")
    picture.suptitle(
        "Line: share of the sticky loops found.  Dashed: share of the others accused.", x=0.01, ha="left", fontsize=9.5
    )
    picture.supxlabel(condition.axis, fontsize=9.5)
    return picture


def figures(points: Sequence[Point]) -> Figures:
    """The headline figure of a condition: the methods that still find half of what they find when all is clean."""
    found: Figures = {"methods": float(len(TESTED))}
    for condition in CONDITIONS:
        first, last = condition.levels[0], condition.levels[-1]
        rows = {(p.level, p.method): p.found for p in points if p.condition == condition.name}
        able = [m.CARD.name for m in TESTED if rows.get((first, m.CARD.name), 0) > 0]
        left = [name for name in able if 2 * rows[last, name] >= rows[first, name]]
        found[f"{condition.name}_able"], found[f"{condition.name}_left"] = float(len(able)), float(len(left))
    return found


NOTES = {"methods": "methods tested"} | {
    f"{c.name}_{what}": text
    for c in CONDITIONS
    for what, text in (
        ("able", f"find a sticky loop at {c.levels[0]:g} {c.axis}"),
        ("left", f"of them still find half as many at {c.levels[-1]:g}"),
    )
}


def main() -> None:
    """Measure, print, and write the curves if asked to."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="4 loops, for continuous integration")
    parser.add_argument("--json", metavar="FILE", help="also write one flat JSON object ('-': standard output, alone)")
    parser.add_argument("--loops", type=int, default=LOOPS, help="how many loops at each level (default 32)")
    parser.add_argument("--out", type=Path, metavar="FOLDER", help="write tolerance.csv and a picture a condition")
    chosen = parser.parse_args()
    points = measure(clean(QUICK if chosen.quick else chosen.loops), tell=sys.stderr.isatty())
    if chosen.out is not None:
        chosen.out.mkdir(parents=True, exist_ok=True)
        with replacing(chosen.out / "tolerance.csv") as part:
            part.write_text(to_csv(points))
        for condition in CONDITIONS:
            figure(points, condition).savefig(chosen.out / f"tolerance_{condition.name}.png", dpi=110)
    publish(figures(points), NOTES, chosen.json, chosen.quick)


if __name__ == "__main__":
    main()

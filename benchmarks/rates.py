"""How often each method is right on simulated loops whose cause is known: the measured columns of ``stickslip table``.

    python -m benchmarks.rates [--quick] [--json FILE] [--loops N] [--seed N] [--folder DIR] [--again NAME] [--write]

Draws loops (``stickslip.calibration.draw``, setting "other_physics", half of them with a sticky valve), puts every
method to each, and counts its verdicts by group of loops.  No threshold of any method was set on them.  For the delay
the first ``STREAMED`` sticky loops are fed sample by sample to ``LoopStream``, which watches with the streaming twin of
a method or with a sliding window, and asked at ``CHECKS`` periods of the loop: the delay is the first time of an alarm.
The row "combined" is the verdict of ``stickslip check`` on the record without MV.  ``--write`` keeps all in
``detect/rates.json``, which the table prints; ``--quick`` takes 8 loops; ``--again combined`` counts one row anew on
the loops that are kept, in two minutes.  All 416 loops take six minutes of one core; what is counted is kept
in ``--folder``, a line for every 26 loops, and a second call goes on where the first was stopped, unless the methods or
the simulated loops have changed in between: then it begins anew, so that all rows are of one version.
"""

import argparse
import json
import math
import re
import statistics
import sys
from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from stickslip.calibration import LoopSpec, Truth, draw, simulate
from stickslip.detect import METHODS, compare
from stickslip.detect.judge.answer import answer
from stickslip.detect.loop_stream import LoopStream
from stickslip.detect.methods import stem_play
from stickslip.detect.prepare.prepared import Prepared
from stickslip.detect.rates import COMBINED, FILE, SCHEMA, of_counts
from stickslip.detect.stream import LoopFacts, Sample
from stickslip.detect.words import WORDS as WORDING
from stickslip.detect.words import Word
from stickslip.logs import LoopRecord
from stickslip.logs.files.write import replacing
from stickslip.logs.hint import nearest

from benchmarks.report import Figures, publish
from benchmarks.resumed import code_of, resumed

LOOPS, QUICK = 416, 8
SEED = 20_260_701  # used for nothing else
SETTING = "other_physics"
STREAMED = 24  # sticky loops that are also fed sample by sample
CHECKS = (2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0, 24.0, 32.0, 48.0, 64.0)  # periods after which the twins are asked
FOLDER = Path("rates_parts")
BATCH = 26  # every group without stiction once
WORDS: tuple[Word, ...] = tuple(WORDING)

NOTES = {
    "loops": "simulated loops, half of them sticky",
    "combined_hit_rate": "share of the sticky loops that the combined verdict calls sticky",
    "combined_false_alarms": "share of the other loops that it calls sticky",
    "best_hit_rate": "the largest hit rate of a method alone",
    "best_method": "the method of that hit rate",
    "best_false_alarms": "its false alarms",
}


@dataclass
class Counted:
    """What has been counted: method -> group -> word -> loops, times per sample [us], periods until the alarm."""

    words: dict[str, dict[str, Counter[str]]] = field(default_factory=lambda: defaultdict(lambda: defaultdict(Counter)))
    microseconds: dict[str, list[float]] = field(default_factory=lambda: defaultdict(list))
    periods: dict[str, list[float]] = field(default_factory=lambda: defaultdict(list))
    streamed: int = 0

    def add(self, record: LoopRecord, stem: LoopRecord, truth: Truth) -> None:
        """Put every method to a record; ``stem`` is the same loop with MV logged, for the method that needs it."""
        (judged,) = compare(record, [m for m in METHODS if m is not stem_play]).loops
        (with_stem,) = compare(stem, [stem_play]).loops
        self.words[COMBINED][truth.group][answer(Prepared(record)).word] += 1
        for one in (judged, with_stem):
            for verdict, spent in zip(one.verdicts, one.milliseconds, strict=True):
                self.words[verdict.method][truth.group][verdict.verdict] += 1
                self.microseconds[verdict.method].append(1e3 * spent / one.samples)

    def follow(self, record: LoopRecord, truth: Truth) -> None:
        """Feed a sticky loop sample by sample and note after how many periods each method raises the alarm."""
        watching = [method for method in METHODS if method is not stem_play]
        stream = LoopStream(LoopFacts.of(record), watching)
        open_checks, waiting = list(CHECKS), {method.CARD.name for method in watching}
        self.streamed += 1
        for t, sample in _samples(record):
            stream = stream.update(t, sample)
            if open_checks and t - record.t[0] >= open_checks[0] * truth.period:
                periods = open_checks.pop(0)
                for verdict in stream.verdicts():
                    if verdict.verdict == "stiction" and verdict.method in waiting:
                        waiting.remove(verdict.method)
                        self.periods[verdict.method].append(periods)

    def row(self) -> dict[str, Any]:
        """Return the counts as plain values that JSON holds; ``join`` reads them again."""
        return {
            "words": {m: {g: dict(words) for g, words in groups.items()} for m, groups in self.words.items()},
            "microseconds": dict(self.microseconds), "periods": dict(self.periods), "streamed": self.streamed,
        }  # fmt: skip

    def join(self, row: Mapping[str, Any]) -> None:
        """Add the counts of other loops, as ``row`` gives them."""
        for method, groups in row["words"].items():
            for group, words in groups.items():
                self.words[method][group].update(words)
        for kind in ("microseconds", "periods"):
            for method, values in row[kind].items():
                getattr(self, kind)[method].extend(values)
        self.streamed += row["streamed"]

    def kept(self, seed: int, loops: int) -> dict[str, Any]:
        """The counts as ``stickslip.detect.rates`` reads them."""
        return {
            "schema": SCHEMA,
            "made_by": "python -m benchmarks.rates --write",
            "setting": SETTING,
            "seed": seed,
            "loops": loops,
            "streamed": self.streamed,
            "words": list(WORDS),
            "counts": {
                method: {group: [words[word] for word in WORDS] for group, words in sorted(groups.items())}
                for method, groups in sorted(self.words.items())
            },
            "us_per_sample": {m: round(statistics.median(all_), 3) for m, all_ in sorted(self.microseconds.items())},
            "alarms": {
                m: {"found": len(self.periods[m]), "median_periods": _median(self.periods[m])}
                for m in sorted(method.CARD.name for method in METHODS if method is not stem_play)
            },
        }


def again(kept: Mapping[str, Any], names: Sequence[str]) -> dict[str, Any]:
    """The counts with the rows of ``names`` counted anew, on the same loops; times and delays stay as they are.

    ``names`` of methods, or "combined".  Raises ``ValueError`` for a name that is neither.
    """
    methods = {method.CARD.name: method for method in METHODS}
    unknown = [name for name in names if name not in methods and name != COMBINED]
    if unknown:
        raise ValueError(f"no method {unknown[0]!r}; {nearest(unknown[0], [COMBINED, *methods])}")
    words: dict[str, dict[str, Counter[str]]] = {name: defaultdict(Counter) for name in names}
    specs = draw(kept["loops"], kept["seed"], kept["setting"])
    for first in range(0, len(specs), BATCH):
        for stem, truth in simulate(specs[first : first + BATCH], mv=True):
            blind, seen = Prepared(replace(stem, mv_name=None)), Prepared(stem)
            for name in names:
                if name == COMBINED:
                    word = answer(blind).word
                else:
                    word = methods[name].detect(seen if methods[name] is stem_play else blind).verdict
                words[name][truth.group][word] += 1
    rows = {
        name: {group: [by[w] for w in kept["words"]] for group, by in sorted(words[name].items())} for name in names
    }
    return {**kept, "counts": dict(sorted({**kept["counts"], **rows}.items()))}


def _median(values: Sequence[float]) -> float | None:
    return float(statistics.median(values)) if values else None


def _samples(record: LoopRecord) -> Iterator[tuple[float, Sample]]:
    sp = np.full(len(record), np.nan) if record.sp is None else record.sp
    for t, pv, op, set_point in zip(record.t, record.pv, record.op, sp, strict=True):
        yield float(t), Sample(float(pv), float(op), float(set_point))


@dataclass(frozen=True)
class Batch:
    """Loops that are counted together."""

    first: int
    specs: Sequence[LoopSpec]

    @property
    def key(self) -> str:
        """The number of its first loop, and how many they are."""
        return f"{self.first}+{len(self.specs)}"


def measure(specs: Sequence[LoopSpec], streamed: int = STREAMED, file: Path | None = None) -> Counted:
    """Count what every method says of the loops; what the ``file`` holds is not counted again.

    >>> counted = measure(draw(2, seed=1), streamed=0)
    >>> sum(counted.words["play_fit"]["excited"].values())
    1
    """
    counted = Counted()

    def row(batch: Batch) -> dict[str, Any]:
        return {"key": batch.key, **_counted(batch.specs, streamed - counted.streamed).row()}

    batches = [Batch(first, specs[first : first + BATCH]) for first in range(0, len(specs), BATCH)]
    for one in map(row, batches) if file is None else resumed(batches, row, file, math.inf):
        counted.join(one)  # before the next is made, so that the streamed loops are the first ones
        if sys.stderr.isatty():
            print(f"\r{one['key']} of {len(specs)}", end="", file=sys.stderr, flush=True)
    return counted


def _counted(specs: Sequence[LoopSpec], streamed: int) -> Counted:
    """Count one batch, up to ``streamed`` of its sticky loops sample by sample, too."""
    counted = Counted()
    for stem, truth in simulate(specs, mv=True):
        record = replace(stem, mv_name=None)
        counted.add(record, stem, truth)
        if truth.cause == "stiction" and np.isfinite(truth.period) and counted.streamed < streamed:
            counted.follow(record, truth)
    return counted


def write(kept: Mapping[str, Any]) -> None:
    """Keep the counts in ``detect/rates.json``, a line a group."""
    rows = re.sub(r"\[[^\]]*\]", lambda row: " ".join(row[0].split()), json.dumps(kept, indent=1))
    with replacing(FILE) as part:
        part.write_text(rows + "\n")


def figures(kept: Mapping[str, Any]) -> Figures:
    """The headline figures of what was counted."""
    rates = of_counts(kept)
    combined = rates[COMBINED]
    alone = [rate for name, rate in rates.items() if name not in (COMBINED, stem_play.CARD.name)]
    best = max(alone, key=lambda rate: rate.hit_rate)
    return {
        "loops": float(kept["loops"]), "combined_hit_rate": combined.hit_rate,
        "combined_false_alarms": combined.false_alarms, "best_hit_rate": best.hit_rate, "best_method": best.method,
        "best_false_alarms": best.false_alarms,
    }  # fmt: skip


def main() -> None:
    """Measure, print the headline figures, and keep the counts if asked to."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="8 loops, for continuous integration")
    parser.add_argument("--json", metavar="FILE", help="also write one flat JSON object ('-': standard output, alone)")
    parser.add_argument("--loops", type=int, default=LOOPS, help="how many loops (default 416)")
    parser.add_argument("--seed", type=int, default=SEED, help="of the loops drawn")
    parser.add_argument("--again", metavar="NAME", action="append", help="count this row anew on the kept loops: a "
                        "method, or combined; may be repeated")  # fmt: skip
    parser.add_argument("--folder", type=Path, default=FOLDER, metavar="DIR", help="where counts are kept on the way")
    parser.add_argument("--write", action="store_true", help="keep the counts in detect/rates.json")
    chosen = parser.parse_args()
    if chosen.again:
        kept = again(json.loads(FILE.read_text()), chosen.again)
        if chosen.write:
            write(kept)
        publish(figures(kept), NOTES, chosen.json, chosen.quick)
        return
    n = QUICK if chosen.quick else chosen.loops
    code = code_of("blocks", "calibration", "detect", "diagram", "engine", "logs", "plant")
    file = None if chosen.quick else chosen.folder / f"{chosen.seed}_{code}.jsonl"
    kept = measure(draw(n, chosen.seed, SETTING), 1 if chosen.quick else STREAMED, file).kept(chosen.seed, n)
    if chosen.write:
        write(kept)
    publish(figures(kept), NOTES, chosen.json, chosen.quick)


if __name__ == "__main__":
    main()

"""Random diagrams until the time is up: the engine against oracles outside it.

    python -m benchmarks.torture [--minutes N] [--from SEED] [--to SEED] [--seed SEED] [--quick] [--json FILE]

Each seed gives a diagram (``draw``) that the engine simulates and an oracle judges (``judge``).  Seeds are taken one
after the other from ``--from`` on; the last line says where to go on.  ``--seed`` repeats one and tells all about it.
Exit codes: 0 nothing found, 1 findings.
"""

import argparse
import json
import sys
import time
from collections import Counter
from pathlib import Path

from benchmarks.report import Figures, publish
from benchmarks.torture.c_program import NoCompiler, program
from benchmarks.torture.draw import draw
from benchmarks.torture.judge import Judgement, judge

QUICK = 12  # diagrams

NOTES = {
    "diagrams": "drawn and simulated",
    "agree": "of them the oracle finds the same in every signal, off the scans, within 1e-5 of 1 + its size",
    "findings": "of them it does not (required: at most 0)",
    "undecided": "of them the oracle differs from itself, or asked more finely both agree: nothing proved",
    "skipped": "of them the oracle failed or took too long",
    "by_c": "of all judged by the C program",
    "by_reference": "of all judged by stickslip.diagram.reference",
    "largest_difference": "where they agree",
    "most_steps": "of the engine for one diagram",
    "slowest_s": "longest run of the engine [s]",
    "seconds": "the whole search took [s]",
    "next_seed": "go on with --from this",
}


def options() -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(prog="benchmarks.torture", description=__doc__.splitlines()[0])
    parser.add_argument("--minutes", type=float, default=1.0, help="how long to search (default: 1)")
    parser.add_argument("--from", type=int, default=0, dest="first", metavar="SEED", help="first seed (default: 0)")
    parser.add_argument("--to", type=int, metavar="SEED", help="last seed; then --minutes does not count")
    parser.add_argument("--seed", type=int, help="repeat this one seed and tell all about it")
    parser.add_argument("--quick", action="store_true", help=f"{QUICK} diagrams, for continuous integration")
    parser.add_argument("--json", metavar="FILE", help="write figures and judgements too ('-': to standard output)")
    chosen = parser.parse_args()
    if not chosen.minutes > 0.0:
        parser.error(f"--minutes {chosen.minutes:g}, but a search takes some time; give more than 0")
    if min(chosen.first, chosen.seed or 0) < 0 or (chosen.to is not None and chosen.to < chosen.first):
        parser.error("seeds are whole numbers of 0 or more, and --to is not before --from")
    return chosen


def main() -> int:
    """Search, print and return the exit code."""
    chosen = options()
    try:
        program()
    except NoCompiler as reason:
        print(f"{reason}; all diagrams go to stickslip.diagram.reference, which is slow", file=sys.stderr)
    first, last = chosen.first, chosen.to
    if chosen.quick:
        last = first + QUICK - 1
    if chosen.seed is not None:
        first = last = chosen.seed
        print(_described(first), file=sys.stderr)
    begin = time.perf_counter()
    judged: list[Judgement] = []
    seed = first
    try:
        while seed <= last if last is not None else time.perf_counter() - begin < 60.0 * chosen.minutes:
            judged.append(judge(draw(seed)))
            if judged[-1].verdict == "finding" or chosen.seed is not None:
                print(f"seed {seed}: {judged[-1].verdict}, {judged[-1].why or 'in every signal'}\n"
                      f"    python -m benchmarks.torture --seed {seed}", file=sys.stderr)  # fmt: skip
            seed += 1
    except KeyboardInterrupt:
        print(f"interrupted at seed {seed}", file=sys.stderr)
    figures = _figures(judged, time.perf_counter() - begin, seed)
    if chosen.json:
        document = {**figures, "judgements": [one.to_dict() for one in judged if one.verdict != "agree"]}
        text = json.dumps(document, indent=2) + "\n"
        if chosen.json == "-":
            print(text, end="")
        else:
            Path(chosen.json).write_text(text)
    if chosen.json != "-":
        publish(figures, NOTES, None)
    return 1 if figures["findings"] else 0


def _figures(judged: list[Judgement], seconds: float, next_seed: int) -> Figures:
    verdicts = Counter(one.verdict for one in judged)
    oracles = Counter(one.oracle for one in judged)
    return {
        "diagrams": len(judged), "agree": verdicts["agree"], "findings": verdicts["finding"],
        "undecided": verdicts["undecided"], "skipped": verdicts["skipped"], "by_c": oracles["c"],
        "by_reference": oracles["reference"],
        "largest_difference": max((one.difference for one in judged if one.verdict == "agree"), default=0.0),
        "most_steps": max((one.steps for one in judged), default=0),
        "slowest_s": max((one.seconds for one in judged), default=0.0), "seconds": seconds, "next_seed": next_seed,
    }  # fmt: skip


def _described(seed: int) -> str:
    """Return the blocks of a seed's diagram, one a line."""
    drawn = draw(seed)
    lines = [f"seed {seed}: {drawn.duration:g} s, {len(drawn.diagram.blocks)} blocks"]
    for block in drawn.diagram.blocks:
        params = ", ".join(f"{name}={value:.6g}" for name, value in block.params.items())
        wires = f"{', '.join(block.input_labels)} -> {', '.join(block.output_labels)}"
        lines.append(f"    {type(block).__name__} {block.name}: {wires} ({params})")
    return "\n".join(lines)


if __name__ == "__main__":
    sys.exit(main())

"""What all benchmarks share: the options, the printed table, the flat JSON object of figures.

What is required of a figure stands in its note, e.g. "(required: at most 4)" or "(goal: at least 300)", and is judged
from there.  A quick run is too short to judge, and says so.
"""

import argparse
import json
import re
import statistics
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from stickslip.logs.hint import nearest

Figures = dict[str, float | str | None]
REQUIREMENT = re.compile(r"\((?:required|goal): (at most|at least|below) ([-+.\de]+)\b")


def options(description: str, parts: Sequence[str] = ()) -> argparse.Namespace:
    """Read ``--quick`` and ``--json FILE``, and ``--only PARTS`` of a benchmark that has some (default: all)."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("--quick", action="store_true", help="a short smoke version, for continuous integration")
    parser.add_argument("--json", metavar="FILE", help="also write one flat JSON object ('-': standard output, alone)")
    parser.add_argument("--only", metavar="A,B", default=",".join(parts), help=f"parts: {', '.join(parts) or 'none'}")
    chosen = parser.parse_args()
    chosen.only = [part.strip() for part in chosen.only.split(",") if part.strip()]
    for part in chosen.only:
        if part not in parts:
            parser.error(f"--only {part}: {nearest(part, parts)}")
    return chosen


def median_seconds(action: Callable[[], Any], repeats: int) -> float:
    """Return the median wall time of an action [s], after one warm-up; a single time judges nothing and has none."""
    if repeats > 1:
        action()
    taken = []
    for _ in range(repeats):
        begin = time.perf_counter()
        action()
        taken.append(time.perf_counter() - begin)
    return statistics.median(taken)


def in_turn(
    rounds: int, clock: Callable[[], float] = time.perf_counter, **actions: Callable[[], object]
) -> dict[str, list[float]]:
    """Return the times [s] of each action, wall times by default, all of them run once a round.

    One warm-up comes first, but before a single round, which judges nothing.
    """
    taken: dict[str, list[float]] = {name: [] for name in actions}
    for action in actions.values() if rounds > 1 else ():
        action()
    for _ in range(rounds):
        for name, action in actions.items():
            begin = clock()
            action()
            taken[name].append(clock() - begin)
    return taken


def meets(value: float | str | None, note: str) -> bool | None:
    """Return whether a figure is what its note requires; None without requirement or without a number.

    Raises ``ValueError`` for a requirement that cannot be read.

    >>> meets(3.1, "our time over C's (required: at most 4)"), meets(11.3, "our time over C's (required: at most 4)")
    (True, False)
    >>> meets(372.0, "their time over ours (goal: at least 300)"), meets(0.7, "seconds")
    (True, None)
    """
    if "(required:" not in note and "(goal:" not in note:
        return None
    found = REQUIREMENT.search(note)
    if found is None:
        raise ValueError(f"'{note}' requires something, but not '(required: at most NUMBER)', 'at least' or 'below'")
    if not isinstance(value, (int, float)):
        return None
    limit = float(found[2])
    return {"at most": value <= limit, "at least": value >= limit, "below": value < limit}[found[1]]


def publish(figures: Figures, notes: Mapping[str, str], json_file: str | None, quick: bool = False) -> bool:
    """Print the figures with their meaning and whether each meets what is required; write the JSON object if asked for.

    Returns whether no requirement is missed; a quick run judges none and misses none.
    """
    judged = {name: None if quick else meets(value, notes.get(name, "")) for name, value in figures.items()}
    if json_file == "-":
        print(json.dumps(figures, indent=2))
    else:
        width = max(len(name) for name in figures)
        for name, value in figures.items():
            shown = f"{value:.4g}" if isinstance(value, float) else str(value)
            mark = {True: "PASS", False: "MISS", None: ""}[judged[name]]
            print(f"{name:{width}}  {shown:>12}  {mark:4}  {notes.get(name, '')}")
        if any(REQUIREMENT.search(notes.get(name, "")) for name in figures):
            print(_summary(judged, quick))
        if json_file:
            Path(json_file).write_text(json.dumps(figures, indent=2) + "\n")
    return False not in judged.values()


def _summary(judged: Mapping[str, bool | None], quick: bool) -> str:
    if quick:
        return "a quick run is too short to judge what is required: run it without --quick"
    verdicts = [met for met in judged.values() if met is not None]
    missed = [name for name, met in judged.items() if met is False]
    return f"requirements met: {sum(verdicts)} of {len(verdicts)}" + (
        f"; missed: {', '.join(missed)}" if missed else ""
    )

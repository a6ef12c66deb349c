"""What all benchmarks share: the options, the printed table, the flat JSON object of figures."""

import argparse
import json
import statistics
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

Figures = dict[str, float | str | None]


def options(description: str) -> argparse.Namespace:
    """Read ``--quick`` and ``--json FILE``."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("--quick", action="store_true", help="a short smoke version, for continuous integration")
    parser.add_argument("--json", metavar="FILE", help="also write one flat JSON object ('-': standard output, alone)")
    return parser.parse_args()


def median_seconds(action: Callable[[], Any], repeats: int) -> float:
    """Return the median wall time of an action [s], after one warm-up."""
    action()
    taken = []
    for _ in range(repeats):
        begin = time.perf_counter()
        action()
        taken.append(time.perf_counter() - begin)
    return statistics.median(taken)


def publish(figures: Figures, notes: Mapping[str, str], json_file: str | None) -> None:
    """Print the figures with their meaning, and write the JSON object if asked for."""
    if json_file == "-":
        print(json.dumps(figures, indent=2))
        return
    width = max(len(name) for name in figures)
    for name, value in figures.items():
        shown = f"{value:.4g}" if isinstance(value, float) else str(value)
        print(f"{name:{width}}  {shown:>12}  {notes.get(name, '')}")
    if json_file:
        Path(json_file).write_text(json.dumps(figures, indent=2) + "\n")

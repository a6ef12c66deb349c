"""How often each method was right on simulated loops whose cause is known: measured, kept in ``rates.json``.

    hit rate       sticky loops called sticky / sticky loops
    false alarms   other loops called sticky / other loops
    abstentions    loops that the method left open or refused / loops
    acquitted      sticky loops called "no stiction" / sticky loops

``python -m benchmarks.rates --write`` measures again; the file says with which seed, setting and number of loops.
"""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from types import MappingProxyType
from typing import Any

SCHEMA = "stickslip.rates/1"
FILE = Path(__file__).with_name("rates.json")
COMBINED = "combined"  # the row of the combined verdict
STICKY = ("cycling", "excited")  # groups of loops with a sticky valve


@dataclass(frozen=True)
class Rate:
    """The counts of one method.

    sticky, others : int, loops with and without a sticky valve
    hits, wrong, acquitted, undecided : sticky loops called sticky; other loops called sticky; sticky loops called "no
        stiction"; loops left open or refused
    us_per_sample : float or None, median wall time [us] on the machine that measured
    delay : float or None, median data until the alarm of the streaming twin [periods]; None where none was raised
    by_group : group -> (called sticky, loops)
    """

    method: str
    sticky: int
    others: int
    hits: int
    wrong: int
    acquitted: int
    undecided: int
    us_per_sample: float | None
    delay: float | None
    by_group: Mapping[str, tuple[int, int]]

    @property
    def hit_rate(self) -> float:
        """Share of the sticky loops called sticky [-]; NaN of none."""
        return _share(self.hits, self.sticky)

    @property
    def false_alarms(self) -> float:
        """Share of the other loops called sticky [-]."""
        return _share(self.wrong, self.others)

    @property
    def abstentions(self) -> float:
        """Share of all loops that were left open or refused [-]."""
        return _share(self.undecided, self.sticky + self.others)


def _share(part: int, whole: int) -> float:
    return part / whole if whole else float("nan")


def of_counts(kept: Mapping[str, Any]) -> dict[str, Rate]:
    """The rates of counts as ``rates.json`` has them, by method.

    >>> counts = {"m": {"cycling": [6, 1, 2, 1], "healthy": [1, 8, 1, 0]}}
    >>> words = ["stiction", "no_stiction", "inconclusive", "not_applicable"]
    >>> rate = of_counts({"words": words, "counts": counts, "us_per_sample": {}, "alarms": {}})["m"]
    >>> rate.hit_rate, rate.false_alarms, rate.abstentions, rate.acquitted
    (0.6, 0.1, 0.2, 1)
    """
    words: list[str] = list(kept["words"])
    found = {}
    for method, groups in kept["counts"].items():
        counts = {group: dict(zip(words, row, strict=True)) for group, row in groups.items()}
        sticky = {group: row for group, row in counts.items() if group in STICKY}
        others = {group: row for group, row in counts.items() if group not in STICKY}
        found[method] = Rate(
            method,
            sum(sum(row.values()) for row in sticky.values()),
            sum(sum(row.values()) for row in others.values()),
            sum(row["stiction"] for row in sticky.values()),
            sum(row["stiction"] for row in others.values()),
            sum(row["no_stiction"] for row in sticky.values()),
            sum(row["inconclusive"] + row["not_applicable"] for row in counts.values()),
            kept["us_per_sample"].get(method),
            kept["alarms"].get(method, {}).get("median_periods"),
            MappingProxyType({group: (row["stiction"], sum(row.values())) for group, row in counts.items()}),
        )
    return found


@cache
def rates() -> Mapping[str, Rate]:
    """The rates of ``rates.json`` by method, with a row "combined"; empty where the file is not there."""
    return MappingProxyType(of_counts(_kept()) if FILE.exists() else {})


def described() -> str:
    """Where the rates come from, in plain sentences; "" where there are none."""
    if not FILE.exists():
        return ""
    kept = _kept()
    return (
        f"Measured on {kept['loops']} simulated loops (setting {kept['setting']}, seed {kept['seed']}); half of them "
        f"have a sticky valve. Delays come from {kept['streamed']} of these. To measure again: {kept['made_by']}"
    )


@cache
def _kept() -> dict[str, Any]:
    loaded: dict[str, Any] = json.loads(FILE.read_text(encoding="utf-8"))
    return loaded

"""The metadata of a log as text: kept in '# ' lines of a CSV file and in the footer of a Parquet file."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from datetime import datetime
from typing import Any

from stickslip.logs.errors import LogError
from stickslip.logs.loop_signals import LoopSignals
from stickslip.logs.signals import Signals

__all__ = ["FIRST_LINE", "Heading", "heading_of", "parse_heading"]

FIRST_LINE = "stickslip log 1"


@dataclass(frozen=True)
class Heading:
    """The metadata of signals in a file that this package wrote."""

    origin: str = ""
    start: datetime | None = None
    notes: tuple[str, ...] = ()
    units: Mapping[str, str] = field(default_factory=dict)
    spans: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    quality: Mapping[str, str] = field(default_factory=dict)  # signal -> column with 1 for good, 0 for bad
    names: tuple[str, ...] = ()
    loops: Mapping[str, LoopSignals] = field(default_factory=dict)

    def lines(self) -> list[str]:
        """The heading as text lines, without the '# '."""
        lines = [FIRST_LINE]
        if self.origin:
            lines.append(f"origin: {_text(self.origin)}")
        if self.start is not None:
            lines.append(f"start: {_text(self.start.isoformat())}")
        lines += [f"note: {_text(note)}" for note in self.notes]
        for name in self.names:
            facts: dict[str, Any] = {"name": name}
            if name in self.units:
                facts["unit"] = self.units[name]
            if name in self.spans:
                facts["span"] = self.spans[name]
            if name in self.quality:
                facts["quality"] = self.quality[name]
            lines.append(f"signal: {_text(facts)}")
        lines += [f"loop: {_text({'name': tag} | loop.to_dict())}" for tag, loop in self.loops.items()]
        return lines


def heading_of(log: Signals) -> Heading:
    """The heading of ``log``, with a free column name for each quality mask."""
    quality: dict[str, str] = {}
    taken: set[str] = set()
    for name in log.quality:
        column = f"{name}.good"
        while column in log or column in taken:
            column += "'"
        quality[name] = column
        taken.add(column)
    return Heading(
        origin=log.origin,
        start=log.start,
        notes=log.notes,
        units=log.units,
        spans=log.spans,
        quality=quality,
        names=log.names,
        loops=log.loops,
    )


def parse_heading(lines: Iterable[str]) -> Heading | None:
    """The heading in these lines, None when they were not written by this package.

    Lines that have been spoilt by an editor are passed over: the numbers are worth more than the heading.

    >>> parse_heading(["exported by hand"]) is None
    True
    >>> parse_heading(["stickslip log 1", 'origin: "simulated"', 'note: "One."']).origin
    'simulated'
    """
    kept = [line.strip() for line in lines]
    if FIRST_LINE not in kept:
        return None
    origin, start, notes = "", None, []
    names: list[str] = []
    units: dict[str, str] = {}
    spans: dict[str, tuple[float, float]] = {}
    quality: dict[str, str] = {}
    loops: dict[str, LoopSignals] = {}
    for line in kept:
        key, _, text = line.partition(": ")
        try:
            value = json.loads(text)
            if key == "origin":
                origin = str(value)
            elif key == "start":
                start = datetime.fromisoformat(value)
            elif key == "note":
                notes.append(str(value))
            elif key == "signal":
                name = str(value["name"])
                names.append(name)
                if "unit" in value:
                    units[name] = str(value["unit"])
                if "span" in value:
                    low, high = value["span"]
                    spans[name] = (float(low), float(high))
                if "quality" in value:
                    quality[name] = str(value["quality"])
            elif key == "loop":
                loops[str(value["name"])] = LoopSignals.from_dict(value)
        except (ValueError, TypeError, KeyError, AttributeError, RecursionError, LogError):
            continue
    return Heading(origin, start, tuple(notes), units, spans, quality, tuple(names), loops)


def _text(value: object) -> str:
    return json.dumps(value, ensure_ascii=False)

"""From the table of a file to a loop record: which columns play which part, the span of OP, the kind of process.

Everything that is guessed about a loop is guessed here, for one loop and for many.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from heapq import merge
from itertools import islice

import numpy as np
from stickslip.logs.errors import ReadError
from stickslip.logs.files.assemble import Layout, assemble
from stickslip.logs.files.columns import Roles, choose_columns, named_columns, why_unused
from stickslip.logs.files.names import plain, role_of
from stickslip.logs.hint import nearest
from stickslip.logs.log import Log
from stickslip.logs.loop import LoopRecord
from stickslip.logs.loop_signals import LoopSignals, within
from stickslip.logs.spans import guess_op_span
from stickslip.logs.tags import Process, measurement_of, process_of, tag_in

__all__ = ["Origin", "check_span", "loop_of", "loops_of", "with_loops"]

_UNUSED_SHOWN = 15


@dataclass(frozen=True)
class Origin:
    """Where a table came from: in words, its notes, whether we wrote it ourselves, the file's name without ending."""

    text: str
    notes: tuple[str, ...]
    own: bool
    stem: str

    def on(self, log: Log) -> Log:
        """The log with this origin."""
        return replace(log, origin=self.text, notes=(*self.notes, *log.notes))


class Others:
    """The columns (or tags) of a file that a loop does not use; those of the other loops among ``tags`` need no note.

    Worked out once for all loops of a file: what belongs to none of them, and what bears the tag of each.
    """

    def __init__(self, layout: Layout, tags: Iterable[str] = ()) -> None:
        self._layout = layout
        self._stray: dict[str, int] = {}  # column -> its place in the file
        self._by_tag: dict[str | None, dict[str, int]] = {plain(tag): {} for tag in tags}
        if layout.heading is None:
            for place, column in enumerate(dict.fromkeys([*layout.aside, *layout.names, *layout.marks])):
                for tag in {_tag_of(signal) for signal in layout.marks.get(column, (column,))}:
                    self._by_tag.get(tag, self._stray)[column] = place

    def about(self, roles: Roles) -> list[str]:
        """The sentence that names the columns that no loop uses, each with the reason; none in a file of our own."""
        used = set(roles.used.values())
        used |= {column for signal in used for column in self._layout.marks_of.get(signal, ())}
        own = {
            column: place
            for column, place in self._by_tag.get(plain(roles.loop), {}).items()
            if column not in self._stray
        }
        count = sum(len(columns) - len(used & columns.keys()) for columns in (self._stray, own))
        if not count:
            return []
        in_order = merge(self._stray.items(), own.items(), key=lambda item: item[1])
        first = list(islice((column for column, _ in in_order if column not in used), _UNUSED_SHOWN))
        alike: dict[str, list[str]] = {}
        for column in first:
            alike.setdefault(self._why(column, roles), []).append(repr(column))
        shown = [f"{', '.join(columns)} ({why})" for why, columns in alike.items()]
        rest = f" and {count - len(first)} more" if count > len(first) else ""
        return [f"Columns not used: {', '.join(shown)}{rest}."]

    def _why(self, column: str, roles: Roles) -> str:
        if column in self._layout.marks:
            return f"quality of {self._layout.marks[column][0]!r}"
        return why_unused(column, roles) if column in self._layout.columns else self._layout.aside[column]


def loop_of(
    layout: Layout,
    origin: Origin,
    given: Mapping[str, str | None] | None = None,
    loop: str | None = None,
    name: str | None = None,
    process: Process | None = None,
    op_span: tuple[float, float] | None = None,
    others: Others | None = None,
) -> LoopRecord:
    """One loop of a table; ``others`` are the columns to give a note on. Raises as ``read_loop`` does."""
    tag, noted = _noted(layout, given, loop)
    if noted is None:
        roles = choose_columns(layout.columns, given, loop)
    else:  # the file says which signals belong together; what the user names goes before it
        stated = {part: column for part, column in (given or {}).items() if column is not None}
        parts = {part: noted.parts.get(part, "") for part in ("sp", "pv", "op", "mv", "mode")}
        roles = named_columns(layout.columns, parts | stated, tag)
    wanted = roles.used
    log = origin.on(assemble(layout, wanted, [roles.mode] if roles.mode else []))
    notes = [f"{c!r} is read as {part}." for part, c in wanted.items() if _differs(c, part, roles.loop)]
    notes += roles.notes
    notes += (others or Others(layout)).about(roles)
    if "MODE" in log and not np.isfinite(log["MODE"]).any():
        log = _without(log, "MODE")
    log, found = _with_spans(log, op_span, own=origin.own)
    notes += found
    tag = roles.loop or tag_in(origin.stem)
    measurement = (noted.measurement if noted else "") or measurement_of(tag) or measurement_of(roles.pv)
    if process is None and noted is not None and noted.process != "unknown":
        process = noted.process
    elif process is None:
        process = process_of(measurement)
        notes.append(_about_process(measurement, tag, process))
    return LoopRecord(
        log=replace(log, notes=(*log.notes, *(note for note in notes if note not in log.notes))),
        name=name or roles.loop or origin.stem or "loop",
        sp_name="SP" if "SP" in log else None,
        pv_name="PV",
        op_name="OP",
        mv_name="MV" if "MV" in log else None,
        mode_name="MODE" if "MODE" in log else None,
        process=process,
        measurement=measurement,
    )


def loops_of(layout: Layout, origin: Origin, tags: Iterable[str], process: Process | None) -> tuple[LoopRecord, ...]:
    """The loops of these tags, none with a note on the columns of another. Raises as ``read_loops`` does."""
    tags = tuple(tags)
    others = Others(layout, tags)
    return tuple(loop_of(layout, origin, loop=tag, process=process, others=others) for tag in tags)


def with_loops(log: Log, layout: Layout) -> Log:
    """The log of a whole file with the loops that its tags tell, and the spans of their outputs.

    A file of our own notes its loops itself.
    """
    if layout.heading is not None:
        return log
    loops: dict[str, LoopSignals] = {}
    spans, units, notes = dict(log.spans), dict(log.units), list(log.notes)
    for tag in filter(None, layout.columns.loops):
        roles = choose_columns(layout.columns, None, tag)
        if roles.pv not in log or roles.op not in log:
            continue
        sp, mv, mode = (name if name in log else None for name in (roles.sp, roles.mv, roles.mode))
        measurement = measurement_of(tag) or measurement_of(roles.pv)
        loops[tag] = LoopSignals(roles.pv, roles.op, sp, mv, mode, process_of(measurement), measurement)
        if roles.op not in spans:
            span, unit, note = guess_op_span(log[roles.op][log.good(roles.op)], units.get(roles.op, ""))
            if span is not None:
                spans[roles.op] = span
                units |= {roles.op: unit} if unit else {}
                notes += [note.replace("OP", roles.op, 1)] if note else []
    return replace(log, spans=spans, units=units, notes=tuple(notes), loops=loops)


def _noted(layout: Layout, given: Mapping[str, str | None] | None, loop: str | None) -> tuple[str, LoopSignals | None]:
    """The tag and the signals of the loop asked for, where the file itself notes its loops; otherwise "" and None."""
    noted = layout.heading.loops if layout.heading is not None else {}
    if loop is not None:
        if noted and loop not in noted and not layout.columns.loops:
            raise ReadError(f"no loop {loop!r} in the file; {nearest(loop, list(noted))}")
        return loop, noted.get(loop)
    named = any((given or {}).get(part) for part in ("pv", "op"))
    if not noted or named or ("PV" in layout.columns and "OP" in layout.columns):
        return "", None
    if len(noted) > 1:
        raise ReadError(
            f"the file has {len(noted)} loops: {', '.join(map(repr, noted))}; choose one with loop= (--loop NAME)"
        )
    return next(iter(noted.items()))


def _tag_of(column: str) -> str | None:
    known = role_of(column)
    return None if known is None else plain(known[0])


def _differs(column: str, part: str, loop: str) -> bool:
    """Whether the reader had to interpret: FIC211.PV of the loop FIC211 is plain, PID1/OUT.CV is not."""
    rest = column.casefold().replace(loop.casefold(), "", 1) if loop else column.casefold()
    return rest.strip(" ._/\\:-") != part.casefold()


def _without(log: Log, name: str) -> Log:
    return replace(
        log,
        signals={key: values for key, values in log.signals.items() if key != name},
        units={key: unit for key, unit in log.units.items() if key != name},
        spans={key: span for key, span in log.spans.items() if key != name},
        quality={key: mask for key, mask in log.quality.items() if key != name},
        loops=within(log.loops, set(log.names) - {name}),
    )


def check_span(span: tuple[float, float]) -> None:
    """Raise ReadError for a span that is not finite, empty or turned round."""
    low, high = (float(limit) for limit in span)
    if not (np.isfinite(low) and np.isfinite(high) and low < high):
        raise ReadError(
            f"op_span = ({low:g}, {high:g}) is empty or turned round; give finite low < high, "
            "and turn the signal itself for an air-to-close valve"
        )


def _with_spans(log: Log, op_span: tuple[float, float] | None, *, own: bool) -> tuple[Log, list[str]]:
    """The log with the span of OP, and that of MV where it moves on the same scale."""
    notes: list[str] = []
    unit = log.units.get("OP", "")
    span: tuple[float, float] | None
    if op_span is not None:
        span = (float(op_span[0]), float(op_span[1]))
    elif own or "OP" in log.spans:
        return log, notes
    else:
        span, unit, note = guess_op_span(log["OP"][log.good("OP")], unit)
        notes += [note] if note else []
    if span is None:
        return log, notes
    units = dict(log.units) | ({"OP": unit} if unit else {})
    spans = dict(log.spans) | {"OP": span}
    if "MV" in log and "MV" not in spans and units.get("MV", unit) == unit:
        seen = log["MV"][log.good("MV")]
        margin = 0.05 * (span[1] - span[0])
        if len(seen) and span[0] - margin <= seen.min() and seen.max() <= span[1] + margin:
            spans["MV"] = span
            units |= {"MV": unit} if unit else {}
    return replace(log, units=units, spans=spans), notes


def _about_process(measurement: str, tag: str, process: str) -> str:
    if not measurement:
        return "The tag does not tell what is measured: the process is taken as unknown."
    kind = "integrating" if process == "integrating" else "self-regulating"
    return f"The process is taken as {kind}: {tag or 'the tag of PV'} is a {measurement} loop."

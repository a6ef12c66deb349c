"""Which column is what: the names that control systems and historians give to SP, PV, OP, MV and MODE."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from records.errors import ReadError

__all__ = ["Roles", "choose_columns", "is_time_name", "loop_names", "role_of"]

# Names without case, spaces and punctuation. STEM is a position by its own name; MV is ambiguous: the
# literature calls the stem position so, some products the controller output.
_ROLES = {
    "SP": (
        "sp", "spt", "setpoint", "setpt", "setp", "setpointvalue", "sv", "setvalue", "wsp", "spvalue",
        "reference", "ref", "r", "target", "spv", "spwrk", "currentsp", "spout", "workingsetpoint",
    ),
    "PV": (
        "pv", "processvalue", "processvariable", "processvar", "procval", "measurement", "meas", "measuredvalue",
        "measured", "y", "pvvalue", "pvin", "actualvalue", "pvcurrent", "controlledvariable",
    ),
    "OP": (
        "op", "out", "output", "co", "cout", "controlleroutput", "controloutput", "ctrlout", "controllerout",
        "opvalue", "u", "outvalue", "controlsignal", "outputvalue", "lmn", "cvout", "demand", "command", "cmd",
        "valvecommand", "controlout", "valvedemand", "outputpercent",
    ),
    "MV": ("mv", "manipulatedvariable", "manipulatedvalue", "manipvar"),
    "STEM": (
        "stem", "stemposition", "valveposition", "position", "pos", "travel", "valvetravel", "vp", "zt",
        "feedback", "positionfeedback", "actualposition", "valvepos", "stempos", "lift", "valvefeedback",
        "positionerfeedback", "mvposition",
    ),
    "MODE": ("mode", "md", "actmode", "modeactual", "modeact", "actualmode", "controllermode", "loopmode",
             "controlmode", "modeactualmode"),
}  # fmt: skip
_ROLE_BY_NAME = {name: role for role, names in _ROLES.items() for name in names}
_LETTERS_ALONE = {"r", "y", "u", "ref", "pos", "target", "command", "demand", "md", "measured", "position"}
_NOISE = {"cv", "val", "value", "fcv", "act", "actual", "pida", "pid", "pid1a", "st", "read", "current", "last"}
_TIMES = {
    "time", "timestamp", "datetime", "timestamps", "t", "ts", "dateandtime", "sampletime", "times", "utc",
    "localtime", "timeutc", "sourcetime", "sourcetimestamp", "servertime", "serverts", "datum", "clock", "dt",
    "elapsedtime", "seconds", "timelocal", "tid", "zeit", "eventtime", "timeofday", "tstamp", "timeseconds",
}  # fmt: skip
_SUFFIX = re.compile(r"^(?P<loop>.*\d[A-Za-z]?)(?P<role>pv|sp|op|co|mv|out|mode)$", re.IGNORECASE)


@dataclass(frozen=True)
class Roles:
    """The columns of one loop and what was assumed in choosing them."""

    pv: str
    op: str
    sp: str | None = None
    mv: str | None = None
    mode: str | None = None
    loop: str = ""
    notes: tuple[str, ...] = ()


def is_time_name(name: str) -> bool:
    """Whether a column of this name holds the time.

    >>> is_time_name("Time Stamp"), is_time_name("PV")
    (True, False)
    """
    return _plain(name) in _TIMES


def role_of(column: str) -> tuple[str, str] | None:
    """Loop and role ("SP", "PV", "OP", "MV", "STEM", "MODE") that a column name tells, None if none.

    >>> [role_of(name) for name in ("FIC211.PIDA.OP", "PID1/OUT.CV", "FIC-211 Sp", "TIC_1203A_PV")]
    [('FIC211', 'OP'), ('PID1', 'OP'), ('FIC-211', 'SP'), ('TIC_1203A', 'PV')]
    >>> role_of("Controller Output"), role_of("PV FIC211"), role_of("flow_t_h")
    (('', 'OP'), ('FIC211', 'PV'), None)
    """
    pieces = [(found.start(), found.group()) for found in re.finditer(r"[^\s._/\\:|\-]+", column)]
    words = [word.casefold() for _, word in pieces]
    end = len(words)
    while end:
        for first in range(max(0, end - 3), end):
            role = _role("".join(words[first:end]), alone=first == 0)
            if role:
                if role == "MODE" and words[-1] in {"target", "normal", "permitted"}:
                    return None
                return _loop_part(column[: pieces[first][0]]), role
        if words[end - 1] not in _NOISE or end == 1:
            break
        end -= 1
    if len(words) > 1:  # the role in front: "PV FIC211", "OP_FIC211"
        role = _role(words[0], alone=False)
        if role and any(char.isdigit() for char in column[pieces[1][0] :]):
            return _loop_part(column[pieces[1][0] :]), role
    run_on = _SUFFIX.match(column.strip())
    if run_on:
        return _loop_part(run_on["loop"]), _ROLE_BY_NAME[run_on["role"].casefold()]
    return None


def loop_names(columns: Iterable[str]) -> tuple[str, ...]:
    """Names of the loops that have both PV and an output among `columns`, in order.

    >>> loop_names(["time", "FIC1.PV", "FIC1.OP", "TI7.PV", "LIC2.OP", "LIC2.PV"])
    ('FIC1', 'LIC2')
    """
    return tuple(shown for shown, parts in _grouped(columns).values() if _is_loop(parts))


def choose_columns(
    columns: Iterable[str], given: Mapping[str, str | None] | None = None, loop: str | None = None
) -> Roles:
    """The columns of one loop.

    Parameters
    ----------
    columns : iterable of str
        Columns of the file other than time.
    given : mapping
        Columns named by the user for "sp", "pv", "op", "mv", "mode"; None is guessed, "" is left out.
    loop : str, optional
        Which loop, where there are several.

    Raises ReadError if a named column is not there, PV or OP cannot be found, or several loops fit.

    >>> choose_columns(["FIC211.PV", "FIC211.MV", "FIC211.SP"]).notes
    ("'FIC211.MV' is taken as OP, for there is no other controller output; if it is the stem position, name OP.",)
    """
    names = list(columns)
    named = {part: column for part, column in (given or {}).items() if column is not None}
    for part, column in named.items():
        if column and column not in names:
            raise ReadError(f"no column {column!r} for {part.upper()}; the columns are {_listed(names)}")
    free = [name for name in names if name not in named.values()]
    shown, parts, notes = _one_loop(free, named, loop)
    picked: dict[str, str | None] = {role.casefold(): column for role, column in parts.items()}
    if "op" not in picked and "op" not in named and picked.get("mv"):
        picked["op"] = picked.pop("mv")
        notes.append(
            f"{picked['op']!r} is taken as OP, for there is no other controller output; "
            "if it is the stem position, name OP."
        )
    stem = picked.pop("stem", None)
    if stem and "mv" not in named:
        picked["mv"] = stem
    picked.update({part: column or None for part, column in named.items()})

    def required(part: str) -> str:
        chosen = picked.get(part)
        if not chosen:
            raise ReadError(
                f"no column is plainly the {part.upper()}; the columns are {_listed(names)}: "
                f"name it with {part}= (--{part} NAME)"
            )
        return chosen

    pv, op = required("pv"), required("op")
    used = [column for column in picked.values() if column]
    if len(set(used)) < len(used):
        twice = next(column for column in used if used.count(column) > 1)
        raise ReadError(f"column {twice!r} is named for two signals; name one column for each")
    if picked.get("mv") and "mv" not in named and stem is None:
        notes.append(f"{picked['mv']!r} is taken as the stem position, for {op!r} is the controller output.")
    return Roles(
        pv=pv,
        op=op,
        sp=picked.get("sp"),
        mv=picked.get("mv"),
        mode=picked.get("mode"),
        loop=shown,
        notes=tuple(notes),
    )


def _one_loop(free: list[str], named: Mapping[str, str], loop: str | None) -> tuple[str, dict[str, str], list[str]]:
    groups = _grouped(free)
    if loop is not None:
        for shown, parts in groups.values():
            if _plain(shown) == _plain(loop):
                return shown, parts, []
        found = loop_names(free)
        raise ReadError(f"no loop {loop!r}; the file has {_listed(found) if found else 'no named loop'}")
    for part in ("pv", "op"):  # a column the user named tells the loop
        told = role_of(named[part]) if named.get(part) else None
        if told and _plain(told[0]) in groups:
            shown, parts = groups[_plain(told[0])]
            return shown, parts, []
    if named.get("pv") and named.get("op"):
        return "", groups.get("", ("", {}))[1], []
    whole = [group for group in groups.values() if _is_loop(group[1])]
    if len(whole) > 1:
        raise ReadError(
            f"the file has {len(whole)} loops: {_listed([shown for shown, _ in whole])}; "
            "choose one with loop= (--loop NAME)"
        )
    if whole:
        return whole[0][0], whole[0][1], []
    # No tag has both: a transmitter and a controller of different names are a loop if they are the only ones.
    merged: dict[str, str] = {}
    for _, parts in groups.values():
        for role, column in parts.items():
            if role in merged:
                raise ReadError(
                    f"several columns may be the {role} ({merged[role]!r}, {column!r}) and no tag has both PV "
                    f"and OP; the columns are {_listed(free)}: name them with pv= and op= (--pv NAME --op NAME)"
                )
            merged[role] = column
    several = sum(bool(parts) for _, parts in groups.values()) > 1
    notes = [f"Columns of different tags are taken as one loop: {_listed(merged.values())}."] if several else []
    shown = next((name for name, parts in groups.values() if "OP" in parts and name), "")
    return shown, merged, notes


def _grouped(columns: Iterable[str]) -> dict[str, tuple[str, dict[str, str]]]:
    """Columns by loop: plain name -> (name as written, role -> column)."""
    groups: dict[str, tuple[str, dict[str, str]]] = {}
    for column in columns:
        told = role_of(column)
        if told is None:
            continue
        shown, role = told
        _, parts = groups.setdefault(_plain(shown), (shown, {}))
        if role in parts:
            # "OP" beside "OUT" in one loop: the first in the rule table is the usual name.
            order = _ROLES[role]
            rank = [order.index(name) if name in order else len(order) for name in _tails(parts[role], column)]
            if rank[0] <= rank[1]:
                continue
        parts[role] = column
    return groups


def _tails(*columns: str) -> list[str]:
    return [re.split(r"[\s._/\\:|\-]+", column.casefold())[-1] for column in columns]


def _is_loop(parts: Mapping[str, str]) -> bool:
    return "PV" in parts and ("OP" in parts or "MV" in parts)


def _role(word: str, *, alone: bool) -> str | None:
    if word in _LETTERS_ALONE and not alone:
        return None
    return _ROLE_BY_NAME.get(word)


def _loop_part(text: str) -> str:
    """The loop in what is left of a name: without punctuation at the ends and without noise words."""
    text = text.strip(" ._/\\:|-'\"")
    pieces = re.split(r"[._/\\:|\s]+", text)
    while len(pieces) > 1 and pieces[-1].casefold() in _NOISE:
        text = text[: -len(pieces.pop())].rstrip(" ._/\\:|-")
    return text


def _plain(name: str) -> str:
    return re.sub(r"[^a-z0-9]", "", name.casefold())


def _listed(names: Iterable[str], most: int = 20) -> str:
    shown = [repr(name) for name in names]
    more = len(shown) - most
    return ", ".join(shown[:most]) + (f" and {more} more" if more > 0 else "")

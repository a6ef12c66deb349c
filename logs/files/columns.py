"""Which columns make up one loop, and why the others do not."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from logs.errors import ReadError
from logs.files.names import ROLES, numbers_in, plain, role_of, same_numbers

__all__ = ["Roles", "choose_columns", "columns_of_loops", "loop_names"]

# Valves that are open or shut by their tag letters: no controller moves them, whatever their number.
_SHUT_OFF = re.compile(r"(?<![A-Za-z])(X[A-Z]?|HV|MOV|BDV|E?SDV)(?=[-_ ]?\d)", re.IGNORECASE)


@dataclass(frozen=True)
class Roles:
    """The columns of one loop, what was assumed in choosing them, and the reason why others are not used."""

    pv: str
    op: str
    sp: str | None = None
    mv: str | None = None
    mode: str | None = None
    loop: str = ""
    notes: tuple[str, ...] = ()
    unused: tuple[tuple[str, str], ...] = ()


def loop_names(columns: Iterable[str]) -> tuple[str, ...]:
    """Names of the loops that have both PV and an output among ``columns``, in order.

    >>> loop_names(["time", "FIC1.PV", "FIC1.OP", "TI7.PV", "LIC2.OP", "LIC2.PV"])
    ('FIC1', 'LIC2')
    """
    return tuple(shown for shown, parts in _grouped(columns).values() if _is_loop(parts))


def columns_of_loops(columns: Iterable[str]) -> dict[str, tuple[str, ...]]:
    """The loops among ``columns``, each with all columns that bear its tag or, for a stem position, its number.

    >>> columns_of_loops(["time", "FIC1.PV", "FIC1.OP", "ZT1.PV", "TI7.PV"])
    {'FIC1': ('FIC1.PV', 'FIC1.OP', 'ZT1.PV')}
    """
    groups = _grouped(columns)
    stems: dict[tuple[str, ...], list[str]] = {}
    for shown, parts in groups.values():
        if "STEM" in parts and not _is_loop(parts):
            stems.setdefault(numbers_in(shown), []).append(parts["STEM"])
    return {
        shown: tuple(dict.fromkeys([*parts.values(), *stems.get(numbers_in(shown), ())]))
        for shown, parts in groups.values()
        if _is_loop(parts)
    }


def choose_columns(
    columns: Iterable[str], given: Mapping[str, str | None] | None = None, loop: str | None = None
) -> Roles:
    """The columns of one loop.

    Parameters: ``columns`` (iterable of str) Columns of the file other than time; ``given`` (mapping) Columns named by
    the user for "sp", "pv", "op", "mv", "mode"; None is guessed, "" is left out; ``loop`` (str, optional) Which loop,
    where there are several.

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
    if not stem and "mv" not in picked and "mv" not in named:
        rest = [name for name in free if name not in picked.values()]
        stem = _stem_elsewhere(rest, (shown, picked.get("op"), named.get("op"), named.get("pv")), notes)
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
    if picked.get("mv") and "mv" not in named and not stem:
        notes.append(f"{picked['mv']!r} is taken as the stem position, for {op!r} is the controller output.")
    return Roles(
        pv=pv,
        op=op,
        sp=picked.get("sp"),
        mv=picked.get("mv"),
        mode=picked.get("mode"),
        loop=shown,
        notes=tuple(notes),
        unused=tuple((name, _why_not(name, shown, picked, named)) for name in names if name not in used),
    )


def _why_not(column: str, loop: str, picked: Mapping[str, str | None], named: Mapping[str, str]) -> str:
    told = role_of(column)
    if told is None:
        return "its name tells no part of the loop"
    tag, role = told
    part = "mv" if role == "STEM" else role.casefold()
    if named.get(part) == "":
        return "left out as told"
    what = "stem position" if role == "STEM" else role
    if tag and plain(tag) != plain(loop):
        remedy = "; name it with mv= (--mv) if it is this valve" if role == "STEM" and not picked.get("mv") else ""
        return f"{what} of {tag}{remedy}"
    return f"{part.upper()} is {picked[part]!r}" if picked.get(part) else f"{what} of no loop of the file"


def _stem_elsewhere(free: Iterable[str], hints: Iterable[str | None], notes: list[str]) -> str | None:
    """The stem position under a tag of its own: ZT211 or FV211.POS beside FIC211.

    Taken if it has the loop's number, or if there is only one and it has no number. Without a number in the loop's
    own names, the only one in the file is taken.
    """
    found: dict[str, tuple[str, ...]] = {}
    for _, (shown, parts) in _grouped(free).items():
        stem = parts.get("STEM") or (parts.get("MV") if not {"PV", "OP", "SP"} & set(parts) else None)
        if stem and not _SHUT_OFF.search(shown):
            found[stem] = numbers_in(shown)
    wanted = [numbers_in(hint) for hint in hints if hint and numbers_in(hint)]
    fitting = [stem for stem, number in found.items() if any(same_numbers(number, other) for other in wanted)]
    why = "its number is the loop's"
    if not fitting and (not wanted or not any(found.values())):
        fitting, why = list(found), "it is the only one in the file"
    if len(fitting) != 1:
        return None
    notes.append(f"{fitting[0]!r} is taken as the stem position: {why}.")
    return fitting[0]


def _one_loop(free: list[str], named: Mapping[str, str], loop: str | None) -> tuple[str, dict[str, str], list[str]]:
    groups = _grouped(free)
    if loop is not None:
        for shown, parts in groups.values():
            if plain(shown) == plain(loop):
                return shown, parts, []
        found = loop_names(free)
        raise ReadError(f"no loop {loop!r}; the file has {_listed(found) if found else 'no named loop'}")
    for part in ("pv", "op"):  # a column the user named tells the loop
        told = role_of(named[part]) if named.get(part) else None
        if told and plain(told[0]) in groups:
            shown, parts = groups[plain(told[0])]
            return shown, parts, []
    if named.get("pv") and named.get("op"):
        return "", groups.get("", ("", {}))[1], []
    whole = [group for group in groups.values() if _is_loop(group[1])]
    if len(whole) > 1:
        raise ReadError(
            f"the file has {len(whole)} loops: {_listed([shown for shown, _ in whole])}; "
            "choose one with loop= (--loop NAME)"
        )
    if whole:  # a column without a tag can only be the loop's
        return whole[0][0], {**groups.get("", ("", {}))[1], **whole[0][1]}, []
    # No tag has both: a transmitter and a controller of different names are a loop if they are the only ones.
    merged: dict[str, str] = {}
    for _, parts in groups.values():
        for role, column in parts.items():
            if role == "STEM":
                continue  # ``_stem_elsewhere`` knows which of several belongs here
            if role in merged:
                raise ReadError(
                    f"several columns may be the {role} ({merged[role]!r}, {column!r}) and no tag has both PV "
                    f"and OP; the columns are {_listed(free)}: name them with pv= and op= (--pv NAME --op NAME)"
                )
            merged[role] = column
    several = sum(bool(parts.keys() - {"STEM"}) for _, parts in groups.values()) > 1
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
        _, parts = groups.setdefault(plain(shown), (shown, {}))
        if role in parts:
            # "OP" beside "OUT" in one loop: the first in the rule table is the usual name.
            order = ROLES[role]
            rank = [order.index(name) if name in order else len(order) for name in _tails(parts[role], column)]
            if rank[0] <= rank[1]:
                continue
        parts[role] = column
    return groups


def _tails(*columns: str) -> list[str]:
    return [re.split(r"[\s._/\\:|\-]+", column.casefold())[-1] for column in columns]


def _is_loop(parts: Mapping[str, str]) -> bool:
    return "PV" in parts and ("OP" in parts or "MV" in parts)


def _listed(names: Iterable[str], most: int = 20) -> str:
    shown = [repr(name) for name in names]
    more = len(shown) - most
    return ", ".join(shown[:most]) + (f" and {more} more" if more > 0 else "")

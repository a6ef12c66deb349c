"""Which columns make up one loop, and why the others do not."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace

from stickslip.logs.errors import ReadError
from stickslip.logs.files.grouping import Columns
from stickslip.logs.files.names import plain, role_of

__all__ = ["Roles", "choose_columns", "named_columns", "why_unused"]


@dataclass(frozen=True)
class Roles:
    """The columns of one loop, what was assumed in choosing them, and the parts that the caller left out."""

    pv: str
    op: str
    sp: str | None = None
    mv: str | None = None
    mode: str | None = None
    loop: str = ""
    notes: tuple[str, ...] = ()
    left_out: frozenset[str] = frozenset()

    @property
    def used(self) -> dict[str, str]:
        """Part in the loop ("SP", "PV", "OP", "MV", "MODE") -> its column."""
        columns = {"SP": self.sp, "PV": self.pv, "OP": self.op, "MV": self.mv, "MODE": self.mode}
        return {part: column for part, column in columns.items() if column is not None}


def choose_columns(columns: Columns, given: Mapping[str, str | None] | None = None, loop: str | None = None) -> Roles:
    """The columns of one loop.

    Parameters: ``columns`` (Columns) Columns of the file other than time; ``given`` (mapping) Columns named by
    the user for "sp", "pv", "op", "mv", "mode"; None is guessed, "" is left out; ``loop`` (str, optional) Which loop,
    where there are several.

    Raises ReadError if a named column is not there, PV or OP cannot be found, or several loops fit.

    >>> choose_columns(Columns(["FIC211.PV", "FIC211.MV", "FIC211.SP"])).notes
    ("'FIC211.MV' is taken as OP, for there is no other controller output; if it is the stem position, name OP.",)
    """
    named = {part: column for part, column in (given or {}).items() if column is not None}
    _check_named(columns, named)
    free = columns.without({column for column in named.values() if column})
    shown, parts, notes = _one_loop(free, named, loop)
    picked: dict[str, str] = {role.casefold(): column for role, column in parts.items()}
    if "op" not in picked and "op" not in named and picked.get("mv"):
        picked["op"] = picked.pop("mv")
        notes.append(
            f"{picked['op']!r} is taken as OP, for there is no other controller output; "
            "if it is the stem position, name OP."
        )
    stem = picked.pop("stem", None)
    if not stem and "mv" not in picked and "mv" not in named:
        hints = (shown, picked.get("op"), named.get("op"), named.get("pv"))
        found = free.stem_for(filter(None, hints), picked.values())
        if found is not None:
            stem, why = found
            notes.append(f"{stem!r} is taken as the stem position: {why}.")
    if stem and "mv" not in named:
        picked["mv"] = stem
    roles = _checked(columns, picked | named, shown)
    if roles.mv and "mv" not in named and not stem:
        notes.append(f"{roles.mv!r} is taken as the stem position, for {roles.op!r} is the controller output.")
    return replace(roles, notes=tuple(notes))


def named_columns(columns: Columns, named: Mapping[str, str], loop: str) -> Roles:
    """The columns of one loop as the caller states them, "" for a part that is not there: nothing is guessed.

    Raises ReadError as ``choose_columns`` does.
    """
    _check_named(columns, named)
    return _checked(columns, named, loop)


def _check_named(columns: Columns, named: Mapping[str, str]) -> None:
    for part, column in named.items():
        if column and column not in columns:
            raise ReadError(f"no column {column!r} for {part.upper()}; the columns are {_listed(columns.names)}")


def _checked(columns: Columns, picked: Mapping[str, str], loop: str) -> Roles:
    """The roles, if PV and OP are there and no column has two."""

    def required(part: str) -> str:
        chosen = picked.get(part)
        if not chosen:
            raise ReadError(
                f"no column is plainly the {part.upper()}; the columns are {_listed(columns.names)}: "
                f"name it with {part}= (--{part} NAME)"
            )
        return chosen

    pv, op = required("pv"), required("op")
    used = [column for column in picked.values() if column]
    if len(set(used)) < len(used):
        twice = next(column for column in used if used.count(column) > 1)
        raise ReadError(f"column {twice!r} is named for two signals; name one column for each")
    sp, mv, mode = (picked.get(part) or None for part in ("sp", "mv", "mode"))
    left_out = frozenset(part for part, column in picked.items() if not column)
    return Roles(pv, op, sp, mv, mode, loop, left_out=left_out)


def why_unused(column: str, roles: Roles) -> str:
    """Why a column of the file plays no part in the loop."""
    known = role_of(column)
    if known is None:
        return "no part of the loop by name"
    tag, role = known
    part = "MV" if role == "STEM" else role
    if part.casefold() in roles.left_out:
        return "left out as asked"
    what = "stem position" if role == "STEM" else role
    if tag and plain(tag) != plain(roles.loop):
        remedy = "; name it with mv= (--mv) if it is this valve" if role == "STEM" and not roles.mv else ""
        return f"{what} of {tag}{remedy}"
    return f"{part} is {roles.used[part]!r}" if part in roles.used else f"{what} of no loop of the file"


def _one_loop(free: Columns, named: Mapping[str, str], loop: str | None) -> tuple[str, dict[str, str], list[str]]:
    groups = free.groups
    untagged = groups[""].parts if "" in groups else {}
    if loop is not None:
        if plain(loop) in groups:
            group = groups[plain(loop)]
            return group.tag, dict(group.parts), []
        raise ReadError(f"no loop {loop!r}; the file has {_listed(free.loops) if free.loops else 'no named loop'}")
    for part in ("pv", "op"):  # a column the user named tells the loop
        known = role_of(named[part]) if named.get(part) else None
        if known and plain(known[0]) in groups:
            group = groups[plain(known[0])]
            return group.tag, dict(group.parts), []
    if named.get("pv") and named.get("op"):
        return "", dict(untagged), []
    whole = [group for group in groups.values() if group.is_loop]
    if len(whole) > 1:
        raise ReadError(f"the file has {len(whole)} loops: {_listed(free.loops)}; choose one with loop= (--loop NAME)")
    if whole:  # a column without a tag can only be the loop's
        return whole[0].tag, {**untagged, **whole[0].parts}, []
    # No tag has both: a transmitter and a controller of different names are a loop if they are the only ones.
    merged: dict[str, str] = {}
    for group in groups.values():
        for role, column in group.parts.items():
            if role == "STEM":
                continue  # ``Columns.stem_for`` knows which of several belongs here
            if role in merged:
                raise ReadError(
                    f"several columns may be the {role} ({merged[role]!r}, {column!r}) and no tag has both PV "
                    f"and OP; the columns are {_listed(free.names)}: name them with pv= and op= (--pv NAME --op NAME)"
                )
            merged[role] = column
    several = sum(bool(group.parts.keys() - {"STEM"}) for group in groups.values()) > 1
    notes = [f"Columns of different tags are taken as one loop: {_listed(merged.values())}."] if several else []
    shown = next((group.tag for group in groups.values() if "OP" in group.parts and group.tag), "")
    return shown, merged, notes


def _listed(names: Iterable[str], most: int = 20) -> str:
    shown = [repr(name) for name in names]
    more = len(shown) - most
    return ", ".join(shown[:most]) + (f" and {more} more" if more > 0 else "")

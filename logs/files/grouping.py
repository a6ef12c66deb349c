"""The columns of a file by the loop that their names tell: worked out once for a file, however many loops it has."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property

from stickslip.logs.files.names import ROLES, numbers_in, plain, role_of, same_numbers

__all__ = ["Columns", "Group", "columns_of_loops", "loop_names"]

# Valves that are open or shut by their tag letters: no controller moves them, whatever their number.
_SHUT_OFF = re.compile(r"(?<![A-Za-z])(X[A-Z]?|HV|MOV|BDV|E?SDV)(?=[-_ ]?\d)", re.IGNORECASE)


@dataclass(frozen=True)
class Group:
    """The columns of one tag: the tag as first written, the column that plays each part, all of them in order."""

    tag: str
    parts: Mapping[str, str]
    all: tuple[str, ...]

    @property
    def is_loop(self) -> bool:
        """Whether it has both PV and an output."""
        return "PV" in self.parts and ("OP" in self.parts or "MV" in self.parts)

    @property
    def stem(self) -> str | None:
        """The column that may be the stem position of a loop of another tag."""
        alone = self.parts.get("MV") if not {"PV", "OP", "SP"} & set(self.parts) else None
        stem = self.parts.get("STEM") or alone
        return stem if stem and not _SHUT_OFF.search(self.tag) else None


class Columns:
    """The names of columns, grouped by loop when first asked.

    >>> columns = Columns(["FIC1.PV", "FIC1.OP", "ZT1"])
    >>> "ZT1" in columns, [group.tag for group in columns.groups.values() if group.is_loop]
    (True, ['FIC1'])
    """

    def __init__(self, names: Iterable[str]) -> None:
        self.names = tuple(names)

    @cached_property
    def _known(self) -> frozenset[str]:
        return frozenset(self.names)

    def __contains__(self, name: object) -> bool:
        return name in self._known

    def without(self, taken: Collection[str]) -> Columns:
        """The other columns."""
        return Columns(name for name in self.names if name not in taken) if taken else self

    @cached_property
    def groups(self) -> dict[str, Group]:
        """The columns whose names tell a part of a loop: plain tag -> its columns."""
        shown: dict[str, str] = {}
        held: dict[str, list[tuple[str, str]]] = {}
        for column in self.names:
            known = role_of(column)
            if known is not None:
                tag, role = known
                shown.setdefault(plain(tag), tag)
                held.setdefault(plain(tag), []).append((role, column))
        return {
            key: Group(shown[key], _parts(columns), tuple(column for _, column in columns))
            for key, columns in held.items()
        }

    @cached_property
    def loops(self) -> tuple[str, ...]:
        """Tags of the loops that have both PV and an output, in order."""
        return tuple(group.tag for group in self.groups.values() if group.is_loop)

    @cached_property
    def _stems(self) -> dict[str, tuple[str, tuple[str, ...]]]:
        """Plain tag -> a stem position under it, and the numbers of the tag."""
        return {key: (group.stem, numbers_in(group.tag)) for key, group in self.groups.items() if group.stem}

    @cached_property
    def _by_number(self) -> dict[str, list[str]]:
        """The last number of a tag -> the plain tags of the stem positions that have it."""
        found: dict[str, list[str]] = {}
        for key, (_, numbers) in self._stems.items():
            if numbers:
                found.setdefault(numbers[-1], []).append(key)
        return found

    @cached_property
    def _numbered(self) -> int:
        return sum(bool(numbers) for _, numbers in self._stems.values())

    def stem_for(self, hints: Iterable[str], picked: Collection[str]) -> tuple[str, str] | None:
        """The stem position for a loop of the names ``hints`` under a tag of its own, and why it is taken.

        That is ZT211 or FV211.POS beside FIC211. Taken if it has the loop's number, or if there is only one and it has
        no number. Without a number in the loop's own names, the only one in the file is taken. Columns ``picked`` play
        another part already.
        """
        # Only the groups that have lost a column to the loop are looked at again.
        touched = {plain(known[0]) for known in map(role_of, picked) if known is not None} & self.groups.keys()
        rest = type(self)(c for key in touched for c in self.groups[key].all if c not in picked)
        wanted = [numbers for numbers in map(numbers_in, hints) if numbers]
        near = {
            key: self._stems[key]
            for numbers in wanted
            for key in self._by_number.get(numbers[-1], ())
            if key not in touched
        }
        near |= rest._stems
        fitting = [stem for stem, own in near.values() if any(same_numbers(own, other) for other in wanted)]
        why = "its number is the loop's"
        lost = [self._stems[key] for key in touched if key in self._stems]
        numbered = self._numbered - sum(bool(numbers) for _, numbers in lost) + rest._numbered
        if not fitting and not (wanted and numbered) and len(self._stems) - len(lost) + len(rest._stems) == 1:
            others = (stem for key, (stem, _) in self._stems.items() if key not in touched)
            fitting, why = [*others, *(stem for stem, _ in rest._stems.values())], "it is the only one in the file"
        return (fitting[0], why) if len(fitting) == 1 else None


def loop_names(columns: Iterable[str]) -> tuple[str, ...]:
    """Names of the loops that have both PV and an output among ``columns``, in order.

    >>> loop_names(["time", "FIC1.PV", "FIC1.OP", "TI7.PV", "LIC2.OP", "LIC2.PV"])
    ('FIC1', 'LIC2')
    """
    return Columns(columns).loops


def columns_of_loops(columns: Iterable[str]) -> dict[str, tuple[str, ...]]:
    """The loops among ``columns``, each with all columns that bear its tag or, for a stem position, its number.

    >>> columns_of_loops(["time", "FIC1.PV", "FIC1.OP", "ZT1.PV", "TI7.PV"])
    {'FIC1': ('FIC1.PV', 'FIC1.OP', 'ZT1.PV')}
    """
    groups = Columns(columns).groups.values()
    stems: dict[tuple[str, ...], list[str]] = {}
    for group in groups:
        if "STEM" in group.parts and not group.is_loop:
            stems.setdefault(numbers_in(group.tag), []).append(group.parts["STEM"])
    return {
        group.tag: tuple(dict.fromkeys([*group.parts.values(), *stems.get(numbers_in(group.tag), ())]))
        for group in groups
        if group.is_loop
    }


def _parts(columns: Iterable[tuple[str, str]]) -> dict[str, str]:
    """The column that plays each part; of "OP" beside "OUT", the one that stands first in the table of roles."""
    parts: dict[str, str] = {}
    for role, column in columns:
        order = ROLES[role]
        if role in parts:
            rank = [order.index(name) if name in order else len(order) for name in _tails(parts[role], column)]
            if rank[0] <= rank[1]:
                continue
        parts[role] = column
    return parts


def _tails(*columns: str) -> list[str]:
    return [re.split(r"[\s._/\\:|\-]+", column.casefold())[-1] for column in columns]

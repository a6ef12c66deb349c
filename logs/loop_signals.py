"""Which signals of a log make up one control loop: kept with the log, so that a file says it too."""

from __future__ import annotations

from collections.abc import Callable, Container, Iterator, Mapping
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any, Self, get_args

from stickslip.logs.errors import LogError
from stickslip.logs.tags import Process

__all__ = ["LoopSignals", "LoopsLater", "renamed", "within"]

PARTS = ("sp", "pv", "op", "mv", "mode")


@dataclass(frozen=True)
class LoopSignals:
    """The parts of one loop by the names of their signals.

    Parameters: ``pv``, ``op`` (str) Signals of the measurement and of the controller output; ``sp``, ``mv``, ``mode``
    (str, optional) Set point, stem position and controller mode, None where they are not logged; ``process``
    ({"self_regulating", "integrating", "unknown"}); ``measurement`` (str) "flow", "level", "pressure", ... or "";
    ``master_of`` (str) tag of the loop whose set point OP is, "" where it is none.

    Raises ``LogError`` without PV or OP, or for another ``process``.

    >>> LoopSignals(pv="p_1", op="OP_VPCS1", mv="MV_VPCS1").to_dict()
    {'pv': 'p_1', 'op': 'OP_VPCS1', 'mv': 'MV_VPCS1'}
    """

    pv: str
    op: str
    sp: str | None = None
    mv: str | None = None
    mode: str | None = None
    process: Process = "unknown"
    measurement: str = ""
    master_of: str = ""

    def __post_init__(self) -> None:
        for part in ("pv", "op"):
            if not getattr(self, part):
                raise LogError(f"{part} = {getattr(self, part)!r}; a loop needs PV and OP, name the signals of both")
        if self.process not in get_args(Process):
            raise LogError(f"process = {self.process!r}; give one of {', '.join(get_args(Process))}")

    @property
    def parts(self) -> dict[str, str]:
        """Part of the loop ("sp", "pv", "op", "mv", "mode") -> signal, for those that are logged."""
        return {part: getattr(self, part) for part in PARTS if getattr(self, part) is not None}

    def with_parts(self, parts: Mapping[str, str | None]) -> Self:
        """The loop with some of its parts changed, e.g. {"mv": None}.

        Raises ``LogError`` as the class does.
        """
        changed: dict[str, Any] = dict(parts)
        return replace(self, **changed)

    def to_dict(self) -> dict[str, str]:
        """Plain values for JSON, without what is not known."""
        return {
            f.name: getattr(self, f.name) for f in fields(self) if getattr(self, f.name) not in (None, "", "unknown")
        }

    @classmethod
    def from_dict(cls, values: Mapping[str, Any]) -> Self:
        """The loop of ``to_dict``; other keys are passed over.

        Raises ``LogError`` as the class does.
        """
        known = {f.name for f in fields(cls)}
        kept: dict[str, Any] = {"pv": "", "op": ""} | {k: str(v) for k, v in values.items() if k in known}
        return cls(**kept)


def within(loops: Mapping[str, LoopSignals], signals: Container[str]) -> dict[str, LoopSignals]:
    """The loops whose PV and OP are among the signals; other parts that are not are left out.

    >>> within({"PCS11": LoopSignals("p", "u", sp="r")}, {"p", "u"})
    {'PCS11': LoopSignals(pv='p', op='u', sp=None, mv=None, mode=None, process='unknown', measurement='', master_of='')}
    """
    return {
        tag: loop.with_parts(gone) if gone else loop
        for tag, loop in loops.items()
        for gone in [{part: None for part, signal in loop.parts.items() if signal not in signals}]
        if loop.pv in signals and loop.op in signals
    }


def renamed(loops: Mapping[str, LoopSignals], names: Mapping[str, str]) -> dict[str, LoopSignals]:
    """The loops with their signals renamed old -> new."""
    return {
        tag: loop.with_parts({part: names.get(signal, signal) for part, signal in loop.parts.items()})
        for tag, loop in loops.items()
    }


class LoopsLater(Mapping[str, LoopSignals]):
    """Loops worked out when somebody first asks for one, by a function without arguments.

    >>> LoopsLater(lambda: {"FIC1": LoopSignals("p", "u")})["FIC1"].op
    'u'
    """

    def __init__(self, make: Callable[[], Mapping[str, LoopSignals]]) -> None:
        self._make = make

    @cached_property
    def _made(self) -> Mapping[str, LoopSignals]:
        return self._make()

    def __getitem__(self, tag: str) -> LoopSignals:
        return self._made[tag]

    def __iter__(self) -> Iterator[str]:
        return iter(self._made)

    def __len__(self) -> int:
        return len(self._made)

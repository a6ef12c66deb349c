"""Signals over time as whoever writes or shows them reads them: what ``Log`` has, without its methods."""

from __future__ import annotations

from collections.abc import Mapping
from datetime import datetime
from typing import Protocol

from stickslip.logs.arrays import Mask, Values
from stickslip.logs.loop_signals import LoopSignals

__all__ = ["Signals"]


class Signals(Protocol):
    """Signals on one time axis; ``Log`` says what each part means."""

    @property
    def t(self) -> Values:
        """Times [s], shape (n,)."""

    @property
    def signals(self) -> Mapping[str, Values]:
        """Values by name, each (n,), in the signal's own unit."""

    @property
    def units(self) -> Mapping[str, str]:
        """Units by name."""

    @property
    def spans(self) -> Mapping[str, tuple[float, float]]:
        """Instrument spans by name, in the signal's unit."""

    @property
    def loops(self) -> Mapping[str, LoopSignals]:
        """Which signals make up which control loop, by tag."""

    @property
    def quality(self) -> Mapping[str, Mask]:
        """Good samples by name, each (n,)."""

    @property
    def origin(self) -> str:
        """Where the signals come from."""

    @property
    def start(self) -> datetime | None:
        """Wall-clock time of t = 0."""

    @property
    def notes(self) -> tuple[str, ...]:
        """Assumptions and repairs of the reader."""

    @property
    def names(self) -> tuple[str, ...]:
        """Names in their order."""

    @property
    def duration(self) -> float:
        """From the first to the last sample [s]."""

    def __len__(self) -> int: ...

    def __contains__(self, name: object) -> bool: ...

    def __getitem__(self, name: str) -> Values: ...

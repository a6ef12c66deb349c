"""Signals without a period: constant, step and ramp.

    constant   y = value
    step       y = before for t < at, else after
    ramp       y = before + slope (clip(t, start, end) - start)

out  the signal named first, in the unit given.  The instants of steps and kinks are announced to the engine, so
that no integration step crosses them.  Valid for any finite numbers.
They are also what a plant ends at, its boundary conditions: a pressure beyond its last valve, a feed, a set point.
Source: textbook signals.  See also: periodic, recorded, noise.
"""

import math
from collections.abc import Mapping
from typing import Any

from stickslip.blocks.block import Block, Kernels
from stickslip.blocks.ports import Port, require
from stickslip.blocks.role import Role
from stickslip.blocks.rules import finite


def _constant_out(value: float) -> float:
    return value


def _step_out(t: float, before: float, after: float, at: float) -> float:
    return after if t >= at else before


def _step_next(t: float, at: float) -> float:
    return at if t < at else math.inf


def _ramp_out(t: float, before: float, slope: float, start: float, end: float) -> float:
    return before + slope * (min(max(t, start), end) - start)


def _ramp_next(t: float, start: float, end: float) -> float:
    if t < start:
        return start
    return end if t < end else math.inf


class Source(Block):
    """A block without inputs: it gives one signal, which bears its name unless ``name`` says otherwise.

    Subclasses fill in the class data and call ``__init__`` with their parameters.
    """

    role = Role.SOURCE
    ports_out = (Port("out"),)

    def __init__(self, signal: str, params: Mapping[str, float], *, unit: str, name: str, **data: Any) -> None:
        super().__init__(name=name or signal, params=params, outputs=signal, units={"out": unit}, **data)


class Constant(Source):
    """A signal that never changes: ``value``.

    >>> float(Constant("SP", 0.5).output(7.0, [], [])[0])
    0.5
    """

    kernels = Kernels(out=_constant_out, linear=True)

    def __init__(self, signal: str, value: float, *, unit: str = "", name: str = "") -> None:
        super().__init__(signal, {"value": value}, unit=unit, name=name)

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` unless the value is finite."""
        finite(params, name, "value")


class Step(Source):
    """A step: ``before`` until ``at`` [s], ``after`` from then on.

    >>> float(Step("SP", after=0.5).output(0.0, [], [])[0])
    0.5
    """

    kernels = Kernels(out=_step_out, next_time=_step_next, linear=True)

    def __init__(
        self, signal: str, after: float = 1.0, before: float = 0.0, at: float = 0.0, unit: str = "", name: str = ""
    ) -> None:
        super().__init__(signal, {"before": before, "after": after, "at": at}, unit=unit, name=name)

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` unless both levels are finite and ``at`` is a time."""
        finite(params, name, "before", "after")
        at = float(params["at"])
        require(not math.isnan(at), name, "at", at, "it must be a time", "give at= in seconds")


class Ramp(Source):
    """A ramp: ``before`` until ``start`` [s], then ``slope`` [unit/s] until ``end`` [s] (default: for ever).

    >>> feed = Ramp("Z_I", slope=-0.12 / 720, before=0.37, end=720.0)
    >>> [round(float(feed.output(t, [], [])[0]), 4) for t in (0.0, 360.0, 720.0, 900.0)]
    [0.37, 0.31, 0.25, 0.25]
    """

    kernels = Kernels(out=_ramp_out, next_time=_ramp_next, linear=True)

    def __init__(
        self,
        signal: str,
        slope: float,
        *,
        start: float = 0.0,
        end: float = math.inf,
        before: float = 0.0,
        unit: str = "",
        name: str = "",
    ) -> None:
        params = {"before": before, "slope": slope, "start": start, "end": end}
        super().__init__(signal, params, unit=unit, name=name)

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` unless before, slope and start are finite and end >= start."""
        finite(params, name, "before", "slope", "start")
        start, end = float(params["start"]), float(params["end"])
        rule = f"a ramp cannot end before its start at {start} s"
        require(end >= start, name, "end", end, rule, "give an end after start")

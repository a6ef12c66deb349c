"""An effect: something physical that a model may leave out, with its place, its parameters and what it does there.

An effect is put into a diagram at a place, which is a block of the right role: stiction at a valve, a lag at a sensor.
It does its work by blocks of its own in the path of a signal, or by other parameters of the block that is there; open
inputs, declared outputs and labels stay.  At its neutral values it is not there at all.  An effect of the historian
changes no diagram but the log.

    effect.insert(diagram, place, **values)      the diagram with the effect
    effect.settings(diagram, place, **values)    the same as parameters of blocks, for many values of one insertion
    effect.started(diagram, place, first)        that diagram started where a log starts
    effect.on_log(log, place, **values)          what the log is then (effects of the historian)

One file an effect, in ``gap/effects/``; CONTRIBUTING.md says how to add one.
"""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

import numpy as np
from stickslip.blocks.block import Block
from stickslip.blocks.ports import nearest
from stickslip.blocks.role import Role
from stickslip.diagram.diagram import Diagram
from stickslip.gap.insertion.scales import scale
from stickslip.logs import Log
from stickslip.logs.arrays import Values

NOMINAL = math.nan  # neutral value of a parameter whose neutral value is what the model has


class EffectError(ValueError):
    """An effect cannot be put there, or not with these values."""


@dataclass(frozen=True)
class Parameter:
    """A parameter of an effect: ``name``, ``unit``, ``neutral`` value, physical bounds ``low`` and ``high``.

    ``neutral`` is NaN where it is what the model has.  ``per`` says of what the bounds are multiples: "" of the unit
    itself, "span" of the span of the measurement at the place, "time" of the time scale of its loop, "size" of what a
    source gives (``stickslip.gap.insertion.scales``).  ``spacing``: how a search should go through the range, "linear"
    or "log" (factors, times).  A ``nuisance`` has to be found for a replay, but is no part of the size of the effect:
    the phase of a wave, the time of the first scan.  Not ``smooth``: innovations have no slope in it, the log's digits
    give it.
    """

    name: str
    unit: str
    neutral: float
    low: float
    high: float
    spacing: Literal["linear", "log"] = "linear"
    per: Literal["", "span", "time", "size"] = ""
    nuisance: bool = False
    smooth: bool = True

    def grid(self, n: int, factor: float = 1.0) -> Values:
        """Return ``n`` values over the range, the neutral one left out; ``factor`` what ``per`` stands for.

        >>> Parameter("tau", "s", 0.0, 0.1, 10.0, "log").grid(3).tolist()
        [0.1, 1.0, 10.0]
        """
        low, high = self.low * factor, self.high * factor
        values = np.geomspace(low, high, n) if self.spacing == "log" else np.linspace(low, high, n)
        found: Values = values[values != self.neutral]
        return found


class Effect:
    """Base of all effects: subclasses fill in the class data and ``put`` or ``settings``, or both.

    Class data: ``name``; ``role`` of the blocks it may be at; ``parameters``; ``hidden``, whether it has a mode that no
    log shows (a stem that sticks); ``of_log``, whether it acts on the log only; ``nests`` the effect that
    it is where its further parameters are neutral; ``reads`` what a controller reads in whose paths it lies, SP or PV;
    ``level`` the parameter that says where the model has the right level, which an effect may have or not.
    """

    name: ClassVar[str] = ""
    role: ClassVar[Role] = Role.PROCESS
    parameters: ClassVar[tuple[Parameter, ...]] = ()
    hidden: ClassVar[bool] = False
    of_log: ClassVar[bool] = False
    nests: ClassVar[str] = ""
    reads: ClassVar[tuple[str, ...]] = ()
    level: ClassVar[str] = ""

    def __repr__(self) -> str:
        said = ", ".join(f"{p.name} [{p.unit}]" for p in self.parameters)
        return f"<Effect {self.name} at a {self.role}: {said}>"

    # --- what subclasses fill in --------------------------------------------------------------------------
    def fits(self, diagram: Diagram, block: Block) -> bool:
        """Return whether the effect is possible at a block of its role."""
        return True

    def put(self, diagram: Diagram, place: str) -> Diagram:
        """Return the diagram with the blocks of the effect, whose values ``settings`` gives afterwards."""
        return diagram

    def settings(self, diagram: Diagram, place: str, **values: Any) -> dict[str, Any]:
        """Return the effect as parameters of blocks, ``{"valve:stiction.S": 0.05}``; each value may be an array.

        ``diagram`` is the one without the effect; the parameters are for the one with it.
        """
        return {}

    def started(self, diagram: Diagram, place: str, first: Mapping[str, float]) -> Diagram:
        """Return the diagram, which has the effect, started where some signals, e.g. those of a log, start."""
        return diagram

    def log_with(self, log: Log, place: str, values: Mapping[str, float]) -> Log:
        """Return the log that the historian keeps of a log; only effects ``of_log`` have something to do."""
        return log

    def rules(self, diagram: Diagram, place: str, values: Mapping[str, float]) -> str:
        """Return what is wrong with values taken together, rule and remedy; "" if nothing is."""
        return ""

    def nominal(self, diagram: Diagram, place: str) -> dict[str, float]:
        """Return the values at which the effect is not there; for a parameter neutral at NaN the model's own."""
        return {p.name: p.neutral for p in self.parameters}

    def absent(self, diagram: Diagram, place: str, values: Mapping[str, float]) -> bool:
        """Return whether the effect is not there at these values; nuisances do not count."""
        nominal = self.nominal(diagram, place)
        return all(values[p.name] == nominal[p.name] for p in self.parameters if not p.nuisance)

    # --- use ----------------------------------------------------------------------------------------------
    def block(self, place: str) -> str:
        """Return the name of the block that the effect puts in at a place: ``valve:stiction``."""
        return f"{place}:{self.name}"

    def places(self, diagram: Diagram) -> tuple[str, ...]:
        """Return the names of the blocks where the effect is possible."""
        return tuple(
            b.name for b in diagram.blocks if b.role is self.role and ":" not in b.name and self.fits(diagram, b)
        )

    def bounds(self, diagram: Diagram, place: str) -> dict[str, tuple[float, float]]:
        """Return parameter -> (low, high) in its unit at this place."""
        return {
            p.name: (p.low * factor, p.high * factor)
            for p in self.parameters
            for factor in [scale(diagram, place, p.per)]
        }

    def grid(self, diagram: Diagram, place: str, n: int) -> dict[str, Values]:
        """Return parameter -> about ``n`` values to try first, over its bounds at this place."""
        return {p.name: p.grid(n, scale(diagram, place, p.per)) for p in self.parameters}

    def insert(self, diagram: Diagram, place: str, **values: float) -> Diagram:
        """Return the diagram with the effect at ``place``; parameters that are not given are neutral.

        Raises ``EffectError`` for a place where the effect cannot be, or for values that it cannot have.
        """
        full = self.checked(diagram, place, values)
        if self.of_log or self.absent(diagram, place, full):
            return diagram
        if any(b.name == self.block(place) or b.name.startswith(f"{self.block(place)}/") for b in diagram.blocks):
            raise EffectError(
                f"{self.name} is at '{place}' already; set its parameters with diagram.with_params(settings(...))"
            )
        return self.put(diagram, place).with_params(self.settings(diagram, place, **full))

    def on_log(self, log: Log, place: str = "historian", **values: float) -> Log:
        """Return the log with the effect in it; the log as it is for an effect that acts in the diagram.

        Raises ``EffectError`` for values that it cannot have.
        """
        full = {p.name: p.neutral for p in self.parameters} | self._numbers(values)
        return self.log_with(log, place, full) if self.of_log else log

    def checked(self, diagram: Diagram, place: str, values: Mapping[str, float]) -> dict[str, float]:
        """Return all parameters by name, those not given neutral.

        Raises ``EffectError`` for an unknown place or name, or values that the effect cannot have.
        """
        known = self.places(diagram)
        if place not in known:
            where = nearest(place, known) if known else self.nowhere(diagram)
            raise EffectError(f"{self.name} cannot be at '{place}'; {where}")
        full = {**self.nominal(diagram, place), **self._numbers(values)}
        wrong = self.rules(diagram, place, full)
        if wrong:
            raise EffectError(f"{self.name} at '{place}': {wrong}")
        return full

    def nowhere(self, diagram: Diagram) -> str:
        """Return why no place fits, and what to do."""
        return f"the diagram has no {self.role} where it could be"

    def _numbers(self, values: Mapping[str, float]) -> dict[str, float]:
        given = {}
        known = [p.name for p in self.parameters]
        for key, value in values.items():
            if key not in known:
                raise EffectError(f"{self.name} has no parameter '{key}'; {nearest(key, known)}")
            try:
                given[key] = float(value)
            except (TypeError, ValueError):
                raise EffectError(f"{self.name}: {key} = {value!r}, but it must be a single number; give one") from None
            if math.isnan(given[key]) and key != self.level:
                raise EffectError(f"{self.name}: {key} is not a number; give one, or leave it out for none")
        return given


def not_below(values: Mapping[str, float], limits: Mapping[str, float], remedy: str = "give 0 for none") -> str:
    """Return what is wrong with values that must be finite and not below a limit each; "" if nothing is."""
    for key, low in limits.items():
        if not low <= values[key] < math.inf:
            return f"{key} = {values[key]:g}, but it must be finite and at least {low:g}; {remedy}"
    return ""


def above(values: Mapping[str, float], *keys: str, remedy: str = "give 1 for none") -> str:
    """Return what is wrong with values that must be finite and above zero; "" if nothing is."""
    for key in keys:
        if not 0.0 < values[key] < math.inf:
            return f"{key} = {values[key]:g}, but it must be finite and above 0; {remedy}"
    return ""


def finite(values: Mapping[str, float], *keys: str, remedy: str = "give 0 for none") -> str:
    """Return what is wrong with values that must be finite; "" if nothing is."""
    for key in keys:
        if not math.isfinite(values[key]):
            return f"{key} = {values[key]:g}, but it must be finite; {remedy}"
    return ""


def known_first(first: Mapping[str, float], signals: Iterable[str], default: float = 0.0) -> float:
    """Return the first value of the first of these signals that has one."""
    return next((float(first[s]) for s in signals if s in first and math.isfinite(first[s])), default)

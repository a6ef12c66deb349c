"""What a model states, whatever it is held against; an effect that is in it already has sizes that are free."""

import math
from abc import abstractmethod
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from stickslip.diagram.diagram import Diagram
from stickslip.gap.answers.report import Size
from stickslip.gap.insertion.effect import Effect, Parameter
from stickslip.gap.records.model import Nuisance, known_within, nuisances, silenced, smoothed, stated, stated_about
from stickslip.gap.records.record import Record
from stickslip.logs.arrays import Values
from stickslip.logs.normal import Z90

SKIPPED = 60  # rows at the beginning in which a start is forgotten, a quarter of the record at most


@dataclass(frozen=True, eq=False)
class Part:
    """An ``effect`` at a ``place`` that is part of a model, its ``values``, and ``bounds`` of those that are free."""

    effect: Effect
    place: str
    values: Mapping[str, float]
    bounds: Mapping[str, tuple[float, float]]

    def key(self, name: str) -> str:
        """Return the name of a parameter among all that is free, which no other effect has."""
        return f"{self.effect.block(self.place)}.{name}"

    def now(self, values: Mapping[str, float]) -> dict[str, float]:
        """Return the values of its parameters among all, those that are not there as they were fitted."""
        return {name: values.get(self.key(name), size) for name, size in self.values.items()}

    @cached_property
    def free(self) -> dict[str, tuple[float, float]]:
        """Its sizes that have a slope, by ``key`` -> (low, high)."""
        known = [p.name for p in self.effect.parameters if p.smooth and math.isfinite(self.values[p.name])]
        return {self.key(name): self.bounds[name] for name in known if name in self.bounds}

    def sizes(self, values: Mapping[str, float], sd: Mapping[str, float]) -> dict[str, Size]:
        """Return its sizes with intervals; ``values`` of what is free, and standard deviations, by ``key``."""
        known = {name: sd[self.key(name)] for name in self.values if self.key(name) in sd}
        return sizes(self.effect.parameters, self.now(values), known, self.bounds)


def sizes(
    parameters: Iterable[Parameter], values: Mapping[str, float], sd: Mapping[str, float],
    bounds: Mapping[str, tuple[float, float]],
) -> dict[str, Size]:  # fmt: skip
    """Return the sizes of an effect with intervals of 90 % within bounds; one without a standard deviation is exact."""
    found: dict[str, Size] = {}
    for p in parameters:
        value = float(values[p.name])
        if p.nuisance or not math.isfinite(value):
            continue
        wide = Z90 * sd.get(p.name, 0.0)
        low, high = bounds.get(p.name, (value, value))
        found[p.name] = Size(value, max(value - wide, min(low, value)), min(value + wide, max(high, value)), p.unit)
    return found


@dataclass(frozen=True, eq=False)
class Given:
    """What a ``model`` with its nuisances states; ``part`` an effect that was put into ``without``, None for none."""

    model: Diagram
    part: Part | None = None
    without: "Given | None" = None

    @property
    def base(self) -> "Given":
        """The model as it was given, without any effect."""
        return self.without.base if self.without else self

    @cached_property
    def quiet(self) -> Diagram:
        """The model without random numbers."""
        return silenced(self.model)

    @cached_property
    def smooth(self) -> Diagram:
        """The model as a filter follows it."""
        return smoothed(self.model)

    @cached_property
    def noise(self) -> tuple[Nuisance, ...]:
        """Sources of random numbers."""
        return nuisances(self.model)

    @cached_property
    def unsure(self) -> dict[str, tuple[float, float]]:
        """Parameters that are known within a tolerance only, and sizes of its part -> (low, high)."""
        if self.part is None or self.without is None:
            return known_within(self.quiet)
        return self.without.unsure | self.part.free

    @cached_property
    def random(self) -> dict[str, tuple[float, float]]:
        """What it states of noise and loads -> (low, high)."""
        return stated_about(self.base.model)

    @cached_property
    def free(self) -> dict[str, tuple[float, float]]:
        """All that can be fitted with every hypothesis -> (low, high)."""
        return self.random | self.unsure

    @cached_property
    def stated(self) -> dict[str, float]:
        """What the model states of all that is free."""
        if self.part is None or self.without is None:
            return stated(self.model, self.free)
        return self.without.stated | {key: self.part.values[key.rpartition(".")[2]] for key in self.part.free}

    def settings(self, values: Mapping[str, float]) -> dict[str, float]:
        """Return the parameters of blocks, block.parameter -> value, that values of what is free stand for."""
        if self.part is None or self.without is None:
            return {key: values[key] for key in self.free if key in values}
        p = self.part
        return self.without.settings(values) | p.effect.settings(self.without.model, p.place, **p.now(values))

    def places(self, effect: Effect) -> tuple[str, ...]:
        """Return where an effect can be beside its part: where it would not change what the part changes."""
        if self.part is None or self.without is None:
            return effect.places(self.model)
        p, before = self.part, self.without.model
        mine = p.effect.settings(before, p.place, **p.values).keys()
        return tuple(
            place for place in self.without.places(effect)
            if (effect.name, place) != (p.effect.name, p.place)
            and not mine & effect.settings(before, place, **effect.nominal(before, place)).keys()
            and effect.fits(self.model, self.model[place])
        )  # fmt: skip

    def with_part(
        self, changed: Diagram, effect: Effect, place: str, values: Mapping[str, float], free: bool
    ) -> "Given":
        """Return the model with an effect of these values, whose blocks ``changed`` has; ``free``: its sizes are."""
        there = changed.with_params(effect.settings(self.model, place, **values))
        return Given(there, Part(effect, place, values, effect.bounds(self.model, place) if free else {}), self)


@dataclass(frozen=True, eq=False)
class Held:
    """A model, ``given``, held against a ``record``."""

    given: Given
    record: Record

    @property
    def model(self) -> Diagram:
        """The model with its nuisances."""
        return self.given.model

    @property
    def quiet(self) -> Diagram:
        """The model without random numbers."""
        return self.given.quiet

    @property
    def smooth(self) -> Diagram:
        """The model as a filter follows it."""
        return self.given.smooth

    @property
    def noise(self) -> tuple[Nuisance, ...]:
        """Sources of random numbers."""
        return self.given.noise

    @property
    @abstractmethod
    def ops(self) -> tuple[str, ...]:
        """The outputs of controllers that are logged or foretold."""

    @property
    @abstractmethod
    def r(self) -> Values:
        """Variance of the log's rounding of each value, (rows, signals)."""

    @cached_property
    def signals(self) -> tuple[str, ...]:
        """Logged signals in the order in which they are taken in: measurements first, then outputs of controllers."""
        return tuple(sorted(self.record.pinned, key=lambda s: self.ops.index(s) if s in self.ops else -1))

    @cached_property
    def Y(self) -> Values:
        """Logged values, (rows, signals); NaN where they are not good."""
        log = self.record.log
        return np.stack([np.where(log.good(s), log[s], np.nan) for s in self.signals], axis=1)

    @cached_property
    def sure(self) -> Values:
        """Loss of a value of each signal that is sure, (signals,): the likelihood of a rounded value is 1/step."""
        return np.asarray(0.5 * np.log(12.0 * np.median(self.r, axis=0) / (2.0 * np.pi)))

    @cached_property
    def skipped(self) -> int:
        """Rows at the beginning that are not judged: a start is forgotten there."""
        return min(SKIPPED, len(self.Y) // 4)

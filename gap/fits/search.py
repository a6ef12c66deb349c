"""Fit an effect to a record by steps along the slopes of the innovations, from sizes that ``ranges`` has found.

Parameters of the model that are known within a tolerance only are free in every fit, within it.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import NDArray
from stickslip.diagram.diagram import Diagram
from stickslip.gap.effects.sensor_noise import SensorNoise
from stickslip.gap.fits.robust import step
from stickslip.gap.floors.floor import scored
from stickslip.gap.floors.modes import CHARGE
from stickslip.gap.floors.problem import Problem, Settled
from stickslip.gap.insertion.effect import Effect
from stickslip.gap.records.offsets import READY

Floats = NDArray[np.float64]
ROUNDS = 6  # steps along the slopes
SETTLED = 0.2  # nats that a step must promise to be taken
PROBE = 1e-3  # of the distance from neutral, or of the range: change of a parameter that shows a slope


@dataclass(frozen=True, eq=False)
class Candidate:
    """An effect at a place of a diagram, or none: what is free in a fit, and how values become a replay.

    ``base`` the silent diagram without the effect; ``free`` the model's own parameters with (low, high).
    """

    problem: Problem
    base: Diagram
    effect: Effect | None = None
    place: str = ""

    @cached_property
    def changed(self) -> Diagram:
        """The diagram with the blocks of the effect."""
        if self.effect is None or self.noisy:
            return self.base
        return _put(self.base, self.effect, self.place, tuple(self.problem.record.first.items()))

    @cached_property
    def bounds(self) -> dict[str, tuple[float, float]]:
        """Parameter -> (low, high): those of the effect, then those of the model that are not exactly known."""
        own = dict(self.effect.bounds(self.base, self.place)) if self.effect else {}
        return own | dict(self.problem.free)

    @cached_property
    def nominal(self) -> dict[str, float]:
        """Parameter -> its value without the effect."""
        own = self.effect.nominal(self.base, self.place) if self.effect else {}
        settled = self.problem.settled.values if self.problem.settled else {}
        return own | {key: float(settled.get(key, self.problem.quiet.params[key])) for key in self.problem.free}

    @cached_property
    def sizes(self) -> tuple[str, ...]:
        """Parameters that are the size of the effect."""
        return tuple(p.name for p in self.effect.parameters if not p.nuisance) if self.effect else ()

    @cached_property
    def rough(self) -> frozenset[str]:
        """Parameters in which innovations have no slope."""
        return frozenset(p.name for p in self.effect.parameters if not p.smooth) if self.effect else frozenset()

    @cached_property
    def own(self) -> tuple[str, ...]:
        """Parameters of the effect, its nuisances too."""
        return tuple(p.name for p in self.effect.parameters) if self.effect else ()

    def tried(self, many: Sequence[Mapping[str, float]]) -> "list[Fit]":
        """Return a fit for each set of values that the effect can have; what is not given is nominal."""
        full = [{name: values.get(name, size) for name, size in self.nominal.items()} for values in many]
        if self.effect and not self.noisy:
            effect, place = self.effect, self.place
            own = [{name: v[name] for name in self.own} for v in full]  # with all at infinity there is no effect
            full = [
                v for v, sizes in zip(full, own, strict=True)
                if any(map(math.isfinite, sizes.values())) and not effect.rules(self.base, place, sizes)
            ]  # fmt: skip
        if not full:
            return []
        columns = {name: np.array([values[name] for values in full]) for name in self.nominal}
        params = {name: columns[name] for name in self.problem.free}
        if self.effect and not self.noisy:
            params |= self.effect.settings(self.base, self.place, **{name: columns[name] for name in self.own})
        params = {key: np.broadcast_to(v, len(full)) for key, v in params.items()}
        e, kept = self.problem.replayed(self.changed, params)
        if self.noisy:  # a replay has no noise; another size of it is another unit of the innovations
            return [narrowed(Fit(self, values, 0.0, one)) for values, one in zip(full, e, strict=True)]
        charges = (CHARGE * kept).tolist()
        return [
            Fit(self, values, float(scored(one)) + charge, one, charge=charge)
            for values, one, charge in zip(full, e, charges, strict=True)
        ]

    def settings(self, values: Mapping[str, float]) -> dict[str, float]:
        """Return what a set of values makes of the parameters of the diagram with the effect."""
        own = {name: values[name] for name in self.own}
        there = self.effect.settings(self.base, self.place, **own) if self.effect and not self.noisy else {}
        return {name: values[name] for name in self.problem.free} | there

    @cached_property
    def noisy(self) -> bool:
        """Whether the effect is another size of a sensor's noise."""
        return isinstance(self.effect, SensorNoise)

    def near(self, values: Mapping[str, float], present: bool = True) -> "Candidate":
        """Return the candidate in whose replays runs do between rows what one with these values does.

        ``present``: whether the effect is there with these values; without it runs do what those of the model do.
        """
        problem = self.problem
        if problem.record.filter is None or problem.record.filter.holds:
            return self
        held = problem.holding(self.changed, self.settings(values)) if present else problem.quick
        return replace(self, problem=held)

    @cached_property
    def absent(self) -> "Fit":
        """The fit without the effect, the model's own parameters nominal."""
        return _alone(self.problem, self.base).of(self)


@dataclass(frozen=True, eq=False)
class Fit:
    """A candidate with the values that suit the record best.

    ``F`` its score; ``e`` (rows, signals) the innovations that are left; ``price`` nats for its parameters, ``charge``
    for modes of a stem that were set right, part of ``F``; ``followed`` whether it has been fitted to the end.
    """

    candidate: Candidate
    values: Mapping[str, float]
    F: float
    e: Floats = field(repr=False)
    price: float = 0.0
    charge: float = 0.0
    followed: bool = False

    def of(self, candidate: Candidate) -> "Fit":
        """Return the same replay as a fit of another candidate, whose effect is not there."""
        return replace(self, candidate=candidate, values=candidate.nominal)

    @property
    def present(self) -> bool:
        """Whether the effect is there at all."""
        nominal = self.candidate.nominal
        return any(self.values[name] != nominal[name] for name in self.candidate.own)

    @property
    def total(self) -> float:
        """Score plus penalty, in log likelihood: candidates are compared by it."""
        return self.F + self.price

    @property
    def effect(self) -> Effect:
        """The effect.

        Raises ``ValueError`` for the fit of a model without one.
        """
        if self.candidate.effect is None:
            raise ValueError("this fit has no effect; it is of the model's own parameters")
        return self.candidate.effect

    @property
    def place(self) -> str:
        """The block at which the effect is."""
        return self.candidate.place


@lru_cache(maxsize=READY)
def _put(base: Diagram, effect: Effect, place: str, first: tuple[tuple[str, float], ...]) -> Diagram:
    """Return a diagram with the blocks of an effect, settled where the log starts; the same one again next time."""
    return effect.started(effect.put(base, place), place, dict(first))


@lru_cache(maxsize=8)
def _alone(problem: Problem, base: Diagram) -> Fit:
    """Return the fit of a diagram without any effect more, the same for all candidates."""
    return Candidate(problem, base).tried([{}])[0]


def narrowed(fit: Fit) -> Fit:
    """Return a fit with the innovations of its sensor's signal in units of a noise ``factor`` times as large.

    F = sum rho(e / factor) + n ln(factor)
    """
    candidate, e = fit.candidate, fit.e.copy()
    pinned = candidate.problem.record.pinned
    columns = [pinned.index(str(s)) for s in candidate.base[candidate.place].output_labels if s in pinned]
    e[:, columns] /= fit.values["factor"]
    n = np.isfinite(e[:, columns]).sum()
    return replace(fit, e=e, F=float(scored(e)) + float(n * np.log(fit.values["factor"])))


def best_of(fits: Sequence[Fit]) -> Fit | None:
    """Return the fit of the lowest score, None if no run succeeded."""
    return min((fit for fit in fits if math.isfinite(fit.F)), key=lambda fit: fit.F, default=None)


def slopes(fit: Fit, names: Sequence[str] | None = None) -> tuple[Floats, list[str]]:
    """Return the slopes of the innovations in the parameters that are felt: (rows x signals, parameters), and which."""
    candidate = fit.candidate
    many, changes, asked = [], [], []
    for name in candidate.bounds if names is None else names:
        at, (low, high), nominal = fit.values[name], candidate.bounds[name], candidate.nominal[name]
        if not math.isfinite(at) or name in candidate.rough:
            continue
        away = abs(at - nominal) if math.isfinite(nominal) else abs(at)
        span = high - low if math.isfinite(high - low) else max(abs(at), 1.0)
        h = PROBE * max(away, 1e-3 * span, span if name in candidate.problem.free else 0.0)
        h = max(h, low - at)  # a value between none and the least that an effect can be costs more than it tells
        change = h if at + h <= high else -h
        many.append({**fit.values, name: at + change})
        changes.append(change)
        asked.append(name)
    # a lag of 0 s is no block: where the effect is not there, the model's own parameters move without it
    own = [k for k, name in enumerate(asked) if fit.present or name not in candidate.problem.free]
    near = candidate.near(fit.values, fit.present)
    moved = _each(near, own, many)
    if len(own) < len(asked):
        alone = Candidate(near.problem, candidate.base)
        moved |= _each(alone, [k for k in range(len(asked)) if k not in own], many)
    if not moved:
        return np.zeros((fit.e.size, 0)), []
    kept = sorted(moved)
    asked = [asked[k] for k in kept]
    J = np.stack([(moved[k].e - fit.e).ravel() / changes[k] for k in kept], axis=1)
    felt = [k for k in range(len(asked)) if float(np.nan_to_num(np.abs(J[:, k])).max(initial=0.0)) > 0.0]
    return J[:, felt], [asked[k] for k in felt]


def near_neutral(candidate: Candidate) -> Floats | None:
    """Return the slope of the innovations in an effect's size at neutral, (rows x signals,); None if there is none."""
    effect = candidate.effect
    return None if effect is None else _near(candidate.problem, candidate.base, effect, candidate.place)


@lru_cache(maxsize=READY // 2)
def _near(problem: Problem, base: Diagram, effect: Effect, place: str) -> Floats | None:
    candidate = Candidate(problem, base, effect, place)
    J, felt = slopes(candidate.absent, candidate.sizes[:1])
    return J[:, 0] if felt else None


def _each(candidate: Candidate, which: Sequence[int], many: Sequence[Mapping[str, float]]) -> dict[int, Fit]:
    """Return the replays at some of many sets of values, by their number; those that cannot be are left out."""
    own = {k: {name: v for name, v in many[k].items() if name in candidate.nominal} for k in which}
    found = candidate.tried(list(own.values()))
    if len(found) == len(own):
        return dict(zip(own, found, strict=True))
    return {k: one[0] for k, values in own.items() if (one := candidate.tried([values]))}


def exact(fit: Fit, problem: Problem) -> Fit | None:
    """Return a fit replayed with runs of its own, as a fit of ``problem``; None if that replay fails."""
    known = fit.candidate.problem
    held = known.record.filter is not None and known.record.filter.holds
    if not held or known is problem or not fit.present:  # without the effect the model's own runs are its runs
        return fit
    own = problem if known.start == problem.start else replace(problem, start=known.start)
    found = best_of(replace(fit.candidate, problem=own).tried([fit.values]))
    return None if found is None else replace(found, price=fit.price, followed=fit.followed)


def refined(fit: Fit, rounds: int = ROUNDS, names: Sequence[str] | None = None) -> Fit:
    """Return a fit after steps along the slopes of its parameters (all, or those named), within their bounds."""
    candidate = fit.candidate
    if candidate.noisy:
        return fit
    for _ in range(rounds):
        J, felt = slopes(fit, names)
        if not felt:
            return fit
        at = np.array([fit.values[name] for name in felt])
        low, high = np.array([candidate.bounds[name] for name in felt]).T
        low, high = np.minimum(low, at) if fit.present else low, np.maximum(high, at)
        d, promised = step(fit.e.ravel(), J, np.minimum(low - at, 0.0), np.maximum(high - at, 0.0))
        if fit.F - promised < SETTLED:
            return fit
        ahead = [
            {**fit.values, **dict(zip(felt, np.clip(at + share * d, low, high).tolist(), strict=True))}
            for share in (1.0, 0.3)
        ]
        best = best_of(candidate.near(fit.values, fit.present).tried(ahead))
        best = best and exact(best, candidate.problem)
        if best is None or best.F >= fit.F:
            return fit
        gained, fit = fit.F - best.F, replace(best, price=fit.price)
        if gained < SETTLED:
            return fit
    return fit


def settled(problem: Problem) -> Problem:
    """Return a problem with its unsure parameters as they suit the record best."""
    if not problem.free:
        return problem
    fit = refined(Candidate(problem, problem.quiet).absent)
    return replace(problem, settled=Settled({key: fit.values[key] for key in problem.free}, fit.e))

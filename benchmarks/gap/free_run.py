"""Effects found by free runs: for a model driven by logged inputs alone, whose noise nobody knows.

    min over theta in bounds of  sum (y - y(theta))^2          y(theta) a run from the first row to the last
    cost = N_eff/2 ln(mean square) + p/2 ln(N_eff)             N_eff = N / 10: rows next to each other say the same

Without stated noise there is no floor to compare with, so effects are added one by one, each time the one that makes
the cost least, all parameters fitted again together within their bounds, as long as it pays (Schwarz 1978).  A
parameter that ends at a bound is a warning: it makes up for something else.  Whether the names hold is judged by runs
on blocks of rows that were left out of the fit, each block in turn.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares
from stickslip.diagram.diagram import Diagram
from stickslip.diagram.ensembles.running import ensemble
from stickslip.gap.insertion.effect import Effect
from stickslip.logs import Log
from stickslip.logs.arrays import Values

NODES = 6  # sizes of an effect's first parameter that are tried first
SHARES = (0.15, 0.5, 0.85)  # of the range of a second one
STEP = 1e-4  # of a range: change that shows a slope
AT_BOUND = 0.005  # of a range: how near a bound is at it
EVALUATIONS = 40  # of one fit
WORTH = 5.0  # nats that an effect must gain to be added
WHITE = 4.0  # standard deviations of the correlation of neighbours of white noise
TOGETHER = 10.0  # rows that say the same, since what a free run leaves lasts


@dataclass(frozen=True)
class Added:
    """An effect at a place of a diagram, ``base`` what it was put into."""

    effect: Effect
    place: str
    base: Diagram

    @property
    def name(self) -> str:
        """A name that no other has."""
        return f"{self.effect.name} at {self.place}"


@dataclass(frozen=True, eq=False)
class FreeFit:
    """A model with effects, fitted to free runs.

    ``values`` parameter -> value, those of effects named ``effect at place.parameter``; ``e`` (rows, outputs) what is
    left; ``cost`` [nats]; ``at_bound`` the parameters that are at a bound.
    """

    model: "FreeModel"
    values: Mapping[str, float]
    e: Values = field(repr=False)
    cost: float

    @property
    def rms(self) -> float:
        """Root mean square of what is left [unit of the output]."""
        return float(np.sqrt(np.nanmean(self.e**2)))

    @property
    def memory(self) -> float:
        """Correlation of what is left at neighbouring rows, the largest of all outputs [-]."""
        e = np.nan_to_num(self.e - np.nanmean(self.e, axis=0))
        both, size = np.sum(e[1:] * e[:-1], axis=0), np.sum(e**2, axis=0)
        return float(np.max(np.abs(both) / np.where(size > 0.0, size, 1.0), initial=0.0))

    @property
    def leaves_noise(self) -> bool:
        """Whether |memory| < 4 / sqrt(rows): white noise exceeds that once in 16000 records."""
        return self.memory < WHITE / math.sqrt(len(self.e))

    @property
    def at_bound(self) -> tuple[str, ...]:
        """Parameters that are at one of their bounds: better fits, but names that are not trusted."""
        found = []
        for name, (low, high) in self.model.bounds.items():
            near = AT_BOUND * (high - low)
            if not low + near < self.values[name] < high - near:
                found.append(name)
        return tuple(found)


@dataclass(frozen=True, eq=False)
class FreeModel:
    """A diagram driven by a log, with effects put in: what is free in it and what a run leaves.

    ``own`` parameters and start values of the diagram with (low, high); ``effects`` in the order they were put in.
    """

    diagram: Diagram
    log: Log
    outputs: tuple[str, ...]
    own: Mapping[str, tuple[float, float]]
    start: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    effects: tuple[Added, ...] = ()

    def with_effect(self, effect: Effect, place: str) -> "FreeModel":
        """Return the model with one more effect."""
        added = Added(effect, place, self.diagram)
        return replace(self, diagram=effect.put(self.diagram, place), effects=(*self.effects, added))

    @property
    def bounds(self) -> dict[str, tuple[float, float]]:
        """Parameter -> (low, high)."""
        found = {**self.own, **self.start}
        for one in self.effects:
            limits = one.effect.bounds(one.base, one.place)
            found |= {f"{one.name}.{p.name}": limits[p.name] for p in one.effect.parameters}
        return found

    def runs(self, many: Sequence[Mapping[str, float]]) -> Values:
        """Return what free runs leave, (runs, rows, outputs); infinite where one fails, or values cannot be."""
        can = [values for values in many if self._can_be(values)]
        if len(can) < len(many):
            e = np.full((len(many), len(self.log), len(self.outputs)), np.inf)
            if can:
                e[[self._can_be(values) for values in many]] = self.runs(can)
            return e
        columns = {name: np.array([values[name] for values in many]) for name in self.bounds}
        params = {name: columns[name] for name in self.own}
        for one in self.effects:
            given = {p.name: columns[f"{one.name}.{p.name}"] for p in one.effect.parameters}
            params |= {
                k: np.broadcast_to(v, len(many)) for k, v in one.effect.settings(one.base, one.place, **given).items()
            }
        run = ensemble(
            self.diagram,
            self.log.duration,
            t0=float(self.log.t[0]),
            times=self.log.t,
            inputs=self.log,
            params=params,
            start={name: columns[name] for name in self.start},
            signals=list(self.outputs),
            seeds=np.zeros(len(many), dtype=int),
            progress=False,
        )
        e = np.stack([self.log[s] - run.values[s] for s in self.outputs], axis=-1)
        e[~run.ok] = np.inf
        return e

    def _can_be(self, values: Mapping[str, float]) -> bool:
        """Return whether every effect can have its values."""
        return not any(
            one.effect.rules(
                one.base, one.place, {p.name: values[f"{one.name}.{p.name}"] for p in one.effect.parameters}
            )
            for one in self.effects
        )

    def fitted(self, start: Mapping[str, float], seen: NDArray[np.bool_] | None = None) -> FreeFit:
        """Return the best fit near start values, judged by the rows that are ``seen`` (default: all)."""
        names = list(self.bounds)
        rows = np.ones(len(self.log), dtype=bool) if seen is None else seen
        if not names:
            e = self.runs([{}])[0]
            return FreeFit(self, {}, e, cost_of(e[rows], 0))
        low, high = np.array([self.bounds[name] for name in names]).T

        def left(z: Values) -> Values:
            e = self.runs([dict(zip(names, low + z * (high - low), strict=True))])[0, rows]
            return np.asarray(np.nan_to_num(e.ravel(), nan=0.0, posinf=1e3))

        def slopes(z: Values) -> Values:
            signs = np.where(z + STEP > 1.0, -STEP, STEP)
            points = [z, *(z + np.eye(len(z))[i] * signs[i] for i in range(len(z)))]
            e = self.runs([dict(zip(names, low + p * (high - low), strict=True)) for p in points])[:, rows]
            e = np.nan_to_num(e.reshape(len(points), -1), nan=0.0, posinf=1e3)
            return np.asarray(((e[1:] - e[0]) / signs[:, None]).T)

        z = np.clip((np.array([start[name] for name in names]) - low) / (high - low), 1e-3, 1.0 - 1e-3)
        best = least_squares(
            left, z, slopes, bounds=(0.0, 1.0), x_scale=0.1, max_nfev=EVALUATIONS, xtol=1e-6, ftol=1e-6
        )
        values = dict(zip(names, (low + best.x * (high - low)).tolist(), strict=True))
        e = self.runs([values])[0]
        return FreeFit(self, values, e, cost_of(e[rows], len(names)))


def cost_of(e: Values, parameters: int) -> float:
    """Return the Bayesian information criterion N_eff/2 ln(mean square) + p/2 ln(N_eff).

    >>> e = np.random.default_rng(0).normal(size=(1000, 1))
    >>> round(cost_of(e, 3) - cost_of(e, 1), 1), round(cost_of(2.0 * e, 1) - cost_of(e, 1), 1)
    (4.6, 69.3)
    """
    e = e[np.isfinite(e).all(axis=1)]
    n = max(len(e) / TOGETHER, 2.0)
    return float(0.5 * n * np.log(np.mean(e**2)) + 0.5 * parameters * np.log(n))


def added(fit: FreeFit, catalogue: Sequence[Effect]) -> Iterator[FreeFit]:
    """Yield the fit of each effect of a catalogue at each place, in addition to those that a fit has."""
    have = {one.name for one in fit.model.effects}
    for effect in catalogue:
        if effect.of_log:
            continue
        for place in effect.places(fit.model.diagram):
            if f"{effect.name} at {place}" not in have:
                model = fit.model.with_effect(effect, place)
                starts = list(_starts(model, fit.values))
                left = np.nanmean(model.runs(starts) ** 2, axis=(1, 2))
                if np.isfinite(left).any():
                    yield model.fitted(starts[int(np.nanargmin(left))])


def _starts(model: FreeModel, values: Mapping[str, float]) -> Iterator[dict[str, float]]:
    one = model.effects[-1]
    limits = one.effect.bounds(one.base, one.place)
    names = [p.name for p in one.effect.parameters]
    first = one.effect.parameters[0]
    low, high = limits[first.name]
    grid = (
        np.geomspace(low, high, NODES)
        if first.spacing == "log"
        else low + (high - low) * (np.arange(NODES) + 0.5) / NODES
    )
    for size in grid:
        for share in SHARES if len(names) > 1 else (0.5,):
            own = {first.name: float(size)} | {
                name: limits[name][0] + share * (limits[name][1] - limits[name][0]) for name in names[1:]
            }
            yield {**values, **{f"{one.name}.{name}": v for name, v in own.items()}}


def explained(
    model: FreeModel, start: Mapping[str, float], catalogue: Sequence[Effect], most: int = 3
) -> list[tuple[FreeFit, list[FreeFit]]]:
    """Return the fits without an effect and with one more each time, best first at each step.

    Each step: the fit that is kept, and all that were tried, cheapest first.
    """
    best = model.fitted(start)
    steps = [(best, [best])]
    for _ in range(most):
        tried = sorted(added(best, catalogue), key=lambda fit: fit.cost)
        if not tried or tried[0].cost > best.cost - WORTH:
            break
        best = tried[0]
        steps.append((best, tried))
    return steps


def folds(log: Log, output: str, blocks: int, count: int) -> list[NDArray[np.bool_]]:
    """Return ``count`` sets of rows to leave out in turn, (rows,): blocks dealt out by how high they reach.

    Each fold so has blocks of every regime, such as near the rim of a tank.

    >>> log = Log(np.arange(8.0), {"y": [0.0, 9, 1, 9, 0, 8, 1, 8]})
    >>> [np.flatnonzero(one).tolist() for one in folds(log, "y", 4, 2)]
    [[0, 1, 6, 7], [2, 3, 4, 5]]
    """
    pieces = np.array_split(np.arange(len(log)), blocks)
    order = sorted(range(blocks), key=lambda k: -float(np.nanmax(log[output][pieces[k]])))
    found = []
    for fold in range(count):
        rows = np.zeros(len(log), dtype=bool)
        for place, k in enumerate(order):
            turn, back = place % count, (place // count) % 2
            if (count - 1 - turn if back else turn) == fold:
                rows[pieces[k]] = True
        found.append(rows)
    return found


def left_out(fit: FreeFit, sets: Sequence[NDArray[np.bool_]]) -> tuple[float, list[float]]:
    """Return the error [unit of the output] of free runs on rows not seen in their fit: in all, and of each set."""
    errors = []
    total, rows = 0.0, 0
    for out in sets:
        again = fit.model.fitted(fit.values, ~out)
        square = float(np.nanmean(again.e[out] ** 2))
        errors.append(math.sqrt(square))
        total, rows = total + square * int(out.sum()), rows + int(out.sum())
    return math.sqrt(total / rows), errors

"""Fit an effect to a record: a few sizes over its whole range first, then steps along the slopes of the innovations.

Innovations are smooth functions of an effect's size where their score is not: between neighbouring sizes they are
interpolated, so that the narrow trough of the score is found from few replays.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from diagram.diagram import Diagram
from gap.effect import Effect
from gap.floor import scored
from gap.problem import Problem
from gap.robust import step

Floats = NDArray[np.float64]
NODES = 7  # sizes of a parameter that are replayed first
BETWEEN = 8  # sizes looked at between two that were replayed
ROUNDS = 6  # steps along the slopes
SETTLED = 0.2  # nats that a step must promise to be taken
PROBE = 1e-3  # of the distance from neutral, or of the range: change of a parameter that shows a slope


@dataclass(frozen=True, eq=False)
class Fit:
    """An effect at a place with the values that suit the record best.

    ``F`` its score; ``e`` (rows, signals) the innovations that are left; ``price`` nats for its parameters.
    """

    effect: Effect
    place: str
    values: Mapping[str, float]
    F: float
    e: Floats
    price: float = 0.0

    @property
    def total(self) -> float:
        """Score and price, what candidates are compared by [nats]."""
        return self.F + self.price


def tried(
    problem: Problem, base: Diagram, effect: Effect, place: str, many: Sequence[Mapping[str, float]]
) -> list[Fit]:
    """Return the effect replayed in a diagram with each set of values that it can have."""
    possible = [values for values in many if not effect.rules(base, place, values)]
    if not possible:
        return []
    columns = {p.name: np.array([values[p.name] for values in possible]) for p in effect.parameters}
    changed = effect.started(effect.put(base, place), place, problem.record.first)
    settings = effect.settings(base, place, **columns)
    e = problem.innovations(changed, {key: np.broadcast_to(v, len(possible)) for key, v in settings.items()})
    return [Fit(effect, place, dict(v), float(scored(one)), one) for v, one in zip(possible, e, strict=True)]


def slopes(problem: Problem, base: Diagram, fit: Fit) -> tuple[Floats, list[int]]:
    """Return the slopes of the innovations in the parameters that are felt: (rows x signals, parameters), and which."""
    effect, place = fit.effect, fit.place
    names = [p.name for p in effect.parameters]
    bounds, nominal = effect.bounds(base, place), effect.nominal(base, place)
    many, changes = [], []
    for name in names:
        at, (low, high) = fit.values[name], bounds[name]
        away = abs(at - nominal[name]) if math.isfinite(nominal[name]) else abs(at)
        h = PROBE * max(away, 1e-3 * (high - low))
        for change in (h, -h):
            if low <= at + change <= high or change < 0.0:
                many.append({**fit.values, name: at + change})
                changes.append(change)
                break
    moved = tried(problem, base, effect, place, many)
    if len(moved) < len(names):
        return np.zeros((fit.e.size, 0)), []
    J = np.stack([(m.e - fit.e).ravel() / h for m, h in zip(moved, changes, strict=True)], axis=1)
    felt = np.flatnonzero(np.nan_to_num(np.abs(J)).sum(axis=0) > 0.0).tolist()
    return J[:, felt], felt


def refined(problem: Problem, base: Diagram, fit: Fit, rounds: int = ROUNDS) -> Fit:
    """Return a fit after steps along the slopes of all its parameters, within their bounds."""
    effect, place = fit.effect, fit.place
    names = [p.name for p in effect.parameters]
    low, high = np.array([effect.bounds(base, place)[name] for name in names]).T
    for _ in range(rounds):
        at = np.array([fit.values[name] for name in names])
        J, felt = slopes(problem, base, fit)
        if not felt:
            return fit
        d, promised = step(fit.e.ravel(), J, (np.minimum(low, at) - at)[felt], (np.maximum(high, at) - at)[felt])
        if fit.F - promised < SETTLED:
            return fit
        ahead = np.repeat(at[None], 2, axis=0)
        ahead[:, felt] += np.array([1.0, 0.3])[:, None] * d
        taken = tried(problem, base, effect, place, [dict(zip(names, v, strict=True)) for v in ahead.tolist()])
        best = min([fit, *taken], key=lambda one: one.F)
        gained = fit.F - best.F
        fit = best
        if gained < SETTLED:
            return fit
    return fit


def between(nodes: Sequence[float], fits: Sequence[Fit]) -> tuple[float, float]:
    """Return (value, F) where interpolated innovations of neighbouring sizes score best."""
    best = min(((fit.F, node) for node, fit in zip(nodes, fits, strict=True)), default=(math.inf, 0.0))
    for k in range(len(nodes) - 1):
        a, b = fits[k].e, fits[k + 1].e
        for share in np.linspace(0.0, 1.0, BETWEEN + 2)[1:-1]:
            F = float(scored(a + share * (b - a)))
            if F < best[0]:
                best = F, nodes[k] + share * (nodes[k + 1] - nodes[k])
    return best[1], best[0]


def with_price(fit: Fit, price: float) -> Fit:
    """Return a fit with what its parameters cost [nats]."""
    return replace(fit, price=price)


def fitted(problem: Problem, base: Diagram, effect: Effect, place: str, nodes: int = NODES) -> Fit | None:
    """Return the best fit of an effect whose parameters each have a neutral value; None if no run succeeded.

    One parameter after the other over its whole range, the others as found so far; then all together.
    """
    values = effect.nominal(base, place)
    best: Fit | None = None
    for name, sizes in effect.grid(base, place, nodes).items():
        here = sorted(_both_sides(sizes.tolist(), values[name]))
        fits = tried(problem, base, effect, place, [{**values, name: size} for size in here])
        fits = [fit for fit in fits if math.isfinite(fit.F)]
        size, F = between([fit.values[name] for fit in fits], fits)
        if not fits:
            continue
        best = min([*fits, *([best] if best else [])], key=lambda fit: fit.F)
        if F < best.F - SETTLED:
            best = min([best, *tried(problem, base, effect, place, [{**values, name: size}])], key=lambda fit: fit.F)
        values = dict(best.values)
    return best


def _both_sides(sizes: Sequence[float], neutral: float) -> set[float]:
    return {*sizes, *([neutral] if math.isfinite(neutral) else [])}

"""Which two effects together may explain a gap: pairs by lines through what each does to the innovations.

    alone     F(a, b) = min over x, y of  sum rho(e + D_a x + D_b y)
    beside    F(a, b) = min over x, y of  sum rho(e_a + J_a x + J_b y)

D: the difference that an effect makes at the sizes that suit it best alone, and its slope at neutral.  e_a: what the
best single effects leave, J_a the slope of their sizes there, J_b that of a second effect at neutral beside them.
Little is replayed but what shows the slopes, and some rows are enough.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
from numpy.typing import NDArray
from stickslip.gap.explanations.candidates import way
from stickslip.gap.fits.inserting import inserted
from stickslip.gap.fits.ranges import fitted
from stickslip.gap.fits.robust import step
from stickslip.gap.fits.search import Candidate, Fit, near_neutral, slopes
from stickslip.gap.fits.together import marked
from stickslip.gap.floors.problem import Problem

Floats = NDArray[np.float64]
Values = dict[str, float]
ROWS = 1500  # that are looked at
SAME = 0.9995  # cosine of the differences of two effects that are one to the record
WIDE = (-0.5, 2.0)  # multiples of the difference that an effect made alone
FIRSTS = 3  # single effects beside which a second is looked for
SMALL = 0.05  # of the way to its bound: a small size


@dataclass(frozen=True, eq=False)
class Proposal:
    """Two candidates, the score ``F`` that lines promise, and values of both (``1.name``, ``2.name``) to start from."""

    first: Candidate
    second: Candidate
    F: float
    starts: tuple[Values, ...]

    @property
    def both(self) -> tuple[Candidate, Candidate]:
        """Both candidates."""
        return self.first, self.second


@dataclass(frozen=True, eq=False)
class _Shape:
    """What an effect does to the innovations: columns ``D``, their bounds, and the values for which each stands."""

    fit: Fit
    D: Floats
    low: tuple[float, ...]
    high: tuple[float, ...]
    starts: tuple[Values, ...]


def proposed(problem: Problem, fits: Sequence[Fit]) -> list[Proposal]:
    """Return pairs of effects, the most promising first, each once."""
    n = len(problem.as_it_is)
    rows = np.unique(np.linspace(0, n - 1, min(ROWS, n)).astype(int))
    shapes = _different([shape for fit in fits if (shape := _shape(fit, rows)) is not None])
    found = [*_alone(problem, shapes, rows), *_beside(problem, shapes, rows)]
    found.sort(key=lambda one: one.F)
    once: dict[frozenset[tuple[str, str]], Proposal] = {}
    for one in found:
        key = frozenset((c.effect.name, c.place) for c in (one.first, one.second) if c.effect)
        had = once.setdefault(key, one)
        if had is not one and had.first.effect is one.first.effect:
            once[key] = replace(had, starts=had.starts + one.starts)
    return list(once.values())


def _alone(problem: Problem, shapes: Sequence[_Shape], rows: NDArray[np.int64]) -> Iterator[Proposal]:
    e = problem.as_it_is[rows].ravel()
    for a, b in combinations(shapes, 2):
        F = step(e, np.concatenate([a.D, b.D], axis=1), np.array(a.low + b.low), np.array(a.high + b.high))[1]
        starts = tuple({**marked(one, "1."), **marked(other, "2.")} for one in a.starts for other in b.starts)
        yield Proposal(a.fit.candidate, b.fit.candidate, F, starts)


def _beside(problem: Problem, shapes: Sequence[_Shape], rows: NDArray[np.int64]) -> Iterator[Proposal]:
    firsts = [shape.fit for shape in shapes if shape.fit.present and not shape.fit.effect.hidden][:FIRSTS]
    for first in firsts:
        base = inserted(problem.quiet, first)
        own, named = slopes(first)
        for shape in shapes:
            candidate = replace(shape.fit.candidate, base=base)
            if shape.fit is first or not smooth(candidate):
                continue
            absent = Fit(candidate, candidate.nominal, first.F, first.e)
            J, felt = slopes(absent, candidate.sizes[:1])
            if not felt:
                continue
            at = np.array([*(first.values[k] for k in named), candidate.nominal[felt[0]]])
            low, high = np.array([*(first.candidate.bounds[k] for k in named), candidate.bounds[felt[0]]]).T
            both = np.concatenate([own, J], axis=1).reshape(*first.e.shape, -1)[rows].reshape(-1, len(at))
            e = first.e[rows].ravel()
            d, F = step(e, both, np.minimum(low - at, 0.0), np.maximum(high - at, 0.0))
            starts = []
            for share in (1.0, 0.5):
                new = np.clip(at + share * d, np.minimum(low, at), np.maximum(high, at))
                new[-1] = max(float(new[-1]), float(low[-1]))
                moved = dict(zip(named, new[:-1].tolist(), strict=True))
                second = {**candidate.nominal, felt[0]: float(new[-1])}
                starts.append({**marked({**first.values, **moved}, "1."), **marked(second, "2.")})
            yield Proposal(first.candidate, shape.fit.candidate, F, tuple(starts))


def smooth(candidate: Candidate) -> bool:
    """Return whether an effect has a slope at neutral, and needs no search of its own kind (a limit, a time)."""
    known = candidate.effect is not None and way(candidate) is fitted
    return known and math.isfinite(candidate.nominal[candidate.sizes[0]])


def _shape(fit: Fit, rows: NDArray[np.int64]) -> _Shape | None:
    candidate = fit.candidate
    if candidate.noisy or candidate.effect is None or candidate.effect.of_log:
        return None
    absent = candidate.absent
    columns, low, high, starts = [], [], [], []
    if fit.present:
        columns.append((fit.e - absent.e)[rows].ravel())
        low.append(WIDE[0])
        high.append(WIDE[1])
        starts.append(dict(fit.values))
    if smooth(candidate):
        slope = near_neutral(candidate)
        if slope is not None:
            name = candidate.sizes[0]
            bounds, nominal = candidate.bounds[name], candidate.nominal[name]
            columns.append(slope.reshape(absent.e.shape)[rows].ravel())
            low.append(bounds[0] - nominal)
            high.append(bounds[1] - nominal)
            starts.append({**absent.values, name: max(bounds[0], nominal + SMALL * (bounds[1] - nominal))})
    D = np.nan_to_num(np.stack(columns, axis=1)) if columns else np.zeros((1, 0))
    return _Shape(fit, D, tuple(low), tuple(high), tuple(starts)) if np.abs(D).sum() > 0.0 else None


def _different(shapes: Sequence[_Shape]) -> list[_Shape]:
    """Return one of all shapes that are the same to the record."""
    kept: list[_Shape] = []
    for shape in shapes:
        own = _unit(shape)
        if not any(abs(float(own @ _unit(one))) > SAME for one in kept):
            kept.append(shape)
    return kept


def _unit(shape: _Shape) -> Floats:
    D = shape.D[:, 0]
    return D / max(float(np.linalg.norm(D)), 1e-300)

"""Whether innovations are what they should be: white, of unit variance, and indifferent to all that is known.

Each figure is normal with mean 0 and standard deviation 1 if the explanation is right; the largest decides.
"""

from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray
from stickslip.logs.arrays import Values

LAGS = (1, 2, 3, 4, 6, 9, 14, 20, 30)
ACROSS = (-4, -3, -2, -1, 0, 1, 2, 3, 4)
BLOCKS = 16  # stretches of a record whose variances are compared
BEHIND = 24  # rows behind a switch of an input
SLOWEST = 40  # of the record's frequencies that are looked at one by one
SYMMETRIC = 0.05  # skewness of a sum below which it is normal
COMPUTED = 100.0  # times the variance to which a run computes a signal: of what others were computed to as well
ROUNDED = 2.0  # times the variance of its rounding: of what is foretold to its last digit
BETTER = 0.5  # of the mean square that is due: so little is no chance in a hundred rows
CALM = 4.0  # innovations beyond are cut before they are compared with anything: a single one is another figure


class Left(Protocol):
    """What an explanation leaves: its innovations that count, (rows, signals)."""

    @property
    def explanation(self) -> Any:
        """What is explained how."""

    @property
    def S(self) -> Values:
        """Their variances, [unit of the signal]^2."""

    @property
    def judged(self) -> Values:
        """The innovations."""


def checks(one: Left) -> dict[str, float]:
    """Return name -> figure, each of mean 0 and standard deviation 1 if the explanation is right."""
    f = one.explanation.filtering
    e = one.judged
    found: dict[str, float] = {}
    e = np.where(_foretold(one, e), np.nan, e)
    known = np.isfinite(e)
    cut = np.clip(np.nan_to_num(e), -CALM, CALM)
    size = np.where(known, np.minimum(np.nan_to_num(e) ** 2, CALM**2) - 1.0, 0.0)
    against = known_of(one)
    for j, s in enumerate(f.signals):
        n = max(int(known[:, j].sum()), 1)
        if n < 100:
            continue
        x, q = cut[:, j], size[:, j]
        q = np.where(known[:, j], q - q.sum() / n, 0.0)
        found[f"size of {s}"] = float(np.nansum(e[:, j] ** 2 - 1.0)) / np.sqrt(2.0 * n)
        found[f"tails of {s}"] = 0.5 * float(np.sum((x**4 - 3.0)[known[:, j]])) / np.sqrt(96.0 * n)
        for lag in LAGS:
            found[f"{s} after {lag} rows"] = _product(x[lag:], x[:-lag])
        for lag in LAGS[:6]:
            found[f"size of {s} after {lag} rows"] = _product(q[lag:], q[:-lag])
        for name, values in against.items():
            found[f"{s} with {name}"] = _product(x, values)
            found[f"size of {s} with {name}"] = normal_of_sizes(_product(q, values), values[known[:, j]])
        parts = np.array_split(np.flatnonzero(known[:, j]), BLOCKS)
        spread = np.array([np.sum(size[part, j]) / np.sqrt(2.0 * len(part)) for part in parts])
        free = BLOCKS - 1
        uneven = (float(np.sum((spread - spread.mean()) ** 2)) - free) / np.sqrt(2.0 * free)
        found[f"variance of {s} by stretches"] = uneven if uneven <= 0.0 else _normal_of_gamma(uneven, 0.5 * free)
        power = np.abs(np.fft.rfft(x))[1:SLOWEST] ** 2 / n  # each exponential with mean 1
        found[f"slow waves of {s}"] = _normal_of_exponential(float(power.max()), len(power))
    if len(f.signals) > 1:
        for j in range(1, len(f.signals)):
            for lag in ACROSS:
                a, b = cut[:, 0], cut[:, j]
                found[f"{f.signals[0]} and {f.signals[j]} {lag} rows apart"] = _product(
                    a[max(-lag, 0) : len(a) - max(lag, 0)], b[max(lag, 0) : len(b) - max(-lag, 0)]
                )
    return found


def _foretold(one: Left, e: Values) -> NDArray[np.bool_]:
    """Return which signals are foretold better than a run computes them, or than their digits say: what is left of
    them says nothing.  A signal that is computed of a coarse one has coarse values itself, which nothing has rounded.
    """
    f = one.explanation.filtering
    usual = np.median(np.where(np.isnan(one.S), np.inf, one.S), axis=0)
    square = np.nansum(e**2, axis=0) / np.maximum(np.isfinite(e).sum(axis=0), 1)
    computed, digits = usual < COMPUTED * f.computed, usual < ROUNDED * np.median(f.r, axis=0)
    return np.asarray((computed & (square < 1.0)) | (digits & (square < BETTER)))


def known_of(one: Left) -> dict[str, Values]:
    """Return what innovations should not go with, by name, (rows,) with mean 0."""
    f = one.explanation.filtering
    log, first = f.record.log, f.skipped
    found: dict[str, Values] = {}
    n = len(log) - first
    t = np.linspace(-1.0, 1.0, n)
    found["time"] = t
    found["time squared"] = t**2
    for s in (one for one in f.signals if log.good(one).any()):  # what a historian drew knows of later rows
        value = np.nan_to_num(log[s], nan=float(np.nanmean(log[s])))
        before = np.concatenate([value[:1], value[:-1]])
        level, moved = before[first:], (value - before)[first - 1 : -1]
        older = np.convolve(value - before, np.ones(4), mode="full")[: len(value)]
        way = older[first - 1 : -1]
        found[f"the level of {s}"] = level
        found[f"the level of {s} squared"] = (level - level.mean()) ** 2
        found[f"the change of {s}"] = np.clip(moved, *np.quantile(moved, (0.02, 0.98)))
        found[f"the size of the change of {s}"] = np.minimum(np.abs(moved), np.quantile(np.abs(moved), 0.98))
        found[f"the direction of {s}"] = np.sign(way)
        found[f"the direction of {s} times its level"] = np.sign(way) * (level - level.mean())
    for s in f.record.played:
        change = np.concatenate([[0.0], np.diff(log[s])])
        up = np.convolve((change > 0.0).astype(float), np.ones(BEHIND))[: len(change)]
        down = np.convolve((change < 0.0).astype(float), np.ones(BEHIND))[: len(change)]
        found[f"rises of {s}"] = up[first:]
        found[f"falls of {s}"] = down[first:]
        fresh = np.convolve((change != 0.0) * 1.0, np.ones(3))[: len(change)]
        found[f"fresh switches of {s}"] = fresh[first:]
        found[f"{s} itself"] = log[s][first:]
    return {name: values - values.mean() for name, values in found.items()}


def normal_of_sizes(figure: float, weights: Values) -> float:
    """Return the normal deviate that is as rare as a standardised sum of squared normal numbers with such weights.

    skew = 2^1.5 sum w^3 / (sum w^2)^1.5,   sum ~ a gamma law of shape 4 / skew^2         (Pearson's type III)

    A few rows with all of the weight have such a law: one large number among them is no rare event.

    >>> few = np.where(np.arange(1000) < 6, 1.0, 0.0)
    >>> round(normal_of_sizes(5.0, few - few.mean()), 2), round(normal_of_sizes(5.0, np.sin(np.arange(1000.0))), 2)
    (3.2, 5.0)
    """
    square = float(np.sum(weights**2))
    skew = 2.0**1.5 * float(np.sum(weights**3)) / square**1.5 if square > 0.0 else 0.0
    return figure if abs(skew) < SYMMETRIC or skew * figure <= 0.0 else _normal_of_gamma(figure, 4.0 / skew**2)


def _normal_of_gamma(figure: float, shape: float) -> float:
    """Return the normal deviate that is as rare as a standardised number of a gamma law, on its long side."""
    from scipy.special import gammaincc, ndtri

    beyond = float(gammaincc(shape, shape + abs(figure) * np.sqrt(shape)))
    return float(np.copysign(max(-ndtri(max(beyond, 1e-300)), 0.0), figure))


def _product(a: Values, b: Values) -> float:
    """Return sum a b over its standard deviation for white a and b that know nothing of each other; 0: not known."""
    known = (a != 0.0) & (b != 0.0)
    a, b = a[known], b[known]
    scale = float(np.sqrt(np.sum(a**2) * np.sum(b**2)))
    return float(np.sum(a * b)) / scale * np.sqrt(len(a)) if scale > 0.0 else 0.0


def _normal_of_exponential(largest: float, of: int) -> float:
    """Return the normal deviate that is as rare as the largest of ``of`` exponential numbers."""
    from scipy.stats import norm

    beyond = -np.expm1(of * np.log1p(-np.exp(-min(largest, 600.0)))) if largest > 1e-9 else 1.0
    return float(norm.isf(np.clip(beyond, 1e-300, 1.0 - 1e-12)))

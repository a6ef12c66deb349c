"""The points of a study: the full grid of the listed axes times a Latin hypercube over the random ones.

A Latin hypercube of n points cuts every axis into n equally likely slices and draws once in each, so that few points
cover every axis evenly; a seed fixes it.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from stickslip.study.axes import Axis, StudyError, Value

MOST_RUNS = 1_000_000


@dataclass(frozen=True)
class Design:
    """The axes and, per point, one value an axis; every point is run ``kicks`` times.

    Run ``r`` is kick ``r % kicks`` of point ``r // kicks``.
    """

    axes: tuple[Axis, ...]
    drawn: tuple[tuple[float, ...], ...]  # Latin hypercube: random axis -> values
    samples: int
    kicks: int

    @property
    def points(self) -> int:
        """How many different points there are."""
        return math.prod(len(axis.values) for axis in self.axes if axis.law is None) * self.samples

    def __len__(self) -> int:
        return self.points * self.kicks

    def at(self, point: int) -> tuple[Value, ...]:
        """Return the values of a point, one an axis; the first listed axis changes slowest, the random ones fastest."""
        rest, sample = divmod(point, self.samples)
        chosen: list[Value] = []
        random = iter(self.drawn)
        for axis in reversed(self.axes):
            if axis.law is None:
                rest, index = divmod(rest, len(axis.values))
                chosen.append(axis.values[index])
            else:
                chosen.append(math.nan)
        return tuple(
            next(random)[sample] if axis.law else value for axis, value in zip(self.axes, chosen[::-1], strict=True)
        )


def design(axes: Sequence[Axis], samples: int | None, seed: int, kicks: int | None) -> Design:
    """Return the design; ``samples`` points are drawn for the random axes, ``kicks`` runs made of each point.

    Raises ``StudyError`` for samples without random axes, random axes without samples, and absurd sizes.

    >>> from stickslip.study.axes import axes_of, uniform
    >>> plan = design(axes_of("vary", {"a.x": [1.0, 2.0], "a.y": uniform(0.0, 1.0)}), 3, 1, 2)
    >>> len(plan), [plan.at(point)[0] for point in range(plan.points)]
    (12, [1.0, 1.0, 1.0, 2.0, 2.0, 2.0])
    """
    names = [(axis.kind, axis.name) for axis in axes]
    for kind, name in names:
        if names.count((kind, name)) > 1:
            raise StudyError(f"'{name}' is varied twice; give all its values at once")
    random = [axis for axis in axes if axis.law]
    if random and samples is None:
        raise StudyError(
            f"'{random[0].name}' is drawn at random, but nothing says how many points to draw; give random= (--random)"
        )
    if samples is not None and not random:
        raise StudyError(f"random = {samples}, but no axis is random; give one a law, e.g. uniform(1250,2250)")
    if samples is not None and not 1 <= samples <= MOST_RUNS:
        raise StudyError(f"random = {samples}, but 1 to {MOST_RUNS:,} points can be drawn")
    if kicks is not None and kicks < 0:
        raise StudyError(f"kicks = {kicks}, but a number of starts is 0 (at rest) or more")
    found = Design(tuple(axes), (), samples or 1, max(kicks or 1, 1))
    if len(found) > MOST_RUNS:
        sizes = [f"{len(axis.values)} of {axis.name}" for axis in axes if axis.law is None]
        sizes += [f"{samples} drawn"] * bool(random) + [f"{found.kicks} kicks"] * (found.kicks > 1)
        raise StudyError(
            f"{' x '.join(sizes)} are {len(found):,} runs and as many rows, but a study has at most {MOST_RUNS:,}; "
            "take fewer values, or draw points at random"
        )
    return Design(found.axes, _drawn(random, found.samples, seed), found.samples, found.kicks)


def _drawn(random: Sequence[Axis], samples: int, seed: int) -> tuple[tuple[float, ...], ...]:
    if not random:
        return ()
    from scipy.stats.qmc import LatinHypercube

    shares = LatinHypercube(len(random), rng=np.random.default_rng(seed)).random(samples)
    return tuple(tuple(axis.law.at(shares[:, k])) for k, axis in enumerate(random) if axis.law)

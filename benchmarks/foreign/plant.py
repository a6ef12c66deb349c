"""What a foreign plant is: its numbers, its run, and the effects that can be put into it."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

Settings = dict[str, float]


class Effect(NamedTuple):
    """An effect at a block: ``of(size)`` are parameters of the plant, neutral at 0, typical at 1.

    ``signed``: -1 is its opposite, and as likely.  ``log``: it acts on the log only.
    """

    place: str
    of: Callable[[float], Settings]
    signed: bool = False
    log: bool = False


class Load(NamedTuple):
    """An unmeasured load: AR(1), new each second, of standard deviation ``sd`` and time constant ``tau`` [s]."""

    sd: float
    tau: float


class Moves(NamedTuple):
    """Set points that step to a level drawn between ``low`` and ``high``, ``dwell`` [s] apart on average."""

    low: float
    high: float
    dwell: float
    start: float

    def path(self, rng: np.random.Generator, t: np.ndarray) -> np.ndarray:
        """Return the set point at ``t``; moves are at least a third of the range and at any time."""
        out, at, level = np.full(len(t), self.start), 0.0, self.start
        while True:
            at += self.dwell * rng.uniform(0.6, 1.4)
            if at >= t[-1]:
                return out
            new = rng.uniform(self.low, self.high)
            while abs(new - level) < (self.high - self.low) / 3.0:
                new = rng.uniform(self.low, self.high)
            level = round(new, 3 - math.ceil(math.log10(max(abs(self.low), abs(self.high)))))
            out[t >= at] = level


@dataclass(frozen=True)
class Plant:
    """A plant and its log.

    ``run(p, sp, load, noise, luck, dt, first, every, out)`` fills rows of ``out``, a column a tag.
    Where ``alike`` is not given, as in a single loop, what leaves the same log is listed in ``scoring.CLASSES``.
    """

    name: str
    parameters: Any  # a NamedTuple of NamedTuples
    run: Callable[..., None]
    tags: Mapping[str, float]  # tag -> rounding by the historian
    set_points: tuple[Any, ...]  # each with ``path(rng, t)``
    loads: tuple[Load, ...]
    sensors: tuple[str, ...]  # fields of ``parameters``
    hours: float
    dt: float  # step of the integrator [s]
    scan: float  # what noise is drawn at [s]
    row: float  # interval of the log [s]
    warm: float  # run before the first row [s]
    measured: tuple[int, ...] = ()  # loads that are logged, so their size is not stated and never wrong
    alike: Mapping[str, tuple[tuple[str, str], ...]] | None = None  # effect -> (effect, place) that leave the same log
    effects: Mapping[str, Effect] = field(default_factory=dict)
    outside: Mapping[str, Effect] = field(default_factory=dict)

    def with_settings(self, settings: Mapping[str, float]) -> Any:
        """Return the parameters with ``"block.parameter"`` replaced."""
        p = self.parameters
        for name, value in settings.items():
            block, parameter = name.split(".")
            part = getattr(p, block)
            p = p._replace(**{block: part._replace(**{parameter: float(value)})})
        return p

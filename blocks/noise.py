"""Random noise, white or coloured, drawn at sampling instants and held in between.

    w_k = a w_(k-1) + sqrt(1 - a^2) n_k,   a = exp(-dt / T_c),   n_k ~ N(0, 1)       (first-order autoregression)
    y_k = mean + sd w_k

so y has mean ``mean``, standard deviation ``sd`` from the first sample on, and autocorrelation exp(-lag / T_c).
T_c = 0 gives white noise.

Random numbers: combined multiple recursive generator MRG32k3a (L'Ecuyer, Operations Research 47(1), 1999,
pp. 159-164) in double arithmetic, where it is exact, so that interpreted and compiled runs draw the same; normal
deviates by Box and Muller's cosine.  The six seeds come from ``numpy.random.SeedSequence``; they are memories of
the block, so the variants of an ensemble with other seeds share everything else (``reseeded``).  A block that is given
no seed takes it from its full name in the diagram (SHA-256), so that two blocks draw different numbers and every run
of one diagram the same.
See also: sensor (noise as part of a measurement).
"""

import hashlib
import math
from collections.abc import Mapping, Sequence
from typing import Any, Self

import numpy as np
from stickslip.blocks.block import Block, Kernels
from stickslip.blocks.ports import BlockError, Port, require
from stickslip.blocks.role import Role
from stickslip.blocks.rules import finite
from stickslip.blocks.sources import Constant

M1 = 4294967087.0
M2 = 4294944443.0
A12 = 1403580.0
A13 = 810728.0
A21 = 527612.0
A23 = 1370589.0
NORM = 1.0 / (M1 + 1.0)
TWO_PI = 2.0 * math.pi

Seed = int | Sequence[int]


def uniform(d: Any, k: int) -> float:
    """Return the next number of (0, 1) of the generator whose six doubles stand at ``d[k]`` ... ``d[k + 5]``."""
    a: float = A12 * d[k + 1] - A13 * d[k]
    a -= math.floor(a / M1) * M1
    if a < 0.0:  # the quotient was rounded up
        a += M1
    d[k] = d[k + 1]
    d[k + 1] = d[k + 2]
    d[k + 2] = a
    b: float = A21 * d[k + 5] - A23 * d[k + 3]
    b -= math.floor(b / M2) * M2
    if b < 0.0:
        b += M2
    d[k + 3] = d[k + 4]
    d[k + 4] = d[k + 5]
    d[k + 5] = b
    return (a - b) * NORM if a > b else (a - b + M1) * NORM


def coloured(d: Any, k: int, dt: float, correlation_time: float) -> float:
    """Advance generator and noise (``d[k]`` ... ``d[k + 6]``) by one sample; return w of unit variance."""
    a = math.exp(-dt / correlation_time) if correlation_time > 0.0 else 0.0
    radius = math.sqrt(-2.0 * math.log(uniform(d, k)))
    w: float = a * d[k + 6] + math.sqrt(1.0 - a * a) * radius * math.cos(TWO_PI * uniform(d, k))
    d[k + 6] = w
    return w


def seeded(seed: Seed) -> dict[str, float]:
    """Return the memories that start an independent stream: six seeds of the generator and a first deviate w.

    Equal seeds give equal streams.  A sequence of integers names a variant: ``(7, 12)`` is variant 12 of study 7.

    Raises ``BlockError`` for a seed that is neither a whole number of 0 or more nor several of them.

    >>> sorted(seeded(1)) == sorted(seeded((7, 12))) and seeded(1) != seeded((7, 12))
    True
    """
    try:
        words = np.random.SeedSequence(seed).generate_state(7)
    except (TypeError, ValueError):
        raise BlockError(
            f"seed = {seed!r}, but a seed is a whole number of 0 or more, or several of them; give one, e.g. seed=7, "
            "or none: then it follows from the block's name"
        ) from None
    moduli = [M1 - 1.0, M1 - 1.0, M1 - 1.0, M2 - 1.0, M2 - 1.0, M2 - 1.0]
    memory = {f"s{i}": 1.0 + float(word) % m for i, (word, m) in enumerate(zip(words[:6], moduli, strict=True))}
    memory["w"] = float(np.random.default_rng(words).normal())
    return memory


def seed_of(name: str) -> Seed:
    """Return the seed of a block of this full name: eight words of its SHA-256, the same on every machine.

    >>> seed_of("a/sensor") == seed_of("a/sensor") != seed_of("b/sensor")
    True
    """
    digest = hashlib.sha256(name.encode()).digest()
    return [int.from_bytes(digest[i : i + 4], "big") for i in range(0, 32, 4)]


def _noise_step(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    y[0] = p[0] + p[1] * coloured(d, 0, p[3], p[2])


class Seeded(Block):
    """A block that draws random numbers: its memories begin with those of ``seeded``.

    ``seed``: None lets it follow from the block's name, also when nesting changes that; ``memory`` what else it
    remembers; the rest as in ``Block``.
    """

    def __init__(self, *, name: str, seed: Seed | None, memory: Mapping[str, float] | None = None, **data: Any) -> None:
        self.follows_name = seed is None
        stream = seeded(seed_of(name) if seed is None else seed)
        super().__init__(name=name, memory={**stream, **(memory or {})}, **data)

    def starting_at(self, **values: float) -> Self:
        """Return a copy with other start values; one whose random numbers are set no longer follows its name."""
        other = super().starting_at(**values)
        if not seeded(0).keys().isdisjoint(values):
            other.follows_name = False
        return other

    def relabelled(self, name: str, inputs: list[str], outputs: list[str]) -> Self:
        """Return a copy under another name, and with the random numbers of that name unless a seed was given."""
        other = super().relabelled(name, inputs, outputs)
        if self.follows_name and name != self.name:
            other = other.reseeded(seed_of(name))
            other.follows_name = True
        return other

    def reseeded(self, seed: Seed) -> Self:
        """Return a copy that draws another, independent stream; equal seeds give equal streams.

        >>> noise = Noise("D", sd=1.0, dt=1.0, seed=3)
        >>> bool((noise.reseeded(3).d0 == noise.d0).all()), bool((noise.reseeded(4).d0 == noise.d0).all())
        (True, False)
        """
        return self.starting_at(**seeded(seed))


class Noise(Seeded):
    """Noise of standard deviation ``sd`` around ``mean``, a new value every ``dt`` [s].

    ``correlation_time`` [s]: 0 for white noise.  ``seed``: an integer or a sequence of integers; by default it follows
    from the block's name, so that two blocks draw different numbers.

    >>> noise = Noise("D", sd=0.1, dt=1.0, seed=1)
    >>> float(noise.output(0.0, noise.d0, [])[0]) == float(noise.output(0.0, noise.d0, [])[0])
    True
    """

    role = Role.DISTURBANCE
    ports_out = (Port("out"),)
    kernels = Kernels(step=_noise_step, feeds=False)
    period_param = "dt"

    def __init__(
        self,
        signal: str,
        sd: float,
        dt: float,
        *,
        correlation_time: float = 0.0,
        mean: float = 0.0,
        seed: Seed | None = None,
        unit: str = "",
        name: str = "",
    ) -> None:
        super().__init__(
            name=name or signal,
            params={"mean": mean, "sd": sd, "correlation_time": correlation_time, "dt": dt},
            seed=seed,
            outputs=signal,
            units={"out": unit},
        )

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` unless mean, dt, sd and correlation_time describe a noise."""
        finite(params, name, "mean")
        check_noise(params, name)

    def smooth(self) -> Block:
        """Return what python-control sees in a continuous diagram: the mean."""
        return Constant(self.output_labels[0], self.p[0], unit=self.units["out"], name=self.name)


def check_noise(params: Mapping[str, float], name: str) -> None:
    """Raise ``BlockError`` unless ``dt``, ``sd`` and ``correlation_time`` describe a noise."""
    finite(params, name, "dt", "sd", "correlation_time")
    dt, sd, tau = (float(params[key]) for key in ("dt", "sd", "correlation_time"))
    require(dt > 0.0, name, "dt", dt, "it must be positive", "give the sampling period in seconds")
    require(sd >= 0.0, name, "sd", sd, "it must not be negative", "give a standard deviation")
    require(tau >= 0.0, name, "correlation_time", tau, "it must not be negative", "give 0 for white noise")

"""An excitation of a loop from outside, computed at scan times: wave, coloured noise, moves and ramp in one block.

    y_k = slope t_k + A_k (wave(x_k) + B sin(2 pi x_k / second)) + sd n_k + w_k + m_k
    x_k = t_k / period + phase + a_k
    a_k = a_(k-1) + wander sqrt(dt/period) n'_k          periods that differ in length, by wander of their mean
    A_k = A exp(swell n''_k)                             and in size; n'' has the correlation time period
    n_k   first-order autoregression of unit variance and correlation time T_c
    w_k = w_(k-1) + walk sqrt(dt) n'_k                   random walk
    m_k   a level drawn from -move ... move, drawn anew with the chance dt/hold at every scan

    shape   0 sine, 1 square, 2 saw (rises in 80 % of its period), 3 triangle

out  y  [its unit]     A  amplitude [unit of y]     period, T_c, hold, dt  [s]     phase, wander, second  [periods]
slope [unit of y / s]   sd, move [unit of y]   walk [unit of y / sqrt(s)]   swell [-]   B  second_size [A]

One block in place of many lets runs with different disturbances share one diagram.  Random numbers: see noise.
"""

import math
from collections.abc import Mapping
from typing import Any

from stickslip.blocks import Block, Kernels, Port
from stickslip.blocks.noise import TWO_PI, Seeded, coloured, seeded, uniform
from stickslip.blocks.role import Role
from stickslip.blocks.rules import finite, not_negative, positive
from stickslip.blocks.sources import Constant

SHAPES = ("sine", "square", "saw", "triangle")
RISE = (0.5, 0.5, 0.8, 0.5)  # share of the period in which the straight lines rise

# p = shape, amplitude, period, phase, slope, sd, correlation_time, walk, move, hold, dt;
# d = six seeds and the deviate of noise, walk, level, the six seeds again and a deviate for walk, moves and wander,
# by how much the wave is ahead, and n''


def _straight(x: float, rise: float) -> float:
    """Return the triangle wave [-1 ... 1] at ``x`` periods that rises in the share ``rise`` of each."""
    x -= math.floor(x)
    return 2.0 * x / rise - 1.0 if x < rise else 1.0 - 2.0 * (x - rise) / (1.0 - rise)


def _wave(shape: float, x: float) -> float:
    """Return the wave [-1 ... 1] at ``x`` periods."""
    if shape == 0.0:
        return math.sin(TWO_PI * x)
    if shape == 1.0:
        return 1.0 if x - math.floor(x) < 0.5 else -1.0
    return _straight(x, 0.8 if shape == 2.0 else 0.5)


def _step(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    value = p[4] * t
    if p[1] != 0.0:
        if p[11] > 0.0:
            d[16] += p[11] * math.sqrt(p[10] / p[2]) * coloured(d, 9, p[10], 0.0)
        if p[12] > 0.0:
            a = math.exp(-p[10] / p[2])
            d[17] = a * d[17] + math.sqrt(1.0 - a * a) * coloured(d, 9, p[10], 0.0)
        x = t / p[2] + p[3] + d[16]
        value += p[1] * math.exp(p[12] * d[17]) * (_wave(p[0], x) + p[14] * math.sin(TWO_PI * x / p[13]))
    if p[5] > 0.0:
        value += p[5] * coloured(d, 0, p[10], p[6])
    if p[7] > 0.0:
        d[7] += p[7] * math.sqrt(p[10]) * coloured(d, 9, p[10], 0.0)
    if p[8] > 0.0 and uniform(d, 9) < p[10] / p[9]:
        d[8] = p[8] * (2.0 * uniform(d, 9) - 1.0)
    y[0] = value + d[7] + d[8]


class Excitation(Seeded):
    """An excitation from outside; all parts are zero unless given, and a new value comes every ``dt`` [s].

    ``shape`` one of 0 sine, 1 square, 2 saw, 3 triangle; ``amplitude``, ``sd``, ``move`` [unit of the signal];
    ``period``, ``correlation_time``, ``hold`` [s]; ``phase``, ``wander``, ``second`` [periods]; ``swell`` [-];
    ``second_size`` [amplitudes];
    ``slope`` [unit/s]; ``walk`` [unit/sqrt(s)].
    Raises ``BlockError`` for times that are not positive or sizes that are negative.

    >>> from stickslip.diagram import drive
    >>> drive(Excitation("d", 1.0, shape=1, amplitude=2.0, period=4.0), 4.0, every=1.0).log["d"].tolist()
    [2.0, 2.0, -2.0, -2.0, 2.0]
    """

    role = Role.DISTURBANCE
    ports_out = (Port("out"),)
    kernels = Kernels(step=_step, feeds=False, timed=True)
    period_param = "dt"

    def __init__(
        self,
        signal: str,
        dt: float,
        *,
        shape: float = 0.0,
        amplitude: float = 0.0,
        period: float = 1.0,
        phase: float = 0.0,
        slope: float = 0.0,
        sd: float = 0.0,
        correlation_time: float = 0.0,
        walk: float = 0.0,
        move: float = 0.0,
        hold: float = 1.0,
        wander: float = 0.0,
        swell: float = 0.0,
        second: float = 1.0,
        second_size: float = 0.0,
        seed: int | None = None,
        name: str = "",
    ) -> None:
        params = {"shape": shape, "amplitude": amplitude, "period": period, "phase": phase, "slope": slope, "sd": sd}
        params |= {
            "correlation_time": correlation_time,
            "walk": walk,
            "move": move,
            "hold": hold,
            "dt": dt,
            "wander": wander,
            "swell": swell,
            "second": second,
            "second_size": second_size,
        }
        super().__init__(
            name=name or signal,
            params=params,
            seed=seed,
            memory={"walked": 0.0, "level": 0.0, **_second(seed), "ahead": 0.0, "swelled": 0.0},
            outputs=signal,
        )

    def reseeded(self, seed: Any) -> Any:
        """Return a copy that draws other, independent random numbers; equal seeds give equal ones."""
        return self.starting_at(**seeded(seed), **_second(seed))

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` unless all numbers are finite, times positive and sizes not negative."""
        finite(params, name, "amplitude", "phase", "slope")
        positive(params, name, "period", "hold", "dt", "second")
        not_negative(params, name, "shape", "sd", "correlation_time", "walk", "move", "wander", "swell", "second_size")

    def smooth(self) -> Block:
        """Return what python-control sees in a continuous diagram: zero."""
        return Constant(self.output_labels[0], 0.0, name=self.name)


def _second(seed: Any) -> dict[str, float]:
    """Return the memories of the generator of walk and moves."""
    given = (0,) if seed is None else (seed,) if isinstance(seed, int) else tuple(seed)
    return {f"moves {key}": value for key, value in seeded((*given, 1)).items()}

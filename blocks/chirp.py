"""Chirp: a sine whose frequency runs from one value to another, for frequency responses.

    y = mean + amplitude sin(2 pi c(s)),   s = t - start,   0 <= s < duration
    linear        c = f_start s + (f_end - f_start) s^2/(2 duration)
    exponential   c = f_start duration/ln(r) (r^(s/duration) - 1),   r = f_end/f_start

out  the signal named first, in the unit given; ``mean`` before ``start`` [s] and from the end of the sweep on
amplitude  half the peak-to-peak value, mean [unit of the signal]      duration  of the sweep [s], > 0
f_start, f_end  frequencies [Hz], > 0, falling or rising

An exponential sweep spends as long in each octave.  Start and end are announced to the engine, and its step is at most
a 24th of a period.  Valid for any finite numbers.  Source: textbook; same phase as ``scipy.signal.chirp``.
See also: periodic (a sine of one frequency), prbs.
"""

import math
from collections.abc import Mapping
from typing import Any

from stickslip.blocks.block import Kernels
from stickslip.blocks.periodic import TWO_PI
from stickslip.blocks.ports import BlockError, nearest, require
from stickslip.blocks.rules import finite, positive
from stickslip.blocks.sources import Source

SWEEPS = {"linear": 0.0, "exponential": 1.0}
PARTS = 24.0  # steps in a period, at least

# p = mean, amplitude, f_start, f_end, duration, start, exponential


def _cycles(s: float, p: Any) -> float:
    """Return the periods passed ``s`` seconds after the start."""
    growth = math.log(p[3] / p[2])
    cycles: float
    if p[6] > 0.0 and growth != 0.0:
        cycles = p[2] * p[4] / growth * math.expm1(growth * s / p[4])
    else:
        cycles = p[2] * s + (p[3] - p[2]) * s * s / (2.0 * p[4])
    return cycles


def _out(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    s = t - p[5]
    y[0] = p[0]
    if s >= 0.0 and t < p[5] + p[4]:
        y[0] += p[1] * math.sin(TWO_PI * _cycles(s, p))


def _next(t: float, x: Any, d: Any, u: Any, p: Any, out: Any) -> None:
    out[1] = math.inf
    if t < p[5]:
        out[0] = p[5]
    elif t < p[5] + p[4]:
        out[0] = p[5] + p[4]
        step = p[4] / PARTS  # so that a sweep of less than a period is seen too
        if p[6] > 0.0:
            growth = math.log(p[3] / p[2])
            f = p[2] * math.exp(growth * (t - p[5]) / p[4])
            rise = max(growth, 0.0) / p[4]
            out[1] = math.log1p(rise / (PARTS * f)) / rise if rise > 0.0 else 1.0 / (PARTS * f)
        else:
            rate = (p[3] - p[2]) / p[4]
            f = p[2] + rate * (t - p[5])
            out[1] = 2.0 / PARTS / (f + math.sqrt(f * f + 2.0 * max(rate, 0.0) / PARTS))
        out[1] = min(out[1], step)


class Chirp(Source):
    """A sine from ``f_start`` to ``f_end`` [Hz] within ``duration`` [s]; ``sweep`` "exponential" or "linear".

    Raises ``BlockError`` unless frequencies and duration are positive and all are finite.

    >>> sweep = Chirp("OP", 0.1, f_start=0.01, f_end=0.03, duration=100.0, sweep="linear", mean=0.5)
    >>> [round(float(sweep.output(t, [], [])[0]), 4) for t in (-1.0, 0.0, 20.0, 120.0)]
    [0.5, 0.5, 0.5998, 0.5]
    """

    kernels = Kernels(out=_out, next_time=_next, feeds=False, timed=True)

    def __init__(
        self,
        signal: str,
        amplitude: float,
        *,
        f_start: float,
        f_end: float,
        duration: float,
        sweep: str = "exponential",
        mean: float = 0.0,
        start: float = 0.0,
        unit: str = "",
        name: str = "",
    ) -> None:
        if sweep not in SWEEPS:
            raise BlockError(f"{name or signal}: sweep = {sweep!r}; {nearest(str(sweep), list(SWEEPS))}")
        range_ = {"f_start": f_start, "f_end": f_end, "duration": duration, "start": start}
        params = {"mean": mean, "amplitude": amplitude} | range_ | {"exponential": SWEEPS[sweep]}
        super().__init__(signal, params, unit=unit, name=name)

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` unless f_start, f_end, duration > 0 and all are finite."""
        finite(params, name, "mean", "amplitude", "start")
        positive(params, name, "f_start", "f_end", remedy="give Hz")
        positive(params, name, "duration", remedy="give seconds")
        law = float(params["exponential"])
        require(law in (0.0, 1.0), name, "exponential", law, "it is 1 or 0 (linear)", "give one of them")

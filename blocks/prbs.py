"""Pseudo-random binary sequence: the usual test signal for identification.

    y = mean + amplitude b_k,   b_k = +1 or -1,   t_k = start + k dt;   b repeats after N = 2^order - 1 bits

out  the signal named first, in the unit given; ``mean`` before ``start`` [s]
amplitude   half the distance of the levels [unit of the signal]       mean  [unit of the signal]
dt          shortest time between two changes [s], > 0                  order  length of the shift register [-], 2 to 15

A sequence of maximum length has 2^(order - 1) bits of one kind and one less of the other, and the autocorrelation 1 at
0 and -1/N else: nearly white up to 1/(3 dt) Hz.  The longest stretch without a change is order dt; choose it to be
about the settling time of the process.  Changes are announced to the engine.  Valid for any finite numbers.
Source: Ljung, System Identification, 2nd ed. 1999, section 13.3; the sequence is SciPy's ``max_len_seq``.
See also: periodic, noise, chirp.
"""

import math
from collections.abc import Mapping
from typing import Any, Self

import numpy as np
from stickslip.blocks.block import Kernels
from stickslip.blocks.periodic import whole
from stickslip.blocks.ports import require
from stickslip.blocks.rules import finite, positive
from stickslip.blocks.sources import Source
from stickslip.blocks.table import same_size

BITS = 5  # where the bits begin in p = n, mean, amplitude, dt, start, b_1 ... b_n


def _bit(k: float, p: Any) -> float:
    """Return bit ``k`` of the endless sequence."""
    bit: float = p[BITS + int(k - math.floor(k / p[0]) * p[0])]
    return bit


def _out(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    y[0] = p[1]
    if t >= p[4]:
        y[0] += p[2] * _bit(whole(t, p[4], p[3]), p)


def _next(t: float, x: Any, d: Any, u: Any, p: Any, out: Any) -> None:
    out[0] = p[4]
    if t >= p[4]:
        k = whole(t, p[4], p[3])
        now = _bit(k, p)
        k += 1.0
        while _bit(k, p) == now:
            k += 1.0
        out[0] = p[4] + k * p[3]


class PRBS(Source):
    """A binary test signal of ``amplitude`` around ``mean`` that may change every ``dt`` [s].

    ``order``: 2 to 15; ``start`` [s].  Raises ``BlockError`` unless dt > 0 and the order is a whole number in there.

    >>> test = PRBS("OP", 0.05, dt=2.0, order=3, mean=0.5)
    >>> [round(float(test.output(2.0 * k, [], [])[0]), 6) for k in range(8)]  # repeats after 7 bits
    [0.55, 0.55, 0.55, 0.45, 0.55, 0.45, 0.45, 0.55]
    """

    kernels = Kernels(out=_out, next_time=_next, feeds=False, timed=True, linear=True)

    def __init__(
        self,
        signal: str,
        amplitude: float,
        dt: float,
        *,
        order: int = 7,
        mean: float = 0.0,
        start: float = 0.0,
        unit: str = "",
        name: str = "",
    ) -> None:
        from scipy.signal import max_len_seq

        rule = order in range(2, 16)
        require(rule, name or signal, "order", order, "it is a whole number from 2 to 15", "7 gives 127 bits")
        bits = 2.0 * np.asarray(max_len_seq(int(order))[0], dtype=float) - 1.0
        params = {"n": bits.size, "mean": mean, "amplitude": amplitude, "dt": dt, "start": start}
        super().__init__(signal, params, table=bits, unit=unit, name=name)

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` unless dt > 0 and all are finite."""
        finite(params, name, "mean", "amplitude", "start")
        positive(params, name, "dt", remedy="give seconds")

    def with_params(self, **changes: float) -> Self:
        """Return a copy with other values; raise ``BlockError`` for another number of bits or an unknown name."""
        same_size(self, changes, "n")
        return super().with_params(**changes)

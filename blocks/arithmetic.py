"""Sums and gains of signals.

    sum   y = offset + w_1 u_1 + ... + w_n u_n
    gain  y = offset + factor u

in  the signals named, out the signal named first; no states.
See also: product, saturation, sensor (gain, offset and limits in one).
"""

from collections.abc import Mapping
from typing import Any

from blocks.block import Block, Kernels
from blocks.ports import Port, require
from blocks.rules import finite


def _sum_out(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    total = p[1]
    for i in range(int(p[0])):
        total += p[2 + i] * u[i]
    y[0] = total


def _gain_out(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    y[0] = p[1] + p[0] * u[0]


class Sum(Block):
    """A weighted sum of signals: ``weights`` maps each input signal to its factor.

    The parameters are ``offset`` and one weight per input, under the name of the signal.

    >>> e = Sum("e", {"SP": 1.0, "PV": -1.0})
    >>> round(float(e.output(0.0, [], [0.5, 0.2])[0]), 6)
    0.3
    """

    ports_out = (Port("out"),)
    kernels = Kernels(out=_sum_out)

    def __init__(
        self, signal: str, weights: Mapping[str, float], *, offset: float = 0.0, unit: str = "", name: str = ""
    ) -> None:
        require(bool(weights), name or signal, "weights", weights, "a sum needs at least one input", "name one")
        self.ports_in = tuple(Port(key) for key in weights)
        super().__init__(
            name=name or signal,
            params={"n": len(weights), "offset": offset, **weights},
            outputs=signal,
            units={"out": unit},
        )

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` unless offset and weights are finite and ``n`` is as built."""
        n, given = len(params) - 2, float(params["n"])
        require(given == n, name, "n", given, f"the sum has {n} inputs", "make another Sum")
        finite(params, name, *params)


class Gain(Block):
    """A factor and an offset: ``signal`` = offset + factor x ``source``, for example to change units.

    >>> percent = Gain("OP_percent", "OP", 100.0, unit="%")
    >>> float(percent.output(0.0, [], [0.25])[0])
    25.0
    """

    ports_in = (Port("in"),)
    ports_out = (Port("out"),)
    kernels = Kernels(out=_gain_out)

    def __init__(
        self, signal: str, source: str, factor: float, *, offset: float = 0.0, unit: str = "", name: str = ""
    ) -> None:
        super().__init__(
            name=name or signal,
            params={"factor": factor, "offset": offset},
            inputs=source,
            outputs=signal,
            units={"out": unit},
        )

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` unless factor and offset are finite."""
        finite(params, name, "factor", "offset")

"""Sums and gains of signals.

    sum   y = offset + w_1 u_1 + ... + w_n u_n
    gain  y = offset + factor u

in  the signals named, out the signal named first; no states.
See also: product, saturation, sensor (gain, offset and limits in one).
"""

import math
from collections.abc import Mapping
from typing import Any

from stickslip.blocks.arguments import by_name
from stickslip.blocks.block import Block, Kernels
from stickslip.blocks.ports import BlockError, Port, require
from stickslip.blocks.role import Role
from stickslip.blocks.rules import finite


def _sum_out(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    total, i = p[0], 1
    while p[i] == p[i]:  # NaN ends the weights, which are finite: no parameter need say how many there are
        total += p[i] * u[i - 1]
        i += 1
    y[0] = total


def _gain_out(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    y[0] = p[1] + p[0] * u[0]


class Sum(Block):
    """A weighted sum of signals: ``weights`` maps each input signal to its factor.

    The parameters are ``offset`` and one weight per input, ``w_`` and the name of the signal.
    ``weights`` [unit of the sum per unit of each input], ``offset`` [unit of the sum].  Inputs of weight 1 or -1 have
    one unit.
    Raises ``BlockError`` without inputs, or for an offset or weight that is not finite.

    >>> e = Sum("e", {"SP": 1.0, "PV": -1.0})
    >>> round(float(e.output(0.0, [], [0.5, 0.2])[0]), 6)
    0.3
    >>> round(float(e.with_params(w_PV=0.0).output(0.0, [], [0.5, 0.2])[0]), 6)
    0.5
    """

    role = Role.ARITHMETIC
    ports_out = (Port("out"),)
    kernels = Kernels(out=_sum_out, linear=True)

    def __init__(
        self, signal: str, weights: Mapping[str, float], *, offset: float = 0.0, unit: str = "", name: str = ""
    ) -> None:
        if isinstance(weights, list | tuple | str):
            ones = dict.fromkeys([weights] if isinstance(weights, str) else weights, 1.0)
            raise BlockError(f"{name or signal}: weights = {weights!r}, but each signal needs its factor; give {ones}")
        by_name(name or signal, "weights", weights or {}, {"SP": 1.0, "PV": -1.0})
        require(bool(weights), name or signal, "weights", weights, "a sum needs at least one input", "name one")
        self.ports_in = tuple(Port(key) for key in weights)
        self.one_unit = tuple(key for key, weight in weights.items() if weight in (1.0, -1.0))
        self.ports_out = (Port(signal, unit),)  # under its own name, because an input may be called "out"
        super().__init__(
            name=name or signal,
            params={"offset": offset, **{f"w_{key}": weight for key, weight in weights.items()}},
            table=[math.nan],
        )

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` unless offset and weights are finite."""
        finite(params, name, *params)


class Gain(Block):
    """A factor and an offset: ``signal`` = offset + factor x ``source``, for example to change units.

    ``factor`` [unit of out per unit of in], ``offset`` [unit of out].

    >>> percent = Gain("OP_percent", "OP", 100.0, unit="%")
    >>> float(percent.output(0.0, [], [0.25])[0])
    25.0
    """

    role = Role.ARITHMETIC
    ports_in = (Port("in"),)
    ports_out = (Port("out"),)
    kernels = Kernels(out=_gain_out, linear=True)

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

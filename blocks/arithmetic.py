"""Sums, gains and limits of signals.

    sum    y = offset + w_1 u_1 + ... + w_n u_n
    gain   y = offset + factor u
    limit  y = low if u < low, high if u > high, else u

in  the signals named, out the signal named first; no states.  A Limit declares its modes, so that the instants
at which it takes hold and lets go are located and logged.  See also: sensor (gain, offset and limits in one).
"""

import math
from collections.abc import Mapping
from typing import Any

from blocks.arguments import by_name
from blocks.block import Block, Kernels
from blocks.limits import FREE, MODES, limit_events, limit_transition
from blocks.ports import BlockError, Port, require
from blocks.role import Role
from blocks.rules import check_limits, finite


def _sum_out(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    total, i = p[0], 1
    while p[i] == p[i]:  # NaN ends the weights, which are finite: no parameter need say how many there are
        total += p[i] * u[i - 1]
        i += 1
    y[0] = total


def _gain_out(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    y[0] = p[1] + p[0] * u[0]


def _limit_out(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    y[0] = min(max(u[0], p[0]), p[1])


def _limit_zc(t: float, x: Any, d: Any, u: Any, p: Any, g: Any) -> None:
    limit_events(u[0], p[0], p[1], d, g)


class Sum(Block):
    """A weighted sum of signals: ``weights`` maps each input signal to its factor.

    The parameters are ``offset`` and one weight per input, ``w_`` and the name of the signal.
    ``weights`` [unit of the sum per unit of each input], ``offset`` [unit of the sum].
    Raises ``BlockError`` without inputs, or for an offset or weight that is not finite.

    >>> e = Sum("e", {"SP": 1.0, "PV": -1.0})
    >>> round(float(e.output(0.0, [], [0.5, 0.2])[0]), 6)
    0.3
    >>> round(float(e.with_params(w_PV=0.0).output(0.0, [], [0.5, 0.2])[0]), 6)
    0.5
    """

    role = Role.ARITHMETIC
    ports_out = (Port("out"),)
    kernels = Kernels(out=_sum_out)

    def __init__(
        self, signal: str, weights: Mapping[str, float], *, offset: float = 0.0, unit: str = "", name: str = ""
    ) -> None:
        if isinstance(weights, list | tuple | str):
            ones = dict.fromkeys([weights] if isinstance(weights, str) else weights, 1.0)
            raise BlockError(f"{name or signal}: weights = {weights!r}, but each signal needs its factor; give {ones}")
        by_name(name or signal, "weights", weights or {}, {"SP": 1.0, "PV": -1.0})
        require(bool(weights), name or signal, "weights", weights, "a sum needs at least one input", "name one")
        free = not {"n", "offset"} & set(weights)
        rule = "n and offset are parameters of the sum itself"
        require(free, name or signal, "weights", dict(weights), rule, "give the signal another label")
        self.ports_in = tuple(Port(key) for key in weights)
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


class Limit(Block):
    """A limiter: ``signal`` is ``source`` kept within ``low`` ... ``high``.

    >>> valve = Limit("x", "OP", low=0.0, high=1.0)
    >>> [float(valve.output(0.0, [], [OP])[0]) for OP in (-0.2, 0.3, 1.4)]
    [0.0, 0.3, 1.0]
    """

    role = Role.ARITHMETIC
    ports_in = (Port("in"),)
    ports_out = (Port("out"),)
    kernels = Kernels(out=_limit_out, zc=_limit_zc, jump=limit_transition, n_events=2)
    modes = MODES
    limit_params = ("low", "high")

    def __init__(
        self,
        signal: str,
        source: str,
        low: float = -math.inf,
        high: float = math.inf,
        *,
        unit: str = "",
        name: str = "",
    ) -> None:
        super().__init__(
            name=name or signal,
            params={"low": low, "high": high},
            memory={"mode": FREE},
            inputs=source,
            outputs=signal,
            units={"in": unit, "out": unit},
        )

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` unless low < high."""
        check_limits(params, name)

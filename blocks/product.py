"""Products and quotients of signals.

    product   y = factor u_1 u_2 ... u_n
    quotient  y = factor u_1/max(u_2, low)

in   the signals named (numerator, then denominator)          out  out  named first
factor   [unit of out per unit of the product or quotient]
low      smallest denominator that counts [unit of the denominator], > 0

A flow in a ratio or a mass balance is positive, so the quotient is meant for positive denominators; one that falls
below ``low`` is held there, and both instants are located and logged (modes of limits).
Valid for any signals; static blocks.  Source: textbook.
See also: arithmetic (sums and gains), lookup_1d (a function of one signal).
"""

import math
from collections.abc import Mapping, Sequence
from typing import Any

from stickslip.blocks.block import Block, Kernels
from stickslip.blocks.limits import FREE, LOW, limit_events, limit_transition
from stickslip.blocks.ports import Port, require
from stickslip.blocks.role import Role
from stickslip.blocks.rules import finite, positive


def _product_out(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    y[0] = p[1]
    for i in range(int(p[0])):
        y[0] *= u[i]


def _divide_out(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    y[0] = p[0] * u[0] / max(u[1], p[1])


def _divide_zc(t: float, x: Any, d: Any, u: Any, p: Any, g: Any) -> None:
    limit_events(u[1], p[1], math.inf, d, g)


class Product(Block):
    """The product of ``sources``, times ``factor``; raises ``BlockError`` without a source.

    >>> power = Product("P", ["tau", "w"], unit="W")
    >>> float(power.output(0.0, [], [3.0, 100.0])[0])
    300.0
    """

    role = Role.ARITHMETIC
    ports_out = (Port("out"),)
    kernels = Kernels(out=_product_out)

    def __init__(
        self, signal: str, sources: Sequence[str], *, factor: float = 1.0, unit: str = "", name: str = ""
    ) -> None:
        require(bool(sources), name or signal, "sources", list(sources), "a product needs an input", "name one")
        self.ports_in = tuple(Port(source) for source in sources)
        super().__init__(
            name=name or signal,
            params={"n": len(sources), "factor": factor},
            outputs=signal,
            units={"out": unit},
        )

    def check(self, params: Mapping[str, float], name: str) -> None:  # type: ignore[override]
        """Raise ``BlockError`` unless the factor is finite and ``n`` is as built."""
        n = len(self.ports_in)
        require(params["n"] == n, name, "n", params["n"], f"the product has {n} inputs", "make another Product")
        finite(params, name, "factor")


class Divide(Block):
    """``numerator`` over ``denominator``, times ``factor``; the denominator counts as at least ``low``.

    Raises ``BlockError`` unless low > 0.

    >>> ratio = Divide("ratio", "F_air", "F_fuel", low=0.1)
    >>> [float(ratio.output(0.0, [], [6.0, fuel])[0]) for fuel in (3.0, 0.0)]
    [2.0, 60.0]
    """

    role = Role.ARITHMETIC
    ports_in = (Port("numerator"), Port("denominator"))
    ports_out = (Port("out"),)
    kernels = Kernels(out=_divide_out, zc=_divide_zc, jump=limit_transition, n_events=2)
    modes = {"free": FREE, "at low limit": LOW}

    def __init__(
        self,
        signal: str,
        numerator: str,
        denominator: str,
        *,
        low: float = 1e-6,
        factor: float = 1.0,
        unit: str = "",
        name: str = "",
    ) -> None:
        super().__init__(
            name=name or signal,
            params={"factor": factor, "low": low},
            memory={"mode": FREE},
            inputs=[numerator, denominator],
            outputs=signal,
            units={"out": unit},
        )

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` unless low > 0 and the factor is finite."""
        finite(params, name, "factor")
        positive(params, name, "low", remedy="give the smallest denominator that makes sense")

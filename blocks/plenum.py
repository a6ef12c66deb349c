"""A plenum: a vessel of gas in which pressure follows from what flows in and out.

    V / c_01^2 dp/dt = sum of inflows - sum of outflows                       (thesis eqs. 3.8 and 3.9)

in   the mass flows named [kg/s]       out  p  pressure [Pa]
V    volume [m3]       c_01  speed of sound [m/s]

Isentropic filling of an ideal gas.  Valid for a constant speed of sound; not for: pressures near vacuum, heat.
Source: thesis eqs. 3.8 and 3.9.  The thesis prints eq. 3.9 with the right-hand side of 3.8; the outlet plenum loses
what leaves it: m_c - m_rv - m_out.
See also: compressor, flow_resistance, separator.
"""

import math
from collections.abc import Mapping, Sequence
from typing import Any

from stickslip.blocks.block import Block, Kernels
from stickslip.blocks.ports import Port, require
from stickslip.blocks.role import Role
from stickslip.blocks.rules import positive

# p = V, c_01, inflows, outflows (numbers of ports)


def _out(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    y[0] = x[0]


def _der(t: float, x: Any, d: Any, u: Any, p: Any, dx: Any) -> None:
    net = 0.0
    n = int(p[2])
    for i in range(n):
        net += u[i]
    for i in range(n, n + int(p[3])):
        net -= u[i]
    dx[0] = net * p[1] * p[1] / p[0]


class Plenum(Block):
    """A vessel of volume ``V`` [m3] that starts at ``start`` [Pa], with the mass flows named [kg/s].

    Raises ``BlockError`` unless V, c_01 and start are positive and some flow is named.

    >>> from stickslip.diagram import drive
    >>> vessel = Plenum(0.6, start=20e5, inflows=["m_in"], outflows=["m_out"])
    >>> drive(vessel, 1.0, every=1.0, m_in=2.0, m_out=1.0).log["p"].round(0).tolist()  # + c_01^2/V Pa
    [2000000.0, 2342665.0]
    """

    role = Role.PROCESS
    ports_out = (Port("p", "Pa"),)
    kernels = Kernels(out=_out, der=_der, feeds=False)

    def __init__(
        self,
        V: float = 0.6,
        *,
        start: float,
        inflows: Sequence[str] = ("m_in",),
        outflows: Sequence[str] = ("m_out",),
        c_01: float = 453.43,
        name: str = "plenum",
        **labels: Any,
    ) -> None:
        inflows, outflows = ((one,) if isinstance(one, str) else tuple(one) for one in (inflows, outflows))
        flows = (*inflows, *outflows)
        require(bool(flows), name, "inflows", inflows, "a plenum needs at least one flow", "name one")
        require(0.0 < start < math.inf, name, "start", start, "a pressure is positive", "give Pa")
        self.ports_in = tuple(Port(flow, "kg/s") for flow in flows)
        super().__init__(
            name=name,
            params={"V": V, "c_01": c_01, "inflows": len(inflows), "outflows": len(outflows)},
            states={"p": start},
            **labels,
        )

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` unless V and c_01 are positive."""
        positive(params, name, "V", "c_01")

    def with_params(self, **changes: float) -> "Plenum":
        """Return a copy with other values of V and c_01; the number of flows belongs to the wiring.

        Raises ``BlockError`` for another number of flows, an unknown name, or a value that breaks the rules.
        """
        for key in ("inflows", "outflows"):
            require(key not in changes, self.name, key, changes.get(key), "the flows are wired", "make another Plenum")
        return super().with_params(**changes)

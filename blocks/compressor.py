"""Centrifugal compressor: gas accelerated in its duct by the map's pressure ratio.

    L_c/A_c dm/dt = Psi p_in - p_out                                          (thesis eq. 3.10)
    Psi = (max(0.2, 1 + h/cpT))^(1/kappa),   h = h_d n^2 psi(q, n)
    q   = m (p_ref/p_in) / (m_d n),   n = w/w_d
    tau = |m| h_d n^2 lam(q, n) / w                                           load on the shaft

in   p_in, p_out  pressures of the plena before and behind [Pa]      w  speed of the shaft [rad/s]
out  m    mass flow [kg/s], negative in deep surge     tau  torque [N m]
     q    corrected flow [-]        q_s  corrected flow at the surge line [-]
A_c, L_c  area [m2] and length [m] of the duct    c_01  speed of sound [m/s]    gamma  heat capacity ratio [-]
m_d, p_ref, w_d, h_d  flow [kg/s], suction pressure [Pa], speed [rad/s] and head scale [J/kg] of the design point
map       psi and lam, see compressor_map: a cubic by default, or tabulated curves

cpT = c_01^2/(gamma - 1), kappa = (gamma - 1)/gamma.  gamma = c_01^2 W/(R T_c) = 1.3067 for methane at 302.95 K,
consistent with c_01.  It stands between two plena; with the outlet throttled it surges (Greitzer).
Valid for n > 0.05 (held below); not for: heating of recycled gas, start-up from rest.
Source: thesis eq. 3.10, printed with the bracket around p_in - p_out, but Psi is a pressure ratio; map, torque and
scales are not printed, see compressor_map and the production plant's parameters.
See also: plenum, shaft, anti_surge, compressor_map.
"""

from collections.abc import Mapping
from typing import Any

from stickslip.blocks.block import Block, Kernels
from stickslip.blocks.compressor_map import CompressorMap, CubicMap, cubic, pressure_ratio
from stickslip.blocks.ports import Port, require
from stickslip.blocks.role import Role
from stickslip.blocks.rules import positive
from stickslip.blocks.tabulated_map import TabulatedMap, edge, tabulated, tabulated_work

SLOWEST = 0.05  # relative speed below which the map is held
VACUUM = 1.0  # Pa, keeps q finite where python-control first evaluates a diagram with all signals at zero

# p = A_c, L_c, c_01, gamma, m_d, p_ref, h_d, w_d, then the map's


def relative_speed(w: float, p: Any) -> float:
    """Return n."""
    n: float = w / p[7]
    return max(n, SLOWEST)


def corrected_flow(m: float, p_in: float, n: float, p: Any) -> float:
    """Return q."""
    q: float = m * p[5] / (max(p_in, VACUUM) * p[4] * n)
    return q


def torque(m: float, n: float, work: float, p: Any) -> float:
    """Return the load [N m] of the flow ``m`` with the work coefficient ``work``."""
    load: float = abs(m) * p[6] * n * work / p[7]
    return load


def acceleration(psi: float, n: float, p_in: float, p_out: float, p: Any) -> float:
    """Return dm/dt [kg/s2] where the map gives ``psi``."""
    rate: float = p[0] / p[1] * (pressure_ratio(p[6] * n * n * psi, p[2], p[3]) * p_in - p_out)
    return rate


def _cubic_out(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    n = relative_speed(u[2], p)
    y[0] = x[0]
    y[1] = torque(x[0], n, 1.0 / p[11], p)
    y[2] = corrected_flow(x[0], u[0], n, p)
    y[3] = 2.0 * p[10]


def _cubic_der(t: float, x: Any, d: Any, u: Any, p: Any, dx: Any) -> None:
    n = relative_speed(u[2], p)
    dx[0] = acceleration(cubic(corrected_flow(x[0], u[0], n, p), p[8], p[9], p[10]), n, u[0], u[1], p)


def _table_out(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    n = relative_speed(u[2], p)
    q = corrected_flow(x[0], u[0], n, p)
    y[0] = x[0]
    y[1] = torque(x[0], n, tabulated_work(q, n, p), p)
    y[2] = q
    y[3] = edge(n, 1, p)


def _table_der(t: float, x: Any, d: Any, u: Any, p: Any, dx: Any) -> None:
    n = relative_speed(u[2], p)
    dx[0] = acceleration(tabulated(corrected_flow(x[0], u[0], n, p), n, p), n, u[0], u[1], p)


_CUBIC = Kernels(out=_cubic_out, der=_cubic_der)
_TABLE = Kernels(out=_table_out, der=_table_der)


class Compressor(Block):
    """A compressor that starts with the flow ``start`` [kg/s]; defaults are C2 of the production plant, set B.

    ``map`` is a ``CubicMap`` or a ``TabulatedMap``.  Raises ``BlockError`` unless all scales are positive, gamma > 1.

    >>> C2 = Compressor(start=47.05)
    >>> m, tau, q, q_s = C2.output(0.0, C2.x0, [22.1e5, 75e5, 994.838])
    >>> round(float(q), 3), float(q_s), round(float(tau))
    (0.832, 0.56, 14285)
    """

    role = Role.PROCESS
    ports_in = (Port("p_in", "Pa"), Port("p_out", "Pa"), Port("w", "rad/s"))
    ports_out = (Port("m", "kg/s"), Port("tau", "N m"), Port("q"), Port("q_s"))

    def __init__(
        self,
        map: CompressorMap | None = None,
        *,
        start: float,
        A_c: float = 0.00956,
        L_c: float = 1.8,
        c_01: float = 453.43,
        gamma: float = 1.3067,
        m_d: float = 76.0,
        p_ref: float = 29.7e5,
        h_d: float = 235590.0,
        w_d: float = 994.838,
        name: str = "compressor",
        **labels: Any,
    ) -> None:
        shape = CubicMap() if map is None else map
        self.map = shape
        self.kernels = _TABLE if isinstance(shape, TabulatedMap) else _CUBIC
        super().__init__(
            name=name,
            params={
                "A_c": A_c, "L_c": L_c, "c_01": c_01, "gamma": gamma,
                "m_d": m_d, "p_ref": p_ref, "h_d": h_d, "w_d": w_d, **shape.named(),
            },
            states={"m": start},
            table=shape.table(),
            **labels,
        )  # fmt: skip

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` unless all scales are positive and gamma > 1."""
        positive(params, name, *params)
        gamma = float(params["gamma"])
        require(gamma > 1.0, name, "gamma", gamma, "a heat capacity ratio exceeds 1", "1.3 is usual for methane")
        for key in ("eta", "valley"):
            share = float(params.get(key, 1.0))
            require(share <= 1.0, name, key, share, "it is a fraction", "divide percent by 100")

    def with_params(self, **changes: float) -> "Compressor":
        """Return a copy with other parameter values; the size of a tabulated map belongs to its table.

        Raises ``BlockError`` for another size, an unknown name, or a value that breaks the rules.
        """
        for key in ("speeds", "points"):
            rule = key not in changes
            require(rule, self.name, key, changes.get(key), "the table has that size", "make another compressor")
        return super().with_params(**changes)

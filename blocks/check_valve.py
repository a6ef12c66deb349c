"""A check valve (non-return valve) in a pipe: flow one way only.

    m = K root(p_up - p_down - p_crack)   while it is open, 0 while it is shut        root() as in control_valve_flow

in   p_up, p_down  pressures [Pa]      out  m  flow [kg/s, or the unit given]
K        flow per root of pressure drop [unit/sqrt(Pa)]       p_crack  drop of its spring, at which it opens [Pa], >= 0
p_lam    drop below which the flow becomes laminar [Pa]

Opening and shutting are located and logged (modes).
Valid for a flap much faster than its flow; not for: its mass (slam), leaks, choked flow.
Source: textbook element; the thesis has none, but its gas cannot flow back from a compressor into a separator.
See also: control_valve_flow and gas_valve_flow (``check_valve=True``: valve and flap in one), flow_resistance.
"""

import math
from collections.abc import Mapping
from typing import Any

from blocks.block import Block, Kernels
from blocks.control_valve_flow import BAND, OPEN, SHUT, root
from blocks.ports import Port, require
from blocks.role import Role
from blocks.rules import not_negative

# p = K, p_crack, p_lam


def _out(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    y[0] = p[0] * root(max(u[0] - u[1] - p[1], 0.0), p[2])


def _zc(t: float, x: Any, d: Any, u: Any, p: Any, g: Any) -> None:
    beyond = u[0] - u[1] - p[1]
    g[0] = (-beyond if d[0] == 0.0 else beyond) - BAND * (abs(u[0]) + abs(u[1]))


def _jump(t: float, x: Any, d: Any, u: Any, p: Any, k: Any) -> None:
    d[0] = 1.0 - d[0]


class CheckValve(Block):
    """A check valve with ``K`` [``unit``/sqrt(Pa)] that opens at a drop of ``p_crack`` [Pa].

    Raises ``BlockError`` unless K > 0, p_crack >= 0 and p_lam >= 0.

    >>> flap = CheckValve(0.06, p_crack=5e3)
    >>> [round(float(flap.output(0.0, [], [p_up, 22.1e5])[0]), 3) for p_up in (20e5, 22.1e5, 22.15e5, 22.4e5)]
    [0.0, 0.0, 0.0, 9.487]
    """

    role = Role.PROCESS
    ports_in = (Port("p_up", "Pa"), Port("p_down", "Pa"))
    ports_out = (Port("m", "kg/s"),)
    kernels = Kernels(out=_out, zc=_zc, jump=_jump, n_events=1)
    modes = {"open": OPEN, "shut": SHUT}

    def __init__(
        self,
        K: float,
        *,
        p_crack: float = 0.0,
        p_lam: float = 100.0,
        unit: str = "kg/s",
        name: str = "check_valve",
        **labels: Any,
    ) -> None:
        params = {"K": K, "p_crack": p_crack, "p_lam": p_lam}
        super().__init__(name=name, params=params, memory={"mode": OPEN}, units={"m": unit}, **labels)

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` unless K > 0, p_crack >= 0 and p_lam >= 0."""
        K = float(params["K"])
        require(0.0 < K < math.inf, name, "K", K, "an open check valve passes some flow", "give flow/sqrt(drop)")
        drop = "a pressure drop is not negative"
        not_negative(params, name, "p_crack", "p_lam", rule=drop, remedy="give Pa, or 0")

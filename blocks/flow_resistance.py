"""A pipe, valve or throttle of fixed opening: turbulent flow, signed.

    m = K root(p_up - p_down)                      root() as in control_valve_flow

in   p_up, p_down  pressures [Pa]      out  m  flow [kg/s, or the unit given]
K    flow per root of pressure drop [unit/sqrt(Pa)]        p_lam  drop below which the flow becomes laminar [Pa]

Algebraic: the inertia of the gas in the pipe is left out.  Valid for both directions; not for: choked flow.
Source: thesis eq. 4.2 with the valve fixed; the pipes from C3 to C2 and from C2 to C1 [E].
See also: control_valve_flow, check_valve (one way only), compressor (a duct with inertia).
"""

import math
from collections.abc import Mapping
from typing import Any

from stickslip.blocks.block import Block, Kernels
from stickslip.blocks.control_valve_flow import root
from stickslip.blocks.ports import Port, require
from stickslip.blocks.role import Role


def _out(p_up: float, p_down: float, K: float, p_lam: float) -> float:
    return K * root(p_up - p_down, p_lam)


class FlowResistance(Block):
    """A fixed resistance ``K`` [``unit``/sqrt(Pa)].

    Raises ``BlockError`` unless K > 0 and p_lam >= 0.

    >>> link = FlowResistance(0.060688)
    >>> round(float(link.output(0.0, [], [22.4e5, 22.1e5])[0]), 3)
    10.511
    """

    role = Role.PROCESS
    ports_in = (Port("p_up", "Pa"), Port("p_down", "Pa"))
    ports_out = (Port("m", "kg/s"),)
    kernels = Kernels(out=_out)

    def __init__(
        self, K: float, *, p_lam: float = 100.0, unit: str = "kg/s", name: str = "link", **labels: Any
    ) -> None:
        super().__init__(name=name, params={"K": K, "p_lam": p_lam}, units={"m": unit}, **labels)

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` unless K > 0 and p_lam >= 0."""
        K, p_lam = float(params["K"]), float(params["p_lam"])
        require(0.0 < K < math.inf, name, "K", K, "a resistance passes some flow", "give flow/sqrt(drop)")
        require(0.0 <= p_lam < math.inf, name, "p_lam", p_lam, "a pressure drop is not negative", "give Pa, or 0")

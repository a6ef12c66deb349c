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

from stickslip.blocks.block import Block, Kernels
from stickslip.blocks.control_valve_flow import BAND, OPEN, SHUT, root
from stickslip.blocks.ports import Port, require
from stickslip.blocks.role import Role
from stickslip.blocks.rules import not_negative


def _out(p_up: float, p_down: float, K: float, p_crack: float, p_lam: float) -> float:
    return K * root(max(p_up - p_down - p_crack, 0.0), p_lam)


def _zc(mode: float, p_up: float, p_down: float, p_crack: float) -> float:
    beyond = p_up - p_down - p_crack
    return (-beyond if mode == OPEN else beyond) - BAND * (abs(p_up) + abs(p_down))


def _jump(mode: float) -> float:
    return SHUT if mode == OPEN else OPEN


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

"""Parts that stems with mass share: spring, moving mass, dry and viscous friction, end stops.

    M dv/dt = k (OP - x) - F_v v - dry friction,   dx/dt = v         low <= x <= high

in   OP  controller output [fraction of span]        out  MV  stem position [fraction of travel]
k    spring, and actuator force per unit of OP [N per travel]     M    moving mass [kg, one travel = 1 m]
F_v  viscous friction [N s per travel]               F_c, F_s  Coulomb and static friction [N], F_s >= F_c

They differ in the law of the dry friction.  See also: stick_slip, stribeck_stem, lugre_stem.
"""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from stickslip.blocks.block import Block, Floats
from stickslip.blocks.declared import STUCK_MODE
from stickslip.blocks.ports import Port, require
from stickslip.blocks.quasi_static_stem import check_stops, started_between
from stickslip.blocks.role import Role
from stickslip.blocks.rules import not_negative, positive
from stickslip.blocks.seen_stem import IDEAL, STUCK, halted, seen_mode, stuck_rate


class StemWithMass(Block):
    """A valve stem with mass; subclasses give ``kernels``, ``modes`` and parameters and states of their ``own``.

    ``at_rest``: the mode in which it starts.  ``start``: where it rests at the start [fraction of travel].
    Raises ``BlockError`` for parameters no valve can have.
    """

    role = Role.VALVE
    ports_in = (Port("OP"),)
    ports_out = (Port("MV"),)
    limit_params = ("low", "high")
    at_rest = STUCK

    def __init__(
        self, F_s: float, F_c: float, own: Mapping[str, float], own_states: Mapping[str, float] | None = None, *,
        k: float = 52500.0, M: float = 1.36, F_v: float = 612.0, low: float = 0.0, high: float = 1.0,
        start: float = 0.0, name: str = "valve", **labels: Any,
    ) -> None:  # fmt: skip
        started_between(low, high, start, name)
        super().__init__(
            name=name,
            params={"k": k, "M": M, "F_v": F_v, "F_c": F_c, "F_s": F_s, "low": low, "high": high, **own},
            states={"x": start, "v": 0.0, **(own_states or {})},
            memory={"mode": self.at_rest},
            **labels,
        )

    def seen_memory(self, x: Floats, u: Floats) -> Floats:
        """Return the mode, shape (1,), in which python-control sees a stem that sticks; "ideal" it stays.

        A stem whose bristles bend has no stuck mode; its modes are the stops.
        """
        if self.keeps_mode or STUCK_MODE not in self.modes or self.d0[0] == IDEAL:
            return self.d0
        k, F_s, low, high = (float(self._p_now[self.param_index(key)]) for key in ("k", "F_s", "low", "high"))
        return np.array([seen_mode(x[0], x[1], k * (u[0] - x[0]), F_s, low, high)])

    def _rhs(self, t: float, x: Floats, u: Floats) -> Floats:
        rates = super()._rhs(t, x, u)
        if STUCK_MODE not in self.modes or self.keeps_mode or self.d0[0] == IDEAL:
            return rates
        k, M, F_v, F_s = (float(self._p_now[self.param_index(key)]) for key in ("k", "M", "F_v", "F_s"))
        pace = 2.0 * (math.sqrt(k / M) + F_v / M)  # faster than the stem would come to rest by itself
        if not rates[0]:
            rates[1] += stuck_rate(x[1], u[0] - x[0], pace)
        elif k * abs(u[0] - x[0]) <= F_s:
            rates[1] = halted(x[1], rates[1], pace)
        return rates

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` unless k, M > 0, F_v >= 0, F_s >= F_c >= 0 and low < high."""
        positive(params, name, "k", "M", remedy="give a positive one")
        not_negative(params, name, "F_v", "F_c")
        F_s, F_c = float(params["F_s"]), float(params["F_c"])
        rule = f"static friction is at least the Coulomb friction, F_s >= F_c = {F_c}"
        require(F_c <= F_s < math.inf, name, "F_s", F_s, rule, "raise F_s or lower F_c")
        check_stops(params, name)

"""Sampled PI that lets small errors be: a gap on the error, or a dead zone of the integral alone.

    e_g = e beyond +-gap, 0 within       e_z = e_g where |e| > zone, 0 within
    v_k = K_p e_g + z_k,    OP_k = v_k limited to low ... high,    z_(k+1) = z_k + dt K_p e_z / T_i

Ports, anti-windup and the other parameters as in sampled_pi; gap = zone = 0 is that block.
gap   error up to which the controller does nothing [unit of PV]; beyond it acts on what is over
zone  error up to which the integral stands still [unit of PV]; beyond it the integral takes in the whole error

A stuck stem makes a limit cycle because the integral goes on while PV is beside SP.  A zone as wide as the stem's jump
moves PV (K J/2) stops it: the stem rests, and PV stays off by at most the zone.
Not for: loops that must hold SP exactly, averaging (the offset is kept), a load that drifts slowly, for which the loop
waits each time until the error leaves the zone.  A level that is only to stay in its tank is what a gap is for.
Source: integral dead zone and error gap are offered by makers of controllers; textbook: F. G. Shinskey, Process Control
Systems, 4th ed. 1996 (two-mode controllers with gap), where stick is named as what they are for.
See also: sampled_pi, dead_zone (as a block of its own).
"""

from collections.abc import Mapping
from typing import Any

from stickslip.blocks.ports import require
from stickslip.blocks.rules import not_negative
from stickslip.blocks.sampled_pi import SampledPI, taken

# p = as sampled_pi, gap, zone; d = z


def _step(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    e = p[5] * (u[0] - u[1])
    over = e - p[9] if e > p[9] else e + p[9] if e < -p[9] else 0.0
    taken(over, over if abs(e) > p[10] else 0.0, d, p, y)


class GapPI(SampledPI):
    """Sampled PI with a ``gap`` on its error and a dead ``zone`` of its integral [unit of PV]; else ``SampledPI``.

    Raises ``BlockError`` as ``SampledPI`` does, for a negative gap or zone, and for conditional anti-windup.

    >>> from stickslip.diagram import drive
    >>> PI = {"K_p": 1.0, "T_i": 10.0, "dt": 1.0, "high": 9.0}
    >>> drive(GapPI(zone=0.2, **PI), 3.0, every=1.0, SP=0.1, PV=0.0).log["OP"].round(3).tolist()
    [0.1, 0.1, 0.1, 0.1]
    >>> drive(GapPI(gap=0.2, **PI), 3.0, every=1.0, SP=0.5, PV=0.0).log["OP"].round(3).tolist()
    [0.3, 0.33, 0.36, 0.39]
    """

    plain_step = staticmethod(_step)

    def __init__(self, K_p: float, T_i: float, *, gap: float = 0.0, zone: float = 0.0, **keywords: Any) -> None:
        super().__init__(K_p, T_i, own={"gap": gap, "zone": zone}, **keywords)
        name, windup = self.name, self.anti_windup
        rule = "a gap has back-calculation or none"
        require(windup != "conditional", name, "anti_windup", windup, rule, "leave it out")

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` as ``SampledPI`` does, and for a negative gap or zone."""
        SampledPI.check(params, name)
        not_negative(params, name, "gap", "zone")

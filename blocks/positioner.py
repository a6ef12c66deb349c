"""Pneumatic positioner and actuator: air flows in or out until the stem stands where OP wants it.

    e      = OP - MV
    dp/dt  = G (e - band/2)   while e > band/2           at most r_fill       filling     (1)
           = G (e + band/2)   while e < -band/2          at most -r_vent      venting
           = 0                in between, and at supply or exhaust pressure   holding

in   OP  controller output [fraction of span]     MV  stem position, fed back [fraction of travel]
out  p   actuator pressure [fraction of the spring range: p = MV balances the spring without friction]
G       gain: spool or nozzle into the volume of the actuator [1/s], > 0
band    dead band of the positioner, movement of OP without air flow [fraction of travel], >= 0
r_fill, r_vent   largest rates at full opening [1/s], > 0; inf lifts them
exhaust, supply  pressures where air stops flowing [fraction of the spring range], exhaust < supply
start            pressure at the start [fraction of the spring range]

The stem follows: wire a StickSlip, StribeckStem or LuGreStem that reads p in place of OP.  Positioner and actuator
integrate: a stuck stem is pushed harder until it breaks away.  Stiction then turns from an offset into dead time, and
where band is smaller than the slip jump J of the stem the positioner's own loop hunts.  Without friction and limits the
closed inner loop is a lag of 1/G.  At band edges, full rates, supply and exhaust the mode changes, each located;
python-control sees the mode that the present values call for.
Valid for a single-acting actuator whose pressure changes little compared with the supply, so that choked flow is
nearly constant; no leak, no pressure loss in tubes, no integral action.

Source: eq. 1 is the usual spool model, an integrator with dead band and rate limit (textbook of fluid power, for
example Merritt, Hydraulic Control Systems, 1967, for the linear spool).
See also: stick_slip, stribeck_stem, lugre_stem, rate_limiter, dead_zone.
"""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from stickslip.blocks.block import Block, Floats, Kernels
from stickslip.blocks.ports import Port, require
from stickslip.blocks.role import Role
from stickslip.blocks.rules import finite, not_negative, positive

HOLDING, OPEN, FULLY, ENDED = 0.0, 1.0, 2.0, 3.0  # with the sign of the flow

NOISE = 1e-7  # of travel: so little inside the band is the integration's error, and does not shut the air off

# p = G, band, r_fill, r_vent, exhaust, supply;   x = p;   d = mode


def _out(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    y[0] = x[0]


def _der(t: float, x: Any, d: Any, u: Any, p: Any, dx: Any) -> None:
    s = 1.0 if d[0] > 0.0 else -1.0
    dx[0] = 0.0
    if abs(d[0]) == OPEN:
        dx[0] = p[0] * (u[0] - u[1] - s * 0.5 * p[1])
    elif abs(d[0]) == FULLY:
        dx[0] = p[2] if s > 0.0 else -p[3]


def _zc(t: float, x: Any, d: Any, u: Any, p: Any, g: Any) -> None:
    g[0] = -1.0
    g[1] = -1.0
    g[2] = -1.0
    if d[0] == HOLDING:
        if x[0] < p[5]:
            g[0] = u[0] - u[1] - 0.5 * p[1]
        if x[0] > p[4]:
            g[1] = u[1] - u[0] - 0.5 * p[1]
    else:
        s = 1.0 if d[0] > 0.0 else -1.0
        over = s * (u[0] - u[1]) - 0.5 * p[1]
        g[0] = -over - NOISE
        if abs(d[0]) != ENDED:
            rate = p[2] if s > 0.0 else p[3]
            if rate < math.inf:
                g[1] = p[0] * over - rate if abs(d[0]) == OPEN else rate - p[0] * over
            g[2] = x[0] - p[5] if s > 0.0 else p[4] - x[0]


def _jump(t: float, x: Any, d: Any, u: Any, p: Any, k: Any) -> None:
    if d[0] == HOLDING:
        d[0] = OPEN if k[0] == 0.0 else -OPEN
    else:
        s = 1.0 if d[0] > 0.0 else -1.0
        if k[0] == 0.0:
            d[0] = HOLDING
        elif k[0] == 1.0:
            d[0] = s * (FULLY if abs(d[0]) == OPEN else OPEN)
        else:
            d[0] = s * ENDED
            x[0] = p[5] if s > 0.0 else p[4]


class Positioner(Block):
    """A positioner with its actuator: OP and the stem's position in, actuator pressure out.

    Raises ``BlockError`` unless G, r_fill, r_vent > 0, band >= 0 and exhaust < supply.

    >>> from stickslip.blocks import Step, StickSlip
    >>> from stickslip.diagram import simulate, wire
    >>> valve = wire([Step("OP", 0.5), Positioner(G=2.0, band=0.005), StickSlip(F_s=1750.0, inputs="p")])
    >>> run = simulate(valve, 30.0, every=10.0)
    >>> bool(abs(run.log["MV"][-1] - 0.5) < 0.01)  # without positioner friction would leave it 0.024 short
    True
    """

    role = Role.VALVE
    ports_in = (Port("OP"), Port("MV"))
    ports_out = (Port("p"),)
    kernels = Kernels(out=_out, der=_der, zc=_zc, jump=_jump, n_events=3, feeds=False, linear=True)
    modes = {
        "holding": HOLDING,
        "filling": OPEN,
        "venting": -OPEN,
        "filling at full rate": FULLY,
        "venting at full rate": -FULLY,
        "at supply pressure": ENDED,
        "at exhaust pressure": -ENDED,
    }

    def __init__(
        self,
        G: float = 2.0,
        band: float = 0.005,
        *,
        r_fill: float = 0.2,
        r_vent: float = 0.2,
        exhaust: float = -0.2,
        supply: float = 1.2,
        start: float = 0.0,
        name: str = "positioner",
        **labels: Any,
    ) -> None:
        rule = f"pressure lies between exhaust = {exhaust} and supply = {supply}"
        require(exhaust <= start <= supply, name, "start", start, rule, "start between them")
        super().__init__(
            name=name,
            params={"G": G, "band": band, "r_fill": r_fill, "r_vent": r_vent, "exhaust": exhaust, "supply": supply},
            states={"p": start},
            memory={"mode": HOLDING},
            **labels,
        )

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` unless G, r_fill, r_vent > 0, band >= 0 and exhaust < supply."""
        positive(params, name, "G", remedy="give 1/s")
        not_negative(params, name, "band")
        for key in ("r_fill", "r_vent"):
            rate = float(params[key])
            require(rate > 0.0, name, key, rate, "air flows at a positive rate", "give 1/s, or inf for no limit")
        finite(params, name, "exhaust", "supply")
        exhaust, supply = float(params["exhaust"]), float(params["supply"])
        require(exhaust < supply, name, "exhaust", exhaust, f"it must be below supply = {supply!r}", "exchange them")

    def seen_memory(self, x: Floats, u: Floats) -> Floats:
        """Return the mode, shape (1,), that the present values call for."""
        G, band, r_fill, r_vent, exhaust, supply = self._p_now
        over = abs(u[0] - u[1]) - 0.5 * band
        s = 1.0 if u[0] > u[1] else -1.0
        if over <= 0.0:
            return np.array([HOLDING])
        if (x[0] >= supply) if s > 0.0 else (x[0] <= exhaust):
            return np.array([s * ENDED])
        return np.array([s * (FULLY if G * over > (r_fill if s > 0.0 else r_vent) else OPEN)])

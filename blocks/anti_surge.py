"""Anti-surge controller: opens the recycle valve when the flow comes near the surge line, faster the nearer.

    e  = margin q_s - q                      shortage of flow
    E  = (1 + boost max(0, e)) e             nonlinear gain: grows inside the margin
    v  = K_p E + z,   OP = v limited to 0 ... 1
    dz/dt = (OP - z)/T_i                     at a limit: K_p E/T_i + (OP - v)/T_t with T_t = T_i
    dz/dt = K_p E/T_i                        between the limits

with ``gradient`` > 0 the gain also grows with the speed at which the flow falls, beyond ``limit``:
    E  = (1 + boost max(0, e)) e + gradient max(0, (f - q)/T_f - limit) max(0, e)
    df/dt = (q - f)/T_f                      so (f - q)/T_f is -dq/dt, smoothed over T_f

in   q    corrected flow through the compressor [-]       q_s  corrected flow at the surge line [-]
out  OP   opening of the recycle valve [fraction]
K_p  gain [-]     T_i  integral time [s]     margin  set point over surge flow [-], > 1     boost  [-], >= 0
gradient  growth of the gain per rate of fall [s]     limit  rate of fall [1/s]     T_f  time of smoothing [s]

Source: thesis section 3.5.1 and table 5.1: a PI controller whose gain grows towards the surge line, with "a damping
like functionality" in the gain when "gradients" reach "a given limit".  The thesis prints neither the forms nor their
numbers; forms, margin 1.18, boost 10 and the numbers of the gradient action are engineering choices.
The gradient action only works inside the margin (e > 0).  An ordinary derivative would answer to every slip of a
sticky valve, far from surge; this one lets the plant's oscillations pass.  To a fast change of q it is a proportional
gain of K_p gradient e/T_f, so a short T_f makes the loop through the compressor ring.
Conditional integration, as in the level and pressure loops, would leave the integral where it was when the valve
shut: the valve then hovers at its limit with every ripple of the flow, far from surge.  Hence back-calculation.
Valid for a corrected flow that is measured at once; not for: a flow element with noise or lag in front.
See also: compressor (ports q and q_s), pi.
"""

import math
from collections.abc import Mapping
from typing import Any

from stickslip.blocks.block import Floats, Kernels
from stickslip.blocks.limited_pi import LimitedController, limited, output_events
from stickslip.blocks.limits import limit_transition
from stickslip.blocks.pi import check_tuning
from stickslip.blocks.ports import Port, require

# p = K_p, T_i, low, high, T_t, action (as limited_pi), margin, boost, and with gradient action: gradient, limit, T_f
# x = z, and with gradient action: f


def _weighted(u: Any, p: Any) -> float:
    """Return E."""
    e: float = p[6] * u[1] - u[0]
    E: float = (1.0 + p[7] * max(0.0, e)) * e
    return E


def _steep(x: Any, u: Any, p: Any) -> float:
    """Return E with gradient action."""
    e: float = p[6] * u[1] - u[0]
    fall: float = max(0.0, (x[1] - u[0]) / p[10] - p[9])
    E: float = (1.0 + p[7] * max(0.0, e)) * e + p[8] * fall * max(0.0, e)
    return E


def _rate(E: float, x: Any, d: Any, p: Any) -> float:
    """Return dz/dt."""
    if d[0] == 0.0:
        rate: float = p[0] * E / p[1]
        return rate
    back: float = ((p[3] if d[0] > 0.0 else p[2]) - x[0]) / p[1]
    return back


def _surge_out(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    y[0] = limited(_weighted(u, p), x[0], p)


def _surge_der(t: float, x: Any, d: Any, u: Any, p: Any, dx: Any) -> None:
    dx[0] = _rate(_weighted(u, p), x, d, p)


def _surge_zc(t: float, x: Any, d: Any, u: Any, p: Any, g: Any) -> None:
    output_events(t, x, d, (_weighted(u, p), 0.0), p, g)


def _steep_out(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    y[0] = limited(_steep(x, u, p), x[0], p)


def _steep_der(t: float, x: Any, d: Any, u: Any, p: Any, dx: Any) -> None:
    dx[0] = _rate(_steep(x, u, p), x, d, p)
    dx[1] = (u[0] - x[1]) / p[10]


def _steep_zc(t: float, x: Any, d: Any, u: Any, p: Any, g: Any) -> None:
    output_events(t, x, d, (_steep(x, u, p), 0.0), p, g)


_SURGE = Kernels(out=_surge_out, der=_surge_der, zc=_surge_zc, jump=limit_transition, n_events=2)
_STEEP = Kernels(out=_steep_out, der=_steep_der, zc=_steep_zc, jump=limit_transition, n_events=2)


class AntiSurge(LimitedController):
    """Anti-surge controller; ``K_p`` and ``T_i`` of thesis table 5.1: 0.22 and 3 s (C2), 0.53 and 12 s (C3).

    ``start``: the integral part at the start, which is the opening if q is then at its set point.  ``gradient`` [s], 0
    for none; ``start_flow``: q at the start, with which the smoothing begins (needed with gradient action only).
    Raises ``BlockError`` unless K_p > 0, T_i > 0, margin >= 1, boost, gradient and limit >= 0, T_f > 0.

    >>> asc = AntiSurge(0.22, 3.0)
    >>> [round(float(asc.output(0.0, asc.x0, [q, 0.56])[0]), 4) for q in (0.8, 0.6608, 0.56, 0.0)]
    [0.0, 0.0, 0.0445, 1.0]
    >>> steep = AntiSurge(0.22, 3.0, gradient=1500.0, start_flow=0.65)
    >>> [round(float(steep.output(0.0, [0.0, f], [0.64, 0.56])[0]), 4) for f in (0.64, 0.66, 0.7)]
    [0.0055, 0.0398, 0.1771]
    """

    plays = {"PV": "q"}
    ports_in = (Port("q"), Port("q_s"))
    ports_out = (Port("OP"),)

    def __init__(
        self,
        K_p: float = 0.22,
        T_i: float = 3.0,
        *,
        margin: float = 1.18,
        boost: float = 10.0,
        gradient: float = 0.0,
        limit: float = 0.005,
        T_f: float = 2.0,
        start: float = 0.0,
        start_flow: float = 0.0,
        name: str = "anti_surge",
        **labels: Any,
    ) -> None:
        params = {"K_p": K_p, "T_i": T_i, "low": 0.0, "high": 1.0, "T_t": 0.0, "action": 1.0}
        params |= {"margin": margin, "boost": boost}
        states = {"z": start}
        self.kernels = _SURGE
        if gradient != 0.0:  # without it nothing is smoothed, and the block has no second state
            self.kernels = _STEEP
            params |= {"gradient": gradient, "limit": limit, "T_f": T_f}
            states["f"] = start_flow
        super().__init__(
            name=name,
            params=params,
            states=states,
            memory={"mode": 0.0},
            spans={"OP": (0.0, 1.0)} | labels.pop("spans", {}),
            **labels,
        )

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` unless the tuning makes sense, margin >= 1, boost, gradient, limit >= 0, T_f > 0."""
        check_tuning(params, name)
        margin = float(params["margin"])
        require(margin >= 1.0, name, "margin", margin, "the set point lies on the safe side of surge", "give 1.1 or so")
        for key, rule in (
            ("boost", "the gain must not fall towards surge"),
            ("gradient", "the gain must not fall with a falling flow"),
            ("limit", "it is a rate of fall"),
        ):
            value = float(params.get(key, 0.0))
            require(0.0 <= value < math.inf, name, key, value, rule, "give 0 or more")
        T_f = float(params.get("T_f", 1.0))
        require(0.0 < T_f < math.inf, name, "T_f", T_f, "a time of smoothing is positive", "2 s is usual")

    def unlimited(self, x: Floats, u: Floats) -> float:
        """Return v = K_p E + z."""
        E = _steep(x, u, self._p_now) if self.kernels is _STEEP else _weighted(u, self._p_now)
        return float(self._p_now[0] * E + x[0])

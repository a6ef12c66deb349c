"""Anti-surge controller: opens the recycle valve when the flow comes near the surge line, faster the nearer.

    e  = margin q_s - q                      shortage of flow
    E  = (1 + boost max(0, e)) e             nonlinear gain: grows inside the margin
    v  = K_p E + z,   OP = v limited to 0 ... 1
    dz/dt = (OP - z)/T_i                     at a limit: K_p E/T_i + (OP - v)/T_t with T_t = T_i
    dz/dt = K_p E/T_i                        between the limits

in   q    corrected flow through the compressor [-]       q_s  corrected flow at the surge line [-]
out  OP   opening of the recycle valve [fraction]
K_p  gain [-]     T_i  integral time [s]     margin  set point over surge flow [-], > 1     boost  [-], >= 0

Source: thesis section 3.5.1 (a PI controller whose gain grows towards the surge line) and table 5.1; the form of
the gain and the margin 1.18 are engineering choices.  The thesis's extra action on fast gradients is left out.
Conditional integration, as in the level and pressure loops, would leave the integral where it was when the valve
shut: the valve then hovers at its limit with every ripple of the flow, far from surge.  Hence back-calculation.
Valid for a corrected flow that is measured at once; not for: a flow element with noise or lag in front.
See also: compressor (ports q and q_s), pi.
"""

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from blocks.block import Block, Floats, Kernels
from blocks.pi import PI, _out, _plain_jump, _plain_zc
from blocks.ports import Port, require

# p = K_p, T_i, low, high, T_t, action (as pi), margin, boost


def _weighted(u: Any, p: Any) -> float:
    """Return E."""
    e: float = p[6] * u[1] - u[0]
    E: float = (1.0 + p[7] * max(0.0, e)) * e
    return E


def _surge_out(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    _out(t, x, d, (_weighted(u, p), 0.0), p, y)


def _surge_der(t: float, x: Any, d: Any, u: Any, p: Any, dx: Any) -> None:
    if d[0] == 0.0:
        dx[0] = p[0] * _weighted(u, p) / p[1]
    else:
        dx[0] = ((p[3] if d[0] > 0.0 else p[2]) - x[0]) / p[1]


def _surge_zc(t: float, x: Any, d: Any, u: Any, p: Any, g: Any) -> None:
    _plain_zc(t, x, d, (_weighted(u, p), 0.0), p, g)


class AntiSurge(Block):
    """Anti-surge controller; ``K_p`` and ``T_i`` of thesis table 5.1: 0.22 and 3 s (C2), 0.53 and 12 s (C3).

    ``start``: the integral part at the start, which is the opening if q is then at its set point.
    Raises ``BlockError`` unless K_p > 0, T_i > 0, margin >= 1 and boost >= 0.

    >>> asc = AntiSurge(0.22, 3.0)
    >>> [round(float(asc.output(0.0, asc.x0, [q, 0.56])[0]), 4) for q in (0.8, 0.6608, 0.56, 0.0)]
    [0.0, 0.0, 0.0445, 1.0]
    """

    ports_in = (Port("q"), Port("q_s"))
    ports_out = (Port("OP"),)
    kernels = Kernels(out=_surge_out, der=_surge_der, zc=_surge_zc, jump=_plain_jump, n_events=2)
    modes = {"free": 0.0, "at high limit": 1.0, "at low limit": -1.0}

    def __init__(
        self,
        K_p: float = 0.22,
        T_i: float = 3.0,
        *,
        margin: float = 1.18,
        boost: float = 10.0,
        start: float = 0.0,
        name: str = "anti_surge",
        **labels: Any,
    ) -> None:
        params = {"K_p": K_p, "T_i": T_i, "low": 0.0, "high": 1.0, "T_t": 0.0, "action": 1.0}
        super().__init__(
            name=name,
            params=params | {"margin": margin, "boost": boost},
            states={"z": start},
            memory={"mode": 0.0},
            spans={"OP": (0.0, 1.0)} | labels.pop("spans", {}),
            **labels,
        )

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` unless K_p > 0, T_i > 0, margin >= 1 and boost >= 0."""
        PI.check(params, name)
        margin, boost = float(params["margin"]), float(params["boost"])
        require(margin >= 1.0, name, "margin", margin, "the set point lies on the safe side of surge", "give 1.1 or so")
        require(0.0 <= boost < math.inf, name, "boost", boost, "the gain must not fall towards surge", "give 0 or more")

    def _seen(self, x: Floats, u: Floats) -> Floats:
        """Return the memory with the mode that the present values call for (python-control knows no events)."""
        E = _weighted(u, self._p_now)
        v = self._p_now[0] * E + x[0]
        return np.array([1.0 if v > self._p_now[3] else -1.0 if v < self._p_now[2] else 0.0])

    def _rhs(self, t: float, x: Floats, u: Floats) -> Floats:
        rates = np.zeros(1)
        _surge_der(t, x, self._seen(x, u), u, self._p_now, rates)
        return rates

    def _out(self, t: float, x: Floats, u: Floats) -> Floats:
        y = np.zeros(1)
        _surge_out(t, x, self._seen(x, u), u, self._p_now, y)
        return y

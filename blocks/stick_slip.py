"""The stem of a control valve with static and dynamic friction, mass included.

    M dv/dt = k (OP - x) + F_f,   dx/dt = v
    F_f = -F_c sgn(v) - F_v v     while the stem slides
    F_f = -k (OP - x)             while it is stuck; it breaks away when |k (OP - x)| > F_s
    (thesis eqs. 4.4 and 4.5, pages with section 4.2.3; seat and fluid forces left out, as there)

in   OP  controller output [fraction of span]        out  MV  stem position [fraction of travel]
x    position [fraction of travel]                   v    speed [travel/s]
k    spring, and actuator force per unit of OP [N per travel]     M    moving mass [kg, one travel = 1 m]
F_v  viscous friction [N s per travel]               F_c, F_s  Coulomb and static friction [N], F_s >= F_c
low, high  end stops [fraction of travel]; -inf and inf lift them
v_stop     a stem slower than this that comes to rest sticks, where it would creep to [travel/s].  The equations let an
           overdamped stem only ever approach rest while OP is held, as it is between the scans of a controller; a stem
           that has stuck needs F_s to move again, one that creeps only F_c, so that with 0 rounding would decide
           whether a loop cycles.  In a plant it sticks: the default, 1e-6, is slower than any stem is seen to move
           (a travel in 12 days), and moves where it rests by F_v v_stop/k = 1e-8 of travel at most.  It comes to rest,
           and does not just follow a slow OP, where M |dv/dt| > min(k M/F_v, F_v) |v|/2; it then stands at
           OP -+ F_c/k if the spring still pulls with more than F_c, else where it is

What the MV-OP figure of the block shows (all in fractions of OP):
    J = (F_s - F_c)/k        jump when it breaks away
    S = (F_s + F_c)/k        movement of OP after a reversal until it breaks away
    deadband = 2 F_c/k = S - J

Reading of eq. 4.5: its third branch only says in which direction the stem starts, so at v = 0 the sign of v is
that of the spring force, and F_c, not F_s, acts from then on.  Mode "ideal" is the stem without Coulomb and static
friction and without stops, M x'' = k (OP - x) - F_v v; no event leaves it, so it is what to linearise.  A stem
that meets a stop rests there (stuck) until the spring pulls it away with more than F_s.

Valid for a spring-opposed actuator without positioner.  Not for: Stribeck effect, creep, seat load.
See also: quasi_static_stem (the same without mass), stribeck_stem, lugre_stem (other laws of friction),
kano_valve and its siblings (sampled two-band models).
"""

import math
from collections.abc import Mapping
from typing import Any, Self

from blocks.block import Block, Kernels
from blocks.ports import Port, number, require
from blocks.quasi_static_stem import DOWN, IDEAL, STUCK, UP, QuasiStaticStem, check_stops, started_between
from blocks.role import Role
from blocks.rules import not_negative, positive

TIE = 1e-6  # with F_s = F_c a stem comes to rest exactly at breakaway, where rounding would start it again and again;
NOISE = 1e-9  # so it breaks away only with this share more, and with a spring force of this share of travel if F_s is 0
V_STOP = 1e-6


def slack(k: float, M: float, F_v: float) -> float:
    """Return half the force per speed that the inertia of a stem needs which comes to rest under a held OP."""
    return min(0.5 * k * M / F_v, 0.5 * F_v) if F_v > 0.0 else 0.0


def _out(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    y[0] = x[0]


def _der(t: float, x: Any, d: Any, u: Any, p: Any, dx: Any) -> None:
    if d[0] == STUCK:
        dx[0] = 0.0
        dx[1] = 0.0
    else:
        coulomb = 0.0 if d[0] == IDEAL else p[3] * d[0]
        dx[0] = x[1]
        dx[1] = (p[0] * (u[0] - x[0]) - coulomb - p[2] * x[1]) / p[1]


def _zc(t: float, x: Any, d: Any, u: Any, p: Any, g: Any) -> None:
    spring = p[0] * (u[0] - x[0])
    g[0] = -1.0
    g[1] = -1.0
    if d[0] == STUCK:  # away from a stop only
        breakaway = max(p[4], p[3] + max(TIE * p[3], NOISE * p[0]))
        if spring > 0.0:
            g[0] = spring - breakaway if x[0] < p[6] else -1.0
        else:
            g[0] = -spring - breakaway if x[0] > p[5] else -1.0
    elif d[0] != IDEAL:
        forward = d[0] * x[1]
        braking = d[0] * spring < p[3] + (p[2] - slack(p[0], p[1], p[2])) * forward  # not one that follows a slow OP
        g[0] = (p[7] if braking else 0.0) - forward
        g[1] = x[0] - p[6] if d[0] == UP else p[5] - x[0]


def _jump(t: float, x: Any, d: Any, u: Any, p: Any, k: Any) -> None:
    if d[0] == STUCK:
        d[0] = UP if u[0] > x[0] else DOWN
    else:
        if k[0] == 1.0:
            x[0] = p[6] if d[0] == UP else p[5]
        elif d[0] * p[0] * (u[0] - x[0]) > p[3]:  # it would creep on, to where spring and Coulomb friction balance
            x[0] = min(max(u[0] - d[0] * p[3] / p[0], p[5]), p[6])
        d[0] = STUCK
    x[1] = 0.0


class StickSlip(Block):
    """A valve stem with stiction; defaults are the thesis's high stiction (table A.1: 0, 1 and 2 % jump).

    ``StickSlip.none()``, ``.normal()`` and ``.high()`` have F_s = 1250, 1750 and 2250 N; ``none`` still has the
    deadband of its Coulomb friction.  Raises ``BlockError`` for parameters no valve can have.

    ``start``: where the stem rests at the start [fraction of travel].

    >>> valve = StickSlip.high()
    >>> round(100 * valve.J, 2), round(100 * valve.S, 2), round(100 * valve.deadband, 2)
    (1.9, 6.67, 4.76)
    >>> from diagram import drive
    >>> drive(valve, 1.0, every=1.0, OP=0.04).log["MV"].round(4).tolist()  # 2100 N: stuck
    [0.0, 0.0]
    >>> drive(valve, 1.0, every=1.0, OP=0.05).log["MV"].round(4).tolist()  # 2625 N: slips to OP - F_c/k
    [0.0, 0.0262]
    """

    role = Role.VALVE
    ports_in = (Port("OP"),)
    ports_out = (Port("MV"),)
    kernels = Kernels(out=_out, der=_der, zc=_zc, jump=_jump, n_events=2, feeds=False, linear=True)
    modes = QuasiStaticStem.modes
    limit_params = ("low", "high")

    def __init__(
        self,
        F_s: float = 2250.0,
        F_c: float = 1250.0,
        *,
        k: float = 52500.0,
        M: float = 1.36,
        F_v: float = 612.0,
        low: float = 0.0,
        high: float = 1.0,
        v_stop: float = V_STOP,
        start: float = 0.0,
        name: str = "valve",
        **labels: Any,
    ) -> None:
        started_between(low, high, start, name)
        super().__init__(
            name=name,
            params={"k": k, "M": M, "F_v": F_v, "F_c": F_c, "F_s": F_s, "low": low, "high": high, "v_stop": v_stop},
            states={"x": start, "v": 0.0},
            memory={"mode": STUCK},
            **labels,
        )

    @classmethod
    def none(cls, **keywords: Any) -> Self:
        """Return the stem with F_s = F_c = 1250 N: a deadband of 4.76 % and no jump."""
        return cls(1250.0, **keywords)

    @classmethod
    def normal(cls, **keywords: Any) -> Self:
        """Return the stem with F_s = 1750 N: a jump of 0.95 %."""
        return cls(1750.0, **keywords)

    @classmethod
    def high(cls, **keywords: Any) -> Self:
        """Return the stem with F_s = 2250 N: a jump of 1.9 %."""
        return cls(2250.0, **keywords)

    @classmethod
    def from_bands(cls, S: float, J: float, *, k: float = 52500.0, **keywords: Any) -> Self:
        """Return the stem whose MV-OP figure has the bands ``S`` and ``J`` [fraction of OP]: F_s, F_c = k (S +- J)/2.

        Raises ``BlockError`` unless 0 <= J <= S.

        >>> StickSlip.from_bands(S=0.06, J=0.02).p[3:5].round(9).tolist()
        [1050.0, 2100.0]
        """
        name = str(keywords.get("name", "valve"))
        S, J, k = number(name, "S", S), number(name, "J", J), number(name, "k", k)
        require(0.0 <= J <= S, name, "J", J, f"0 <= J <= S = {S} is needed", "a jump is part of S; lower J or raise S")
        return cls(k * (S + J) / 2.0, k * (S - J) / 2.0, k=k, **keywords)

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` unless k, M > 0, F_v, v_stop >= 0, F_s >= F_c >= 0 and low < high."""
        positive(params, name, "k", "M", remedy="give a positive one")
        not_negative(params, name, "F_v", "v_stop")
        check_friction(params, name)
        check_stops(params, name)

    # --- what the MV-OP figure shows ------------------------------------------------------------------------
    def _value(self, key: str) -> float:
        return float(self.p[self.param_index(key)])

    @property
    def J(self) -> float:
        """Slip jump (F_s - F_c)/k [fraction of OP]."""
        return (self._value("F_s") - self._value("F_c")) / self._value("k")

    @property
    def S(self) -> float:
        """Deadband plus stickband (F_s + F_c)/k [fraction of OP]."""
        return (self._value("F_s") + self._value("F_c")) / self._value("k")

    @property
    def deadband(self) -> float:
        """Deadband 2 F_c/k = S - J [fraction of OP]."""
        return 2.0 * self._value("F_c") / self._value("k")

    def quasi_static(self) -> QuasiStaticStem:
        """Return the same stem without mass, under the same name and labels."""
        return QuasiStaticStem(
            self.S,
            self.J,
            low=self._value("low"),
            high=self._value("high"),
            start=float(self.x0[0]),
            name=self.name,
            inputs=list(self.input_labels),
            outputs=list(self.output_labels),
            units=self.units,
            spans=self.spans,
        )


def check_friction(params: Mapping[str, float], name: str) -> None:
    """Raise ``BlockError`` unless F_s >= F_c >= 0, both finite."""
    not_negative(params, name, "F_c")
    F_s, F_c = float(params["F_s"]), float(params["F_c"])
    rule = f"static friction is at least the Coulomb friction, F_s >= F_c = {F_c}"
    require(F_c <= F_s < math.inf, name, "F_s", F_s, rule, "raise F_s or lower F_c")

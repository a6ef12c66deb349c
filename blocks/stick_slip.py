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

from collections.abc import Mapping
from typing import Any, Self

from stickslip.blocks.block import Kernels
from stickslip.blocks.ports import number, require
from stickslip.blocks.quasi_static_stem import QuasiStaticStem
from stickslip.blocks.rules import not_negative
from stickslip.blocks.seen_stem import DOWN, IDEAL, STUCK, UP
from stickslip.blocks.stem_with_mass import StemWithMass

TIE = 1e-6  # with F_s = F_c a stem comes to rest exactly at breakaway, where rounding would start it again and again;
NOISE = 1e-9  # so it breaks away only with this share more, and with a spring force of this share of travel if F_s is 0
V_STOP = 1e-6


def slack(k: float, M: float, F_v: float) -> float:
    """Return half the force per speed that the inertia of a stem needs which comes to rest under a held OP."""
    return min(0.5 * k * M / F_v, 0.5 * F_v) if F_v > 0.0 else 0.0


def _out(x: float) -> float:
    return x


def _der(x: float, v: float, mode: float, OP: float, k: float, M: float, F_v: float, F_c: float) -> tuple[float, float]:
    if mode == STUCK:
        return 0.0, 0.0
    coulomb = 0.0 if mode == IDEAL else F_c * mode
    return v, (k * (OP - x) - coulomb - F_v * v) / M


def _zc(
    x: float, v: float, mode: float, OP: float,
    k: float, M: float, F_v: float, F_c: float, F_s: float, low: float, high: float, v_stop: float,
) -> tuple[float, float]:  # fmt: skip
    spring = k * (OP - x)
    if mode == IDEAL:
        return -1.0, -1.0
    if mode == STUCK:  # away from a stop only
        breakaway = max(F_s, F_c + max(TIE * F_c, NOISE * k))
        free = x < high if spring > 0.0 else x > low
        return (abs(spring) - breakaway if free else -1.0), -1.0
    forward = mode * v
    braking = mode * spring < F_c + (F_v - slack(k, M, F_v)) * forward  # not one that follows a slow OP
    return (v_stop if braking else 0.0) - forward, (x - high if mode == UP else low - x)


def _jump(
    event: float, x: float, mode: float, OP: float, k: float, F_c: float, low: float, high: float
) -> tuple[float, float, float]:
    if mode == STUCK:
        return (UP if x < OP else DOWN), x, 0.0
    if event == 1.0:
        x = high if mode == UP else low
    elif mode * k * (OP - x) > F_c:  # it would creep on, to where spring and Coulomb friction balance
        x = min(max(OP - mode * F_c / k, low), high)
    return STUCK, x, 0.0


class StickSlip(StemWithMass):
    """A valve stem with stiction; defaults are the thesis's high stiction (table A.1: 0, 1 and 2 % jump).

    ``StickSlip.none()``, ``.normal()`` and ``.high()`` have F_s = 1250, 1750 and 2250 N; ``none`` still has the
    deadband of its Coulomb friction.  Raises ``BlockError`` for parameters no valve can have.

    ``start``: where the stem rests at the start [fraction of travel].

    >>> valve = StickSlip.high()
    >>> round(100 * valve.J, 2), round(100 * valve.S, 2), round(100 * valve.deadband, 2)
    (1.9, 6.67, 4.76)
    >>> from stickslip.diagram import drive
    >>> drive(valve, 1.0, every=1.0, OP=0.04).log["MV"].round(4).tolist()  # 2100 N: stuck
    [0.0, 0.0]
    >>> drive(valve, 1.0, every=1.0, OP=0.05).log["MV"].round(4).tolist()  # 2625 N: slips to OP - F_c/k
    [0.0, 0.0262]
    """

    kernels = Kernels(out=_out, der=_der, zc=_zc, jump=_jump, n_events=2, linear=True)
    modes = QuasiStaticStem.modes

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
        super().__init__(
            F_s, F_c, {"v_stop": v_stop}, k=k, M=M, F_v=F_v, low=low, high=high, start=start, name=name, **labels
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
        StemWithMass.check(params, name)
        not_negative(params, name, "v_stop")

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

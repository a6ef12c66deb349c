"""The stem of a control valve whose friction falls with speed: the Stribeck effect, mass included.

    M dv/dt = k (OP - x) - F(v),   dx/dt = v
    F(v) = sgn(v) (F_c + (F_s - F_c) exp(-(|v|/v_s)^delta)) + F_v v      while the stem slides     (1)
    F    = k (OP - x)                                                    while it is stuck
    it breaks away when |k (OP - x)| > F_s, and sticks when v comes back to 0

in   OP  controller output [fraction of span]        out  MV  stem position [fraction of travel]
x    position [fraction of travel]                   v    speed [travel/s]
k    spring, and actuator force per unit of OP [N per travel], > 0     M    moving mass [kg, one travel = 1 m], > 0
F_v  viscous friction [N s per travel], >= 0         F_c, F_s  Coulomb and static friction [N], F_s >= F_c >= 0
v_s  Stribeck speed: where most of F_s - F_c is lost [travel/s], > 0   delta  shape [-], > 0; 2 Gaussian, 1 exponential
low, high  end stops [fraction of travel]; -inf and inf lift them; start  position at the start [fraction of travel]

Friction is continuous at v = 0+, so the stem takes a moment to start and stops in a finite time, with F_s; a
stick-slip stem goes over to F_c at once, and with F_v creeps to rest.  As v_s -> 0 this stem becomes that one.
Sliding is unstable below the speed where F'(v) = 0: there a slow ramp of OP gives stick-slip, above it smooth motion.
Breakaway and standstill are located; breakaway waits for F_s plus a millionth, so that the stem does start.
Mode "ideal" is the stem without dry friction and stops, to linearise.
Valid for a spring-opposed actuator without positioner.  Not for: creep and elastic displacement before breakaway.

Source: eq. 1 is the exponential model in Armstrong-Helouvry, Dupont and Canudas de Wit, Automatica 30(7), 1994, pp.
1083-1138, and Olsson et al., European Journal of Control 4, 1998, pp. 176-195; stem and spring: thesis table A.1.
See also: stick_slip (v_s = 0), lugre_stem (bristles, elastic before breakaway).
"""

import math
from collections.abc import Mapping
from typing import Any

from stickslip.blocks.block import Kernels
from stickslip.blocks.rules import positive
from stickslip.blocks.seen_stem import DOWN, IDEAL, STUCK, UP
from stickslip.blocks.stem_with_mass import StemWithMass
from stickslip.blocks.stick_slip import TIE, StickSlip


def stribeck(speed: float, F_c: float, F_s: float, v_s: float, delta: float) -> float:
    """Return the dry friction [N] at ``speed`` >= 0 [travel/s]: F_s at standstill, F_c far beyond v_s."""
    if speed <= 0.0:
        return F_s
    return F_c + (F_s - F_c) * math.exp(-((speed / v_s) ** delta))


def _out(x: float) -> float:
    return x


def _der(
    x: float, v: float, mode: float, OP: float,
    k: float, M: float, F_v: float, F_c: float, F_s: float, v_s: float, delta: float,
) -> tuple[float, float]:  # fmt: skip
    if mode == STUCK:
        return 0.0, 0.0
    dry = 0.0 if mode == IDEAL else mode * stribeck(mode * v, F_c, F_s, v_s, delta)
    return v, (k * (OP - x) - dry - F_v * v) / M


def _zc(
    x: float, v: float, mode: float, OP: float, k: float, F_s: float, low: float, high: float
) -> tuple[float, float]:
    if mode == IDEAL:
        return -1.0, -1.0
    if mode == STUCK:  # away from a stop only
        spring = k * (OP - x)
        free = x < high if spring > 0.0 else x > low
        return (abs(spring) - F_s * (1.0 + TIE) if free else -1.0), -1.0
    return -mode * v, (x - high if mode == UP else low - x)


def _jump(event: float, x: float, mode: float, OP: float, low: float, high: float) -> tuple[float, float, float]:
    if mode == STUCK:
        return (UP if x < OP else DOWN), x, 0.0
    if event == 1.0:
        x = high if mode == UP else low
    return STUCK, x, 0.0  # where it stands: at rest friction is F_s, so it does not creep on


class StribeckStem(StemWithMass):
    """A valve stem with Stribeck friction; spring, mass and forces default to the thesis's high stiction.

    ``v_s`` [travel/s] is the Stribeck speed, ``delta`` the shape; F_s, F_c [N] and ``stem`` (k, M, F_v, low, high,
    start, name and labels) are as in ``StickSlip``.  Raises ``BlockError`` for parameters no valve can have.

    >>> from stickslip.diagram import drive
    >>> valve = StribeckStem(v_s=0.01)
    >>> round(valve.friction(0.0)), round(valve.friction(0.01)), round(valve.friction(0.1))  # N
    (2250, 1624, 1311)
    >>> drive(valve, 1.0, every=1.0, OP=0.05).log["MV"].round(4).tolist()  # 2625 N: slips and stops
    [0.0, 0.026]
    """

    kernels = Kernels(out=_out, der=_der, zc=_zc, jump=_jump, n_events=2)
    modes = StickSlip.modes

    def __init__(
        self,
        F_s: float = 2250.0,
        F_c: float = 1250.0,
        *,
        v_s: float = 1e-3,
        delta: float = 2.0,
        name: str = "valve",
        **stem: Any,
    ) -> None:
        super().__init__(F_s, F_c, {"v_s": v_s, "delta": delta}, name=name, **stem)

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` unless k, M, v_s, delta > 0, F_v >= 0, F_s >= F_c >= 0 and low < high."""
        StemWithMass.check(params, name)
        positive(params, name, "v_s", "delta", remedy="give a positive one")

    def friction(self, speed: float) -> float:
        """Return the friction F(v) [N] of a stem that slides at ``speed`` [travel/s]; at 0 that of a start upwards."""
        F_c, F_s, v_s, delta = (self.params[key] for key in ("F_c", "F_s", "v_s", "delta"))
        dry = stribeck(abs(speed), F_c, F_s, v_s, delta)
        return (dry if speed >= 0.0 else -dry) + self.params["F_v"] * speed

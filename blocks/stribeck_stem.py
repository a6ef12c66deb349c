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

from blocks.block import Block, Kernels
from blocks.ports import Port
from blocks.quasi_static_stem import DOWN, IDEAL, STUCK, UP, check_stops, started_between
from blocks.role import Role
from blocks.rules import not_negative, positive
from blocks.stick_slip import TIE, StickSlip, check_friction

# p = k, M, F_v, F_c, F_s, low, high, v_s, delta


def stribeck(speed: float, F_c: float, F_s: float, v_s: float, delta: float) -> float:
    """Return the dry friction [N] at ``speed`` >= 0 [travel/s]: F_s at standstill, F_c far beyond v_s."""
    if speed <= 0.0:
        return F_s
    return F_c + (F_s - F_c) * math.exp(-((speed / v_s) ** delta))


def _out(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    y[0] = x[0]


def _der(t: float, x: Any, d: Any, u: Any, p: Any, dx: Any) -> None:
    if d[0] == STUCK:
        dx[0] = 0.0
        dx[1] = 0.0
    else:
        dry = 0.0 if d[0] == IDEAL else d[0] * stribeck(d[0] * x[1], p[3], p[4], p[7], p[8])
        dx[0] = x[1]
        dx[1] = (p[0] * (u[0] - x[0]) - dry - p[2] * x[1]) / p[1]


def _zc(t: float, x: Any, d: Any, u: Any, p: Any, g: Any) -> None:
    g[0] = -1.0
    g[1] = -1.0
    if d[0] == STUCK:  # away from a stop only
        spring = p[0] * (u[0] - x[0])
        free = x[0] < p[6] if spring > 0.0 else x[0] > p[5]
        g[0] = abs(spring) - p[4] * (1.0 + TIE) if free else -1.0
    elif d[0] != IDEAL:
        g[0] = -d[0] * x[1]
        g[1] = x[0] - p[6] if d[0] == UP else p[5] - x[0]


def _jump(t: float, x: Any, d: Any, u: Any, p: Any, k: Any) -> None:
    if d[0] == STUCK:
        d[0] = UP if u[0] > x[0] else DOWN
    else:
        if k[0] == 1.0:
            x[0] = p[6] if d[0] == UP else p[5]
        d[0] = STUCK  # where it stands: at rest friction is F_s, so it does not creep on
    x[1] = 0.0


class StribeckStem(Block):
    """A valve stem with Stribeck friction; spring, mass and forces default to the thesis's high stiction.

    ``v_s`` [travel/s] is the Stribeck speed, ``delta`` the shape.  Raises ``BlockError`` for parameters no valve can
    have.

    >>> from diagram import drive
    >>> valve = StribeckStem(v_s=0.01)
    >>> round(valve.friction(0.0)), round(valve.friction(0.01)), round(valve.friction(0.1))  # N
    (2250, 1624, 1311)
    >>> drive(valve, 1.0, every=1.0, OP=0.05).log["MV"].round(4).tolist()  # 2625 N: slips and stops
    [0.0, 0.026]
    """

    role = Role.VALVE
    ports_in = (Port("OP"),)
    ports_out = (Port("MV"),)
    kernels = Kernels(out=_out, der=_der, zc=_zc, jump=_jump, n_events=2, feeds=False)
    modes = StickSlip.modes

    def __init__(
        self,
        F_s: float = 2250.0,
        F_c: float = 1250.0,
        *,
        v_s: float = 1e-3,
        delta: float = 2.0,
        k: float = 52500.0,
        M: float = 1.36,
        F_v: float = 612.0,
        low: float = 0.0,
        high: float = 1.0,
        start: float = 0.0,
        name: str = "valve",
        **labels: Any,
    ) -> None:
        started_between(low, high, start, name)
        forces = {"k": k, "M": M, "F_v": F_v, "F_c": F_c, "F_s": F_s}
        super().__init__(
            name=name,
            params=forces | {"low": low, "high": high, "v_s": v_s, "delta": delta},
            states={"x": start, "v": 0.0},
            memory={"mode": STUCK},
            **labels,
        )

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` unless k, M, v_s, delta > 0, F_v >= 0, F_s >= F_c >= 0 and low < high."""
        positive(params, name, "k", "M", "v_s", "delta", remedy="give a positive one")
        not_negative(params, name, "F_v")
        check_friction(params, name)
        check_stops(params, name)

    def friction(self, speed: float) -> float:
        """Return the friction F(v) [N] of a stem that slides at ``speed`` [travel/s]; at 0 that of a start upwards."""
        p = self.p
        dry = stribeck(abs(speed), p[3], p[4], p[7], p[8])
        return float((dry if speed >= 0.0 else -dry) + p[2] * speed)

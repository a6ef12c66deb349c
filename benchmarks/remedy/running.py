"""A hidden loop with its remedies, from their equations, in steps of ``h`` seconds: nothing of it is the fit's.

    stem  one of the laws of ``stickslip.calibration.crossed.stems``, behind an actuator that lags
    flow  x (1 + bend x / 100) + load                                          x, load in % of OP
    T_1 dy_1/dt = K flow - y_1, or dy_1/dt = K flow;   T_2 dy_2/dt = y_1 - y_2;   T_3 dy_3/dt = y_2 - y_3
    PV = y_3(t - theta) + noise, read at each scan

The law -1 is LuGre's, with stiff and damped bristles:  M dv/dt = air - x - sigma_0 z - sigma_1 dz/dt - F_v v,
dz/dt = v - sigma_0 |v| z / g(v),  g(v) = f_d + (f_s - f_d) exp(-(v/v_s)^2)   (Canudas de Wit et al. 1995).
Laws below -1 move at a scan (``sampled_stems``), and what they drive lags as the actuator does.

Values are deviations from rest.  Between controller and valve stand the remedies, as their sources have them: a gap and
a zone of the error, pulses, a constant in OP's way, two moves.
"""

import math
from typing import Any, NamedTuple

from stickslip.calibration.crossed.stems import moved
from stickslip.logs.compiled import njit

from benchmarks.remedy.sampled_stems import at_scan


class Numbers(NamedTuple):
    """All numbers of a run; ``settings`` are the controller's and the remedies'."""

    h: float
    scan: int  # steps between two scans
    law: int
    S: float
    J: float
    air: float  # lag of the actuator [s]
    mass: float
    bend: float
    K: float
    T_1: float  # 0: the process integrates
    T_2: float
    T_3: float
    theta: float
    late_integral: bool  # the integral takes in the error of the last scan


class Settings(NamedTuple):
    """The controller and what stands behind it; pulses and moves are off at 0."""

    K_p: float
    T_i: float
    gap: float = 0.0
    zone: float = 0.0
    pulse: float = 0.0
    period: int = 5  # scans
    width: int = 2  # scans
    push: float = 0.0
    hold: float = 0.0
    move_S: float = 0.0
    move_J: float = 0.0
    band: float = math.inf
    pause: int = 1  # scans


@njit(cache=True)  # type: ignore[untyped-decorator]
def _lugre(s: Any, op: float, h: float, S: float, J: float, lag: float, mass: float) -> None:
    """Move a stem with bristles by one step: s[0] stem, s[1] speed, s[2] air, s[4] bristle."""
    s[2] += (op - s[2]) * (1.0 - math.exp(-h / lag))
    f_s, f_d = 0.5 * (S + J), 0.5 * (S - J)
    stiff = 50.0 * f_s / max(S, 1.0)
    g = f_d + (f_s - f_d) * math.exp(-((s[1] * lag / (0.05 * J)) ** 2))
    z = (s[4] + h * s[1]) / (1.0 + h * abs(s[1]) * stiff / g)
    bends = (z - s[4]) / h
    s[4] = z
    s[1] = (mass * s[1] + h * (s[2] - s[0] - stiff * z - math.sqrt(stiff * mass) * bends)) / (mass + h * 0.5 * lag)
    s[0] += h * s[1]


@njit(cache=True)  # type: ignore[untyped-decorator]
def run(n: Numbers, c: Settings, sp: Any, load: Any, noise: Any, out: Any) -> None:
    """Simulate; ``sp``, ``load``, ``noise`` (scans,), ``out`` (3, scans): PV, OP and stem at each scan."""
    s, late = [0.0] * 8, [0.0] * max(int(n.theta / n.h), 1)
    stem = [0.0] * 8
    stem[1] = 1.0
    if n.law == 0 or n.law == 5:
        s[1] = s[3] = 1.0  # it stands
    y_1 = y_2 = y_3 = total = 0.0
    head = 0
    # pulses: OP at the last one, its way; push: farthest OP, its way; moves: their state
    pulsed, pulse_way, since = 0.0, 0.0, 0
    far, way = 0.0, 0.0
    mode, shift, side, summed, count, waves, left, last_way, op = 0, 0.0, 0, 0.0, 0, 0, 0, 0.0, 0.0
    dt = n.h * n.scan
    for k in range(len(sp)):
        pv = late[head] + noise[k]
        e = sp[k] - pv
        beyond = math.copysign(max(abs(e) - c.gap, 0.0), e)
        gained = c.K_p * dt / c.T_i * beyond if abs(e) > c.zone else 0.0
        if n.late_integral:
            u = c.K_p * beyond + total
            total += gained
        else:
            total += gained
            u = c.K_p * beyond + total
        if c.pulse > 0.0:
            since += 1
            if since >= c.period:
                pulse_way = 0.0 if u == pulsed else math.copysign(1.0, u - pulsed)
                pulsed, since = u, 0
            pulse = c.pulse * pulse_way if since < c.width else 0.0
        else:
            pulse = 0.0
        u += pulse
        if c.push > 0.0:
            if way * (u - far) >= 0.0 and way != 0.0:
                far = u
            elif abs(u - far) > c.hold:
                way = math.copysign(1.0, u - far)
                far = u
            u += c.push * way
        if math.isinf(c.band):
            op = u
        else:
            left -= 1
            if mode == 2 and left <= 0 and abs(e) > c.band:
                mode, shift, side, summed, count, waves = 0, op - u, 0, 0.0, 0, 0
            if mode == 1 and left <= 0:
                op -= last_way * (c.move_S + 0.5 * (c.move_S - c.move_J))
                mode, left = 2, c.pause
            elif mode == 0:
                if u + shift != op:
                    last_way = math.copysign(1.0, u + shift - op)
                op = u + shift
                if side > 0:
                    summed += op
                    count += 1
                if side == 1 and e < -0.5 * c.band:
                    side = 2
                elif side != 1 and e > 0.5 * c.band:
                    waves += side == 2
                    if waves >= 2 and count > 0:
                        mode, left = 1, c.pause
                        op = summed / count + last_way * c.move_S
                    side, summed, count = 1, 0.0, 0
        if n.law < -1:
            at_scan(stem, op, n.law, n.S, n.J)
        for _ in range(n.scan):
            if n.law < -1:
                s[0] += (stem[0] - s[0]) * (1.0 - math.exp(-n.h / n.air))
            elif n.law < 0:
                _lugre(s, op, n.h, n.S, n.J, n.air, n.mass)
            else:
                moved(s, op, n.h, n.law, n.S, n.J, n.air, n.mass, 0)
            flow = n.K * (s[0] * (1.0 + n.bend * s[0] / 100.0) + load[k])
            y_1 += n.h * flow if n.T_1 <= 0.0 else (flow - y_1) * (1.0 - math.exp(-n.h / n.T_1))
            y_2 += (y_1 - y_2) * (1.0 - math.exp(-n.h / n.T_2))
            y_3 += (y_2 - y_3) * (1.0 - math.exp(-n.h / n.T_3))
            late[head] = y_3
            head = (head + 1) % len(late)
        out[0, k], out[1, k], out[2, k] = pv, op, s[0]

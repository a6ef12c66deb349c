"""One loop from its equations: controller, valve, process, sensor, and what moves them, in steps of ``h`` seconds.

    lag tau_1 dx/dt = K g(stem) + load - x,   tau_2 dy/dt = x(t - theta) - y;   a level has dx/dt = K g(stem) + load
    g(stem) = stem (1 + c stem / 100)                     a bent characteristic
    master: SP = SP_0 + K_m (e_2 + sum e_2 / T_m),   tau_m dy_2/dt = y - y_2 + its own load

All values are deviations from rest, in % of span; times in seconds.
"""

import math
from typing import Any, NamedTuple

import numpy as np
from stickslip.calibration.crossed.stems import moved
from stickslip.logs.compiled import njit

DRIVERS = ("nothing", "moving_sp", "periodic_sp", "master", "load", "neighbour", "tuning")
FORMS = ("position", "velocity", "pid")


class Numbers(NamedTuple):
    """All numbers of one loop."""

    h: float
    scan: int  # steps between two scans
    steps: int
    K: float
    tau_1: float  # 0: a level
    tau_2: float
    theta: float
    bend: float
    K_p: float
    T_i: float
    T_d: float
    form: int
    zone: float  # dead zone of the control error
    step_op: float  # resolution of OP in the velocity form
    filter: float  # of the transmitter [s]
    low: float
    high: float
    law: int
    S: float
    J: float
    air: float  # lag [s]
    mass: float
    positioner: int
    sticking: float  # of the sensor: width of its hysteresis
    noise: float
    driver: int
    size: float  # of what the driver moves
    time: float  # its period or time [s]
    shape: int  # sine, square, triangle
    wander: float  # of its period
    base: float  # of the disturbance that is always there
    push: float  # of the load in the first 20 scans, so that what can cycle does
    manual_from: float  # [s]
    manual_to: float


@njit(cache=True)  # type: ignore[untyped-decorator]
def _wave(shape: int, x: float) -> float:
    x -= math.floor(x)
    if shape == 0:
        return math.sin(2.0 * math.pi * x)
    if shape == 1:
        return 1.0 if x < 0.5 else -1.0
    return 4.0 * abs(x - 0.5) - 1.0


@njit(cache=True)  # type: ignore[untyped-decorator]
def run(r: Any, n: Numbers, every: int, out: Any) -> None:
    """Simulate with the random numbers of ``r``; ``out`` (4, rows): SP, PV, OP and stem at each ``every``-th step."""
    s = np.zeros(8)
    if n.law in (0, 5):
        s[1] = s[3] = 1.0  # it stands
    late = np.zeros(max(int(n.theta / n.h), 0) + 1)
    head = 0
    x = y = sp = op = shown = held = filtered = total = slope = 0.0
    coloured = coloured_2 = moved_to = y_2 = sum_2 = phase = 0.0
    before = 0.0
    phase = r.random()
    for k in range(n.steps):
        t = k * n.h
        load = 0.0
        if k % n.scan == 0:
            dt = n.h * n.scan
            a = math.exp(-dt / (3.0 * n.time + dt))
            coloured = a * coloured + math.sqrt(1.0 - a * a) * r.normal()
            b = math.exp(-dt / (0.3 * n.time + dt))
            coloured_2 = b * coloured_2 + math.sqrt(1.0 - b * b) * r.normal()
            phase += dt / n.time + n.wander * math.sqrt(dt / n.time) * r.normal()
            if r.random() < dt / (3.0 * n.time):
                moved_to = 2.0 * r.random() - 1.0
        load = n.base * coloured_2
        if k < 20 * n.scan:
            load += n.push
        if n.driver == 1:
            sp = n.size * moved_to
        elif n.driver == 2:
            sp = n.size * _wave(n.shape, phase)
        elif n.driver == 4:
            load += n.size * (coloured if n.shape < 2 else moved_to)
        elif n.driver == 5:
            load += n.size * _wave(n.shape, phase)
        elif n.driver == 3:
            y_2 += n.h / (2.0 * n.time) * (y + n.size * moved_to - y_2)
            if k % (4 * n.scan) == 0:
                e_2 = -y_2
                sum_2 += 4 * n.scan * n.h * e_2 / (3.0 * n.time)
                sp = min(max(0.8 * e_2 + 0.8 * sum_2, -60.0), 60.0)
        seen = y
        if n.sticking > 0.0:
            held = min(max(held, y - 0.5 * n.sticking), y + 0.5 * n.sticking)
            seen = held
        if k % n.scan == 0:
            shown = seen + n.noise * r.normal()
            part = 1.0 - math.exp(-n.h * n.scan / n.filter) if n.filter > 0.0 else 1.0
            last = filtered
            filtered += part * (shown - filtered)
            e = sp - filtered
            if abs(e) < n.zone:
                e = 0.0
            dt = n.h * n.scan
            if n.manual_from <= t < n.manual_to:
                total = op if n.form == 1 else op - n.K_p * e
            elif n.form == 1:
                d = n.K_p * (e - before + e * dt / n.T_i)
                total += d
                total = min(max(total, n.low), n.high)
                op = math.floor(total / n.step_op + 0.5) * n.step_op if n.step_op > 0.0 else total
            else:
                slope += (1.0 - math.exp(-8.0 * dt / n.T_d)) * (-(filtered - last) / dt - slope) if n.form == 2 else 0.0
                v = n.K_p * (e + n.T_d * slope) + total
                op = min(max(v, n.low), n.high)
                total += n.K_p * e * dt / n.T_i + min(1.0, dt / n.T_i) * (op - v)
            before = e
        moved(s, op, n.h, n.law, n.S, n.J, n.air, n.mass, n.positioner)
        s[0] = min(max(s[0], n.low - 5.0), n.high + 5.0)
        flow = n.K * s[0] * (1.0 + n.bend * s[0] / 100.0) + abs(n.K) * load
        if n.tau_1 > 0.0:
            x += (flow - x) * (1.0 - math.exp(-n.h / n.tau_1))
        else:
            x += n.h * flow
        late[head] = x
        head = (head + 1) % len(late)
        y += (late[head] - y) * (1.0 - math.exp(-n.h / n.tau_2))
        if k % every == 0 and k // every < out.shape[1]:
            row = k // every
            out[0, row], out[1, row], out[2, row], out[3, row] = sp, shown if n.filter <= 0.0 else filtered, op, s[0]

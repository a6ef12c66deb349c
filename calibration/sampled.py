"""The loops of the training law in exact sampled time: what the engine gives, thirty times as fast.

    x1 <- F + (x1 - F) exp(-1/tau1),   the second lag and the integrator by the same exact solution over one scan
    F   = MV of theta scans ago + load, held over a scan; a stem with mass moves in ``STEPS`` steps, F has its mean

A valve that creeps (``_creeping``) is here only: it sticks as Chen's does, but gives a little before it breaks away.
Controller, valve (Kano, Chen, He: sampled; stick_slip: a stem with mass and Coulomb friction), sensor and disturbances
are those of ``loops.diagram`` with a scan as the unit of time; random numbers are drawn from another generator, so
that with noise records agree in law, not value by value.  Structures that are not in ``VALVES`` and ``CONTROLLERS`` are
left to the engine.
"""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from stickslip.logs.arrays import Values
from stickslip.logs.compiled import njit

__all__ = ["CONTROLLERS", "SIGNALS", "VALVES", "run"]

VALVES = ("kano", "chen", "he", "stick_slip", "creeping")
CONTROLLERS = ("pi", "pi_filtered", "pid_weighted")
PROCESSES = ("one_lag", "two_lags", "integrating")
SIGNALS = ("SP", "PV_m", "OP", "MV")
STEPS = 24  # of a scan, for a stem with mass
LEAVES = 0.97  # of the force at which Dahl's friction would slide: there a creeping valve breaks away

_DRIVE = ("shape", "amplitude", "period", "slope", "sd", "correlation_time", "walk", "move", "hold", "wander", "swell",
          "second", "second_size")  # fmt: skip
_VALVE = {"kano": ("S", "J"), "chen": ("S", "J"), "he": ("f_s", "f_d"), "stick_slip": ("F_s", "F_c", "F_v", "M"),
          "creeping": ("S", "J", "give", "uneven", "lag")}  # fmt: skip


def run(
    structure: tuple[str, str, str], scans: int, columns: Sequence[Mapping[str, float]], seeds: Sequence[int],
    times: Values,
) -> dict[str, Values]:  # fmt: skip
    """Return SP, PV_m, OP and MV (n, rows) of n loops at ``times`` [scans], (rows,) or (n, rows), in ascending order.

    ``structure`` and the parameters in ``columns`` as in ``loops``; ``scans`` that each loop lasts.
    """
    valve, process, controller = structure
    at = np.broadcast_to(np.floor(times).astype(np.int64), (len(columns), np.shape(times)[-1]))
    out = np.empty((len(columns), len(SIGNALS), at.shape[1]))
    kinds = VALVES.index(valve), PROCESSES.index(process), CONTROLLERS.index(controller)
    for i, (own, seed) in enumerate(zip(columns, seeds, strict=True)):
        drives = np.array([[own.get(f"{on}.{key}", 0.0) for key in _DRIVE] for on in ("load", "SP")])
        friction = np.array([*(own[f"valve.{key}"] for key in _VALVE[valve]), 0.0, 0.0, 0.0])[:5]
        sensor = np.array([own.get(f"sensor.{key}", 0.0) for key in ("sd", "correlation_time", "step")])
        _loop(
            np.random.default_rng(seed), scans, kinds, drives, friction, _process(own, process),
            _controller(own, controller), sensor, own["F.w_MV"], own["controller.low"], own["controller.high"],
            at[i], out[i],
        )  # fmt: skip
    return {name: out[:, k] for k, name in enumerate(SIGNALS)}


def _process(own: Mapping[str, float], kind: str) -> Values:
    """Gain, both lags and the dead time [scans]."""
    theta, K = own["process.theta"], own["process.K"]
    if kind == "integrating":
        return np.array([K, own["lag.tau"], 0.0, theta])
    if kind == "one_lag":
        return np.array([K, own["process.tau"], 0.0, theta])
    zeta, root = own["process.zeta"], 1.0 / own["process.omega"]
    spread = math.sqrt(max(zeta**2 - 1.0, 1e-6))  # equal lags apart by a thousandth: the solution is for two
    return np.array([K, root * (zeta + spread), root * (zeta - spread), theta])


def _controller(own: Mapping[str, float], kind: str) -> Values:
    """K_p with its sign, T_i, T_d, N, b and the filter's time constant [scans]."""
    K_p = own["controller.K_p"] * own["controller.action"]
    values = [K_p, own["controller.T_i"], 0.0, 1.0, 1.0, 0.0]
    if kind == "pi_filtered":
        values[5] = own["filter.tau"]
    if kind == "pid_weighted":
        values[2:5] = [own["controller.T_d"], own["controller.N"], own["controller.b"]]
    return np.array(values)


@njit(cache=True, error_model="numpy")  # type: ignore[untyped-decorator]
def _wave(shape: float, x: float) -> float:
    """``excitation``'s waves."""
    x -= math.floor(x)
    if shape == 0.0:
        return math.sin(2.0 * math.pi * x)
    if shape == 1.0:
        return 1.0 if x < 0.5 else -1.0
    rise = 0.8 if shape == 2.0 else 0.5
    return 2.0 * x / rise - 1.0 if x < rise else 1.0 - 2.0 * (x - rise) / (1.0 - rise)


@njit(cache=True, error_model="numpy")  # type: ignore[untyped-decorator]
def _coloured(r: Any, before: float, time: float) -> Any:
    a = math.exp(-1.0 / time) if time > 0.0 else 0.0
    return a * before + math.sqrt(1.0 - a * a) * r.normal()


@njit(cache=True, error_model="numpy")  # type: ignore[untyped-decorator]
def _driven(r: Any, t: float, d: Any, kept: Any) -> Any:
    """One value of a disturbance d (``_DRIVE``) at scan t; ``kept``: noise, walk, level, phase and swell."""
    value = d[3] * t
    if d[1] != 0.0:
        if d[9] > 0.0:
            kept[3] += d[9] / math.sqrt(d[2]) * r.normal()
        if d[10] > 0.0:
            kept[4] = _coloured(r, kept[4], d[2])
        x = t / d[2] + kept[3]
        size = d[1] * math.exp(d[10] * kept[4])
        value += size * _wave(d[0], x)
        if d[12] > 0.0:
            value += size * d[12] * _wave(0.0, x / d[11])
    if d[4] > 0.0:
        kept[0] = _coloured(r, kept[0], d[5])
        value += d[4] * kept[0]
    if d[6] > 0.0:
        kept[1] += d[6] * r.normal()
    if d[7] > 0.0 and r.random() * d[8] < 1.0:
        kept[2] = d[7] * (2.0 * r.random() - 1.0)
    return value + kept[1] + kept[2]


@njit(cache=True, error_model="numpy")  # type: ignore[untyped-decorator]
def _stem(kind: int, op: float, low: float, high: float, f: Any, m: Any) -> None:
    """One sample of a sampled valve; m: MV, stuck, direction, where it stuck, OP before."""
    if kind == 0:
        S, J = f[0], f[1]
        kinetic = 0.5 * (S - J)
        if op >= high or op <= low:
            m[2] = 1.0 if op >= high else -1.0
            m[0] = high if op >= high else low
            m[1] = 1.0
            op = m[0] + m[2] * kinetic
            m[3] = op
        else:
            if m[1] == 0.0 and (op - m[4]) * m[2] <= 0.0:
                m[3] = m[4]
                m[1] = 1.0
            if m[1] == 1.0:
                moved = op - m[3]
                if m[2] == 0.0:
                    if abs(moved) > 0.5 * (S + J):
                        m[2] = math.copysign(1.0, moved)
                        m[1] = 0.0
                elif -m[2] * moved > S:
                    m[2] = -m[2]
                    m[1] = 0.0
                elif m[2] * moved > J:
                    m[1] = 0.0
            if m[1] == 0.0:
                m[0] = op - m[2] * kinetic
        m[4] = op
        return
    op = min(max(op, low), high)
    c = op - m[0]
    if op in (low, high):
        m[0] = op
        m[1] = 1.0
    elif kind == 1:
        f_s, f_d = 0.5 * (f[0] + f[1]), 0.5 * (f[0] - f[1])
        if m[1] == 0.0 and m[2] * c <= f_d + 1e-14 * abs(op):
            m[1] = 1.0
        if m[1] == 1.0 and abs(c) > f_s:
            m[1] = 0.0
            m[2] = math.copysign(1.0, c)
        if m[1] == 0.0:
            m[0] = op - m[2] * f_d
    elif abs(c) > f[0]:
        m[0] = op - math.copysign(f[1], c)


@njit(cache=True, error_model="numpy")  # type: ignore[untyped-decorator]
def _sliding(op: float, low: float, high: float, f: Any, m: Any, steps: int) -> Any:
    """One scan of a stem with mass under a held OP; m: MV, speed, direction (0 stuck). Returns its mean position."""
    F_s, F_c, F_v, M = f[0], f[1], f[2], f[3]
    h, mean = 1.0 / steps, 0.0
    for _ in range(steps):
        force = op - m[0]
        if m[2] == 0.0 and abs(force) > F_s and low < m[0] + math.copysign(1e-12, force) < high:
            m[2] = math.copysign(1.0, force)
        if m[2] != 0.0:
            # both friction and spring of the step's end: stable however light the stem is
            v = (M * m[1] + h * (force - m[2] * F_c)) / (M + h * F_v + h * h)
            m[1] = v
            if v * m[2] <= 0.0:
                m[1] = m[2] = 0.0
            else:
                m[0] += h * v
                if m[0] <= low or m[0] >= high:
                    m[0] = min(max(m[0], low), high)
                    m[1] = m[2] = 0.0
        mean += m[0]
    if m[2] != 0.0 and abs(m[1]) < 1e-3 * (abs(op - m[0]) + F_c) / max(F_v, 1e-9):
        m[0] = op - m[2] * F_c  # it would creep there for ever; it sticks
        m[1] = m[2] = 0.0
    return mean / steps


@njit(cache=True, error_model="numpy")  # type: ignore[untyped-decorator]
def _creeping(r: Any, op: float, low: float, high: float, f: Any, m: Any) -> None:
    """One scan of a valve that gives before it breaks away; m: MV, stuck, direction, force to break away, air.

    air <- air + (1 - exp(-1/lag)) (OP - air),   F = air - MV: the force on the stem, friction holds it
    stuck     dF/dMV = (F_b / (give LEAVES)) (1 - sgn(dMV) F LEAVES / F_b)     Dahl's friction: it gives and creeps
              |F| > F_b: it slips, MV = air - dir (S - J)/2
    sliding   as Chen's valve, until air turns back; then F_b is drawn anew: (S - J)/2 + J exp(uneven n)

    Without give, unevenness and lag it is Chen's valve.  Source of the friction: P. R. Dahl (1968), A solid friction
    model, TOR-0158(3107-18)-1, Aerospace Corporation.
    """
    kinetic, jump, before = 0.5 * (f[0] - f[1]), f[1], m[4]
    m[4] += (1.0 - math.exp(-1.0 / f[4]) if f[4] > 0.0 else 1.0) * (op - before)
    air = m[4]
    if f[0] <= 0.0:
        m[0] = air
        return
    if m[3] == 0.0:  # at rest, never moved
        m[3] = kinetic + jump
    if m[1] == 0.0 and m[2] * (air - m[0]) <= kinetic + 1e-14 * abs(op):
        m[1] = 1.0
        m[3] = kinetic + jump * math.exp(min(f[3] * r.normal(), 1.0))
    if m[1] == 1.0:
        way = math.copysign(1.0, air - before)
        stiffness = m[3] / (f[2] * LEAVES) if f[2] > 0.0 else math.inf
        for k in range(STEPS):
            step = before + (air - before) * (k + 1.0) / STEPS
            held = max(1.0 - way * (step - m[0]) * LEAVES / m[3], 1.0 - LEAVES)
            m[0] += (air - before) / STEPS / (1.0 + stiffness * held)
            if abs(step - m[0]) > m[3]:
                m[1] = 0.0
                m[2] = math.copysign(1.0, step - m[0])
                break
    if m[1] == 0.0:
        m[0] = air - m[2] * kinetic
    m[0] = min(max(m[0], low), high)


@njit(cache=True, error_model="numpy")  # type: ignore[untyped-decorator]
def _loop(
    r: Any, scans: int, kinds: Any, drives: Any, f: Any, process: Any, c: Any, sensor: Any, authority: float,
    low: float, high: float, at: Any, out: Any,
) -> None:  # fmt: skip
    """One loop from rest; ``out`` (4, rows) at the scans ``at``."""
    valve, plant, controller = kinds
    K, tau1, tau2, theta = process[0], process[1], process[2], int(process[3])
    e1, e2 = math.exp(-1.0 / tau1), math.exp(-1.0 / tau2) if tau2 > 0.0 else 0.0
    line, head = np.zeros(theta + 1), 0
    load, move, m = np.zeros(5), np.zeros(5), np.zeros(5)
    m[1] = 0.0 if valve == 3 else 1.0
    load[0], move[0], noise = r.normal(), r.normal(), r.normal()
    K_p, T_i, T_d, N, b, T_f = c[0], c[1], c[2], c[3], c[4], c[5]
    z = derivative = filtered = x1 = x2 = 0.0
    track = 1.0 / (math.sqrt(T_i * T_d) if T_d > 0.0 else T_i)
    fade = math.exp(-N / T_d) if T_d > 0.0 else 0.0
    smooth = 1.0 - math.exp(-1.0 / T_f) if T_f > 0.0 else 1.0
    row = 0
    for k in range(scans):
        sp = _driven(r, float(k), drives[1], move)
        flow = _driven(r, float(k), drives[0], load)
        noise = _coloured(r, noise, sensor[1])
        pv = x2 + sensor[0] * noise
        if sensor[2] > 0.0:
            pv = sensor[2] * math.floor(pv / sensor[2] + 0.5)
        filtered += smooth * (pv - filtered)
        if controller == 2:
            v = K_p * (b * sp - pv + N * (-pv - derivative)) + z
            derivative = -pv + (derivative + pv) * fade
            gained = K_p * (sp - pv) / T_i
        else:
            v = K_p * (sp - filtered) + z
            gained = K_p * (sp - filtered) / T_i
        op = min(max(v, low), high)
        z += gained + min(track, 1.0) * (op - v)
        if valve == 3:
            before = _sliding(op, low, high, f, m, STEPS)
        elif valve == 4:
            _creeping(r, op, low, high, f, m)
            before = m[0]
        else:
            _stem(valve, op, low, high, f, m)
            before = m[0]
        line[head] = authority * before + flow
        head = (head + 1) % (theta + 1)
        F = line[head]  # theta scans old
        while row < len(at) and at[row] == k:
            out[0, row], out[1, row], out[2, row], out[3, row] = sp, pv, op, m[0]
            row += 1
        if plant == 2:
            x2 += K * (F + (x1 - F) * tau1 * (1.0 - e1))
        elif plant == 1:
            part = (x1 - F) * tau1 / (tau1 - tau2)
            x2 = K * F + (x2 - K * F - K * part) * e2 + K * part * e1
        else:
            x2 = K * F + (x2 - K * F) * e1
        x1 = F + (x1 - F) * e1
    while row < len(at):
        out[:, row] = out[:, max(row - 1, 0)]
        row += 1

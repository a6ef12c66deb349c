"""The flow loop of the benchmark as a program of its own: fixed steps, no block, no engine, no effect of the house.

    SP -> (filter) -> PI -> OP -> positioner, play, friction, stops -> MV -> trim, leak, gain -> + load -> dead time
       -> process -> second lag -> sensor (gain, bias, drift, lag) -> + noise -> range, converter -> PV

Classical Runge-Kutta of order four over ``h`` [s] for what is smooth; elements with memory (play, rate, friction,
converters) are advanced once a step, friction in shorter steps inside it.  Noise, load and set point change at whole
seconds, which are step ends.  A log row shows the loop after everything that happens at its second.
"""

import math
from typing import Any

import numpy as np
from numba import njit

from benchmarks.gap.loop_numbers import (  # isort: skip
    ASYMMETRIC, BIAS, BY_DIRECTION, DRIFT, FILTER, FOULING, FRICTION, FROZEN, F_C, F_S, F_V, GAP, HIGH, HYSTERESIS,
    INTEGRATING, INTERMITTENT, INVERSE, JAMMED, JUMP, JUMP_AT, K, KARNOPP, K_P, LEAK, LEAKING, LOW, MASS, MULTIPLIED,
    OSCILLATING, OTHER, OUTER_K, OUTER_NOISE, OUTER_T, OUTFLOW, OUTSIDE, PLAY, POSITIONER, PRESENT, R, RANGE_HIGH,
    RANGE_LOW, RATE, ROUNDED_OP, SCAN, SCAN_OFFSET, SECOND, SENSOR, SINE, SINE_PERIOD, SINE_PHASE, SIZE, SLUG,
    SLUG_PERIOD, SLUG_PHASE, SPAN, SPRING, STEP, STICKY, STOP_HIGH, STOP_LOW, TAU, THETA, T_I, VALVE_GAIN, VESSEL, V_S,
    WAVY, WEIGHT,
)  # fmt: skip

STATES = 7
Y, Y2, POS, Z, E_F, SEEN, LEVEL = range(STATES)
FALL, RISE_SHARE = 0.2, 0.8


@njit(cache=True)
def added_load(t: float, p: Any) -> float:
    """Return sine, step and slugs at the process input at time ``t`` [s]."""
    u = 0.0
    if p[SINE] != 0.0:
        u += p[SINE] * math.sin(2.0 * math.pi * (t / p[SINE_PERIOD] + p[SINE_PHASE]))
    if t >= p[JUMP_AT]:
        u += p[JUMP]
    if p[SLUG] != 0.0:
        at = (t / p[SLUG_PERIOD] + p[SLUG_PHASE] + 0.5 * RISE_SHARE) % 1.0
        if at < RISE_SHARE:
            u += p[SLUG] * (2.0 * at / RISE_SHARE - 1.0)
        else:
            u += p[SLUG] * (1.0 - 2.0 * (at - RISE_SHARE) / FALL)
    return u


@njit(cache=True)
def sensed(t: float, x: Any, p: Any) -> float:
    """Return what the sensor shows before noise, range and converter."""
    value = x[Y2] if p[SECOND] > 0.0 else x[Y]
    if p[OUTSIDE] == INVERSE:
        value = x[Y2] - p[SIZE] * (x[Y] - x[Y2]) / p[OTHER]
    shown = p[SPAN] * value + p[BIAS] + p[DRIFT] * t
    return x[SEEN] if p[SENSOR] > 0.0 else shown


@njit(cache=True)
def converted(value: float, p: Any) -> float:
    """Return a measurement within the sensor's range, in whole steps."""
    if p[STEP] > 0.0:
        value = p[STEP] * math.floor(value / p[STEP] + 0.5)
    return min(max(value, p[RANGE_LOW]), p[RANGE_HIGH])


@njit(cache=True)
def control(e: float, sp: float, z: float, p: Any) -> float:
    """Return the output of the controller within its limits."""
    v = p[K_P] * e + z
    if p[OUTSIDE] == WEIGHT:
        v += p[K_P] * (p[SIZE] - 1.0) * (sp - p[OTHER])
    v = min(max(v, p[LOW]), p[HIGH])
    if p[OUTSIDE] == ROUNDED_OP:
        v = p[SIZE] * math.floor(v / p[SIZE] + 0.5)
    return v


@njit(cache=True)
def error(sp: float, pv: float, p: Any) -> float:
    """Return the control error as the controller sees it."""
    e = sp - pv
    if p[OUTSIDE] == GAP:
        e = math.copysign(max(abs(e) - p[SIZE], 0.0), e)
    return e


@njit(cache=True)
def flow(mv: float, way: float, p: Any) -> float:
    """Return the flow through the valve; ``way``: the direction of the last movement of its stem, +-1."""
    if p[R] != 1.0:
        mv = (p[R] ** mv - 1.0) / (p[R] - 1.0)
    if p[OUTSIDE] == WAVY:
        mv += p[SIZE] * math.sin(2.0 * math.pi * mv / p[OTHER])
    if p[OUTSIDE] == BY_DIRECTION:
        mv *= 1.0 + p[SIZE] * way
    return p[VALVE_GAIN] * mv + p[LEAK]


@njit(cache=True)
def stem_of(op: float, x: Any, held: float, by_steps: bool, p: Any) -> float:
    """Return where the stem is: held by an element with memory, behind a lag, or where OP wants it."""
    mv = held if by_steps else (x[POS] if p[POSITIONER] > 0.0 else op)
    return min(max(mv, p[STOP_LOW]), p[STOP_HIGH])


@njit(cache=True)
def slope(t, x, sp, n, load, pv_held, op_held, held, late, way, flags, p, dx):  # type: ignore[no-untyped-def]
    """Write the rates of the states; return the process input that is made now.

    ``flags``: PV is converted once a step; OP is held between scans; the stem has memory; there is a dead time.
    """
    by_steps_pv, scanned, by_steps, delayed = flags
    pv = pv_held if by_steps_pv else sensed(t, x, p) + n
    e = error(sp, pv, p)
    used = x[E_F] if p[FILTER] > 0.0 else e
    op = op_held if scanned else control(used, sp, x[Z], p)
    u = flow(stem_of(op, x, held, by_steps, p), way, p) + load + added_load(t, p)
    entering = late if delayed else u
    gain, tau = p[K], p[TAU]
    if p[OUTSIDE] == OSCILLATING:
        gain *= 1.0 + p[SIZE] * math.sin(2.0 * math.pi * t / p[OTHER])
    if p[OUTSIDE] == FOULING:
        gain *= 1.0 - p[SIZE] * t / p[OTHER]
    if p[OUTSIDE] == ASYMMETRIC:
        tau *= 1.0 + p[SIZE] if gain * entering > x[Y] else 1.0 - p[SIZE]
    if p[INTEGRATING] > 0.0:
        dx[Y] = gain * (entering - p[OUTFLOW]) / tau
    else:
        dx[Y] = (gain * entering - x[Y]) / tau
    through = x[Y2] if p[SECOND] > 0.0 else x[Y]
    dx[LEVEL] = (through - p[OUTFLOW]) / p[VESSEL] if p[OUTER_K] > 0.0 else 0.0
    second = p[OTHER] if p[OUTSIDE] == INVERSE else p[SECOND]
    dx[Y2] = (x[Y] - x[Y2]) / second if second > 0.0 else 0.0
    dx[POS] = (op - x[POS]) / p[POSITIONER] if p[POSITIONER] > 0.0 else 0.0
    v = p[K_P] * used + x[Z]
    pushed = (v >= p[HIGH] and used > 0.0) or (v <= p[LOW] and used < 0.0)
    dx[Z] = 0.0 if scanned or pushed else p[K_P] * used / p[T_I]
    if p[OUTSIDE] == LEAKING and not scanned:
        dx[Z] -= p[SIZE] * x[Z]
    dx[E_F] = (e - x[E_F]) / p[FILTER] if p[FILTER] > 0.0 and not scanned else 0.0
    if p[SENSOR] > 0.0:
        value = x[Y2] if p[SECOND] > 0.0 else x[Y]
        dx[SEEN] = (p[SPAN] * value + p[BIAS] + p[DRIFT] * t - x[SEEN]) / p[SENSOR]
    else:
        dx[SEEN] = 0.0
    return u


@njit(cache=True)
def rubbed(op: float, s: Any, h: float, p: Any) -> None:
    """Advance a stem with friction by ``h`` [s] under a held OP; ``s`` = position, speed, bristle, all [travel, s].

    Karnopp (1985): below a small speed the stem stands and friction is what balances the spring; its friction falls
    from F_s to F_c with speed (Stribeck).  LuGre (Canudas de Wit 1995): bristles of stiffness 2e7 N per travel.
    """
    if p[FRICTION] == KARNOPP:
        m = max(1, math.ceil(h / 0.001))
        d = h / m
        for _ in range(m):
            force = p[SPRING] * (op - s[0])
            if abs(s[1]) < 1e-5 and abs(force) <= p[F_S]:
                s[1] = 0.0
            else:
                way = s[1] if abs(s[1]) >= 1e-5 else force
                coulomb = p[F_C] + (p[F_S] - p[F_C]) * math.exp(-((s[1] / p[V_S]) ** 2))
                new = (s[1] + d * (force - math.copysign(coulomb, way)) / p[MASS]) / (1.0 + d * p[F_V] / p[MASS])
                s[1] = 0.0 if new * s[1] < 0.0 else new
                s[0] += d * s[1]
    else:
        m = max(1, math.ceil(h / 0.00025))
        d = h / m
        stiff = 2.0e7
        damp = 2.0 * math.sqrt(stiff * p[MASS])
        for _ in range(m):
            force = p[SPRING] * (op - s[0])
            g = p[F_C] + (p[F_S] - p[F_C]) * math.exp(-((s[1] / p[V_S]) ** 2))
            rate = abs(s[1]) * stiff / g
            before = s[2]
            s[2] = (s[2] + d * s[1]) / (1.0 + d * rate)
            rub = stiff * s[2] + damp * (s[2] - before) / d * math.exp(-((s[1] / p[V_S]) ** 2))
            s[1] = (s[1] + d * (force - rub) / p[MASS]) / (1.0 + d * p[F_V] / p[MASS])
            s[0] += d * s[1]


@njit(cache=True)
def moved_at_once(wanted: float, held: float, jammed: float, p: Any) -> float:
    """Return where a stem with play, or one that jams at times, is while it is wanted at ``wanted``."""
    if p[FRICTION] > 0.0 or p[RATE] < math.inf:
        return held
    if p[PLAY] > 0.0:
        return min(max(held, wanted - 0.5 * p[PLAY]), wanted + 0.5 * p[PLAY])
    return held if jammed > 0.0 else wanted


@njit(cache=True)
def moved_in_time(wanted: float, held: float, stem: Any, h: float, p: Any) -> float:
    """Return where a stem with friction, or a limited rate, is after ``h`` [s]."""
    if p[FRICTION] > 0.0:
        rubbed(wanted, stem, h, p)
        return stem[0]
    if p[RATE] < math.inf:
        return held + min(max(wanted - held, -p[RATE] * h), p[RATE] * h)
    return held


@njit(cache=True)
def run(p: Any, sp: Any, noise: Any, noise_2: Any, load: Any, switch: Any, steps: int, rest: float) -> Any:
    """Return the loop at whole seconds, shape (seconds, 7): SP, PV, OP, MV, y, and of a cascade level and set point.

    ``sp``, ``noise``, ``load``: what holds during each second; ``noise_2`` a second stream, ``switch`` 0 or 1 a second,
    for effects that need them; ``steps`` a second; ``rest`` the PV at which the loop without effects stands at first.
    """
    n, h = len(sp), 1.0 / steps
    out = np.empty((n, 7))
    x = np.zeros(STATES)
    x[LEVEL] = rest
    if p[OUTER_K] > 0.0:
        rest = p[OUTFLOW]  # of the flow
    x[Y] = x[Y2] = (rest - p[BIAS]) / p[SPAN] if p[INTEGRATING] > 0.0 else rest  # a level is held where it is seen
    x[POS] = x[Z] = held = p[OUTFLOW] if p[INTEGRATING] > 0.0 else rest / p[K]
    x[SEEN] = p[SPAN] * x[Y] + p[BIAS]
    x[E_F] = 0.0
    z_outer, wanted_flow = p[OUTFLOW], 0.0
    a, b, c, d, trial = np.zeros(STATES), np.zeros(STATES), np.zeros(STATES), np.zeros(STATES), np.zeros(STATES)
    stem = np.array([held, 0.0, 0.0])
    scan_steps = round(p[SCAN] * steps)
    offset_steps = round(p[SCAN_OFFSET] * steps)
    converts = (
        p[STEP] > 0.0 or p[RANGE_LOW] > -math.inf or p[RANGE_HIGH] < math.inf or p[OUTSIDE] == HYSTERESIS
        or p[OUTSIDE] == STICKY or p[OUTSIDE] == FROZEN
    )  # fmt: skip
    scanned = scan_steps > 0
    by_steps = p[PLAY] > 0.0 or p[RATE] < math.inf or p[FRICTION] > 0.0 or p[OUTSIDE] == JAMMED
    lag_steps = round(p[THETA] * steps)
    longest = max(lag_steps, round(p[SIZE] * steps) if p[OUTSIDE] == INTERMITTENT else 0) + 1
    entered = np.full((longest + 1, 2), held)  # process input at the beginning and at the end of past steps
    flags = (converts, scanned, by_steps, lag_steps > 0 or p[OUTSIDE] == INTERMITTENT)
    op, pv, way, last = held, rest, 1.0, held
    kept = x[SEEN]
    count = 0
    for k in range(n):
        drawn = noise[k]
        if p[OUTSIDE] == MULTIPLIED:
            drawn += p[SIZE] * x[Y] * noise_2[k]
        level = x[LEVEL] + p[OUTER_NOISE] * noise_2[k]
        if p[OUTER_K] > 0.0:
            e_outer = sp[k] - level
            more = p[OUTER_K] * e_outer / p[OUTER_T]
            v = p[OUTER_K] * e_outer + z_outer + more
            wanted_flow = min(max(v, 0.0), 1.0)
            if not ((v >= 1.0 and e_outer > 0.0) or (v <= 0.0 and e_outer < 0.0)):
                z_outer += more
        else:
            wanted_flow = sp[k]
        for j in range(steps):
            t = k + j * h
            # --- elements with memory, and what is held over the step
            value = sensed(t, x, p)
            if p[OUTSIDE] == HYSTERESIS:
                kept = min(max(kept, value - 0.5 * p[SIZE]), value + 0.5 * p[SIZE])
                value = kept
            elif p[OUTSIDE] == STICKY:
                if abs(value - kept) > p[SIZE]:
                    kept = value
                value = kept
            if not (p[OUTSIDE] == FROZEN and switch[k] > 0.0):
                pv = converted(value + drawn, p)
            e = error(wanted_flow, pv, p)
            if scanned:
                if count >= offset_steps and (count - offset_steps) % scan_steps == 0:
                    if p[FILTER] > 0.0:
                        x[E_F] += (1.0 - math.exp(-p[SCAN] / p[FILTER])) * (e - x[E_F])
                    used = x[E_F] if p[FILTER] > 0.0 else e
                    more = p[SCAN] * p[K_P] * used / p[T_I]
                    if p[OUTSIDE] == LEAKING:
                        more -= p[SCAN] * p[SIZE] * x[Z]
                    z = x[Z] + (more if p[PRESENT] > 0.0 else 0.0)
                    v = p[K_P] * used + z
                    op = control(used, wanted_flow, z, p)
                    if not ((v >= p[HIGH] and used > 0.0) or (v <= p[LOW] and used < 0.0)):
                        x[Z] += more
            else:
                op = control(x[E_F] if p[FILTER] > 0.0 else e, wanted_flow, x[Z], p)
            wanted = x[POS] if p[POSITIONER] > 0.0 else op
            if by_steps:
                held = moved_at_once(wanted, held, switch[k], p)
            mv = stem_of(op, x, held, by_steps, p)
            if abs(mv - last) > 0.002:
                way = 1.0 if mv > last else -1.0
                last = mv
            if j == 0:
                out[k, 0] = wanted_flow
                out[k, 1] = pv if converts else value + drawn
                out[k, 2] = op
                out[k, 3] = mv
                out[k, 4] = x[Y]
                out[k, 5] = level
                out[k, 6] = sp[k]
            # --- what enters the process over the step
            back = lag_steps
            if p[OUTSIDE] == INTERMITTENT:
                back = round(p[SIZE] * steps) if switch[k] > 0.0 else 0
            old = entered[(count - back) % (longest + 1)]
            during = held  # a stem that moves at a limited rate is half way through its move on average
            if p[RATE] < math.inf:
                during += 0.5 * min(max(wanted - held, -p[RATE] * h), p[RATE] * h)
            # --- Runge and Kutta
            u_0 = slope(t, x, wanted_flow, drawn, load[k], pv, op, during, old[0], way, flags, p, a)
            if back == 0:
                old[0] = u_0
                old[1] = u_0
                slope(t, x, wanted_flow, drawn, load[k], pv, op, during, u_0, way, flags, p, a)
            for i in range(STATES):
                trial[i] = x[i] + 0.5 * h * a[i]
            half = 0.5 * (old[0] + old[1])
            slope(t + 0.5 * h, trial, wanted_flow, drawn, load[k], pv, op, during, half, way, flags, p, b)
            for i in range(STATES):
                trial[i] = x[i] + 0.5 * h * b[i]
            slope(t + 0.5 * h, trial, wanted_flow, drawn, load[k], pv, op, during, half, way, flags, p, c)
            for i in range(STATES):
                trial[i] = x[i] + h * c[i]
            late_t = t + h * (1.0 - 1e-6)  # what switches at the end of the step has not yet
            u_1 = slope(late_t, trial, wanted_flow, drawn, load[k], pv, op, during, old[1], way, flags, p, d)
            for i in range(STATES):
                x[i] += h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i])
            if by_steps:
                pv_end = pv if converts else sensed(t + h, x, p) + drawn
                e = error(wanted_flow, pv_end, p)
                op_end = op if scanned else control(x[E_F] if p[FILTER] > 0.0 else e, wanted_flow, x[Z], p)
                late = x[POS] if p[POSITIONER] > 0.0 else op_end
                held = moved_in_time(0.5 * (wanted + late), moved_at_once(late, held, switch[k], p), stem, h, p)
            entered[count % (longest + 1), 0] = u_0
            entered[count % (longest + 1), 1] = u_1
            count += 1
    return out

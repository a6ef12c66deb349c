"""Valve, sensor, controller and load as a site has them, and what can be wrong with each; all in shares of full span.

``parts`` has their numbers.

Valve      The positioner follows OP with lag ``tau``, friction acts, then speed and stops; ``through`` is the flow.
           Friction: a stem that stands breaks away when its positioner is (S + J)/2 off, and is then dragged
           (S - J)/2 behind until the positioner stands still or turns.
Sensor     It follows the true value with lag ``tau``, multiplies by ``span``, adds ``bias``, ``drift`` and noise, new
           at each scan; then ``step`` and the limits ``low`` and ``high``.
PI         Each scan: e = SP - PV;  I = I + K h/T_i e;  OP = K e + I between its limits;  I = OP - K e there, so
           that it never winds up (this is the incremental form as well: OP moves by K (de + h/T_i e)).
Feed       What a plan adds to the unmeasured load: a sine, a step, a saw-tooth.
"""

import numpy as np
from numba import njit

STANDS = 0.15  # a positioner that has not moved for so long lets the stem stick again [s]


@njit(cache=True)
def stem_at(travel):
    """Return the state of a stem at rest."""
    return np.array([travel, travel, 0.0, 0.0, 0.0])


@njit(cache=True)
def sensor_at(true):
    """Return the state of a sensor at rest."""
    return np.array([true, true, 0.0, true])


@njit(cache=True)
def pi_at(op):
    """Return the state of a controller at rest."""
    return np.array([op, 0.0, op])


@njit(cache=True)
def stem(v, x, op, t, dt):
    """Return the travel after ``dt``; x = [positioner, stem, direction, still for, speed], all kept."""
    was = x[0]
    aim = op
    if v.resolution > 0.0:
        aim = v.resolution * np.floor(op / v.resolution + 0.5)
    if v.overshoot > 0.0:
        w = 2.0 * np.pi / v.overshoot
        x[4] += dt * (w * w * (aim - x[0]) - 0.4 * w * x[4])
        x[0] += dt * x[4]
    elif v.tau > 0.0:
        x[0] += (aim - x[0]) * (1.0 - np.exp(-dt / v.tau))
    else:
        x[0] = aim
    u = x[0]
    moved = u - was
    static, drag = 0.5 * (v.S + v.J), 0.5 * (v.S - v.J)
    to = x[1]
    if x[2] == 0.0:
        if abs(u - x[1]) > static:
            x[2] = 1.0 if u > x[1] else -1.0
            x[3] = 0.0
    elif abs(moved) < 1e-9:
        x[3] += dt
        if x[3] > STANDS:
            x[2] = 0.0
    elif moved * x[2] < 0.0:
        x[2] = 0.0
    else:
        x[3] = 0.0
    if x[2] != 0.0 and (u - x[2] * drag - x[1]) * x[2] > 0.0:
        to = u - x[2] * drag
    if static == 0.0:
        to = u
    if v.sag > 0.0:
        to = max(to - v.sag * (t % 600.0), 0.0)
    to = min(max(to, x[1] - v.down * dt), x[1] + v.up * dt)
    x[1] = min(max(to, v.low), v.high)
    return x[1]


@njit(cache=True)
def through(v, travel):
    """Return the share of full flow of a valve that is linear by its sheet, (R^x - 1)/(R - 1) if it is not."""
    share = travel if v.R == 1.0 else (v.R**travel - 1.0) / (v.R - 1.0)
    return v.gain * share + v.leak


@njit(cache=True)
def feel(s, m, true, dt):
    """Let the element follow the true value for ``dt``; m = [element, shown, frozen for, hysteresis]."""
    tau = s.tau + (s.falls if true < m[0] else 0.0)
    m[0] = true if tau <= 0.0 else m[0] + (true - m[0]) * (1.0 - np.exp(-dt / tau))


@njit(cache=True)
def read(s, m, noise, luck, t):
    """Return what the transmitter shows at a scan, with a standard normal ``noise``."""
    half = 0.5 * s.play
    m[3] = min(max(m[3], m[0] - half), m[0] + half)
    y = s.span * m[3] + s.bias + s.drift * max(t, 0.0) / 3600.0
    y += s.sd * s.noise * noise * (1.0 + s.grows * max(y - s.grows_from, 0.0))
    if s.step > 0.0:
        y = s.step * np.floor(y / s.step + 0.5)
    y = min(max(y, s.low), s.high)
    if m[2] > 0.0:
        m[2] -= 1.0
        return m[1]
    if luck < s.freezes:
        m[2] = s.frozen
    if abs(y - m[1]) >= s.exception:
        m[1] = y
    return m[1]


@njit(cache=True)
def error(c, s, sp, pv):
    """Return the error after the filter; s = [integral, filtered error, OP]."""
    e = sp - pv
    s[1] += (e - s[1]) * (c.scan / (c.tau + c.scan))
    return s[1]


@njit(cache=True)
def pi(c, s, sp, pv, added, luck):
    """Return OP of one scan, ``added`` (a feedforward) included; the state is that of ``error``."""
    if luck < c.misses:
        return s[2]
    e = error(c, s, sp, pv)
    gain = c.K * (1.0 + c.squares * abs(e))
    held = s[0] - c.scan * c.leaks * (s[0] - c.rest) + gain * c.scan / c.T_i * e
    op = gain * e + held + added
    op = min(max(op, c.low), c.high)
    if op == c.low or op == c.high:
        if c.stops == 0.0:
            s[0] = op - gain * e - added
    else:
        s[0] = held
    s[2] = min(max(op, s[2] - c.slew * c.scan), s[2] + c.slew * c.scan)
    return s[2]


@njit(cache=True)
def planned(f, t):
    """Return what the plan adds to the load at ``t``: the saw-tooth rises over 80 % of its period."""
    out = 0.0
    if f.sine != 0.0:
        out += f.sine * np.sin(2.0 * np.pi * t / f.period)
    if f.step != 0.0 and t >= f.at:
        out += f.step
    if f.slug != 0.0:
        part = (t / f.period) % 1.0
        out += f.slug * (part / 0.8 if part < 0.8 else (1.0 - part) / 0.2) - 0.5 * f.slug
    return out


@njit(cache=True)
def scanned(p, s, m, sp, noise, luck, k, t):
    """Return SP, PV and OP of scan ``k`` of a single loop: the transmitter is read, then the controller runs."""
    pv = read(p.sensor, m, noise[k], luck[k], t)
    return sp, pv, pi(p.controller, s, sp, pv, 0.0, luck[k])


@njit(cache=True)
def kept(out, i, every, sp, pv, op):
    """Write the row of step ``i`` of the log, where there is one: every so many steps from 0 on."""
    if i >= 0 and i % every == 0:
        row = out[i // every]
        row[0], row[1], row[2] = sp, pv, op

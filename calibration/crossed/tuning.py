"""From what was drawn to the numbers of a loop: time scales by the kind of process, tuning by rule, sizes by a trial.

    K_c = tau / (K (t_c + theta)),   T_i = min(tau, 4 (t_c + theta))       S. Skogestad, J. Process Control 13:291, 2003

What drives the loop is scaled by a run of the same loop without friction, so that OP travels as far as was asked.
A stem that never moves has a band without end, in that run too, where OP then has no limits.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from stickslip.calibration.crossed.drawing import Drawn
from stickslip.calibration.crossed.loops import DRIVERS, FORMS, Numbers, run
from stickslip.calibration.crossed.stems import LAWS, POSITIONERS

LAG = {"flow": 4.0, "pressure": 25.0, "temperature": 250.0, "level": 60.0}  # s
SOUND = 0.01  # share of the friction of a valve that sticks
ROWS = 4000  # of a log


@dataclass(frozen=True)
class Tuned:
    """The numbers of a loop, how many steps lie between two samples, and PV's swing in % of its span."""

    numbers: Numbers
    every: int
    swing: float


def _ultimate(K: float, tau_1: float, tau_2: float, theta: float, T_i: float) -> tuple[float, float]:
    """Gain and period [s] at which a loop under PI control rings for ever."""
    w = np.geomspace(0.02, 60.0, 3000) / (theta + tau_2 + 0.1 * tau_1)
    s = 1j * w
    loop = K * (1 + 1 / (T_i * s)) * np.exp(-theta * s) / ((tau_2 * s + 1) * (tau_1 * s + 1 if tau_1 > 0.0 else s))
    angle = np.unwrap(np.angle(loop))
    below = np.flatnonzero((angle[:-1] > -math.pi) & (angle[1:] <= -math.pi))
    i = int(below[-1]) if len(below) else len(w) - 1
    return 1.0 / abs(loop[i]), 2.0 * math.pi / float(w[i])


def tuned(d: Drawn) -> Tuned:
    """The numbers of a drawn loop."""
    lag = LAG[d.process] * d.tau
    level = d.process == "level"
    theta = d.dead * lag * (0.15 if level else 0.6 if d.process != "flow" else 1.0)
    tau_2 = max(d.second * lag, 0.02 * lag)
    air = d.air * (0.5 if d.process == "flow" else 1.0)
    K = abs(d.gain) / (lag * 4.0 if level else 1.0)
    tau_1 = 0.0 if level else lag
    apparent = theta + 0.5 * tau_2 + air
    wanted = d.loose * apparent * (4.0 if level and d.averaging else 1.0)
    if level:
        K_p, T_i = 1.0 / (K * (wanted + apparent)), 4.0 * (wanted + apparent)
    else:
        K_p, T_i = (lag + 0.5 * tau_2) / (K * (wanted + apparent)), min(lag + 0.5 * tau_2, 4.0 * (wanted + apparent))
    _, rings = _ultimate(K, tau_1, tau_2 + air, theta, T_i)
    scan_time = rings / 30.0
    smooth = d.filter * rings / 4.0
    limit, rings = _ultimate(K, tau_1, tau_2 + air, theta + 0.7 * scan_time + smooth, T_i)
    K_p = min(K_p, 0.5 * limit)
    if d.driver == "tuning":
        K_p = 0.9 * limit
        T_d = 0.0
    else:
        T_d = 0.15 * apparent
    natural = rings * (1.0 if d.driver == "tuning" else 1.6)
    if level and d.driver != "tuning":
        natural = max(natural, 2.0 * math.pi * math.sqrt(T_i / (K_p * K)))
    period = natural * (d.slow if d.driver in ("moving_sp", "periodic_sp", "master", "load", "neighbour") else 1.0)
    h = min(scan_time / 2.0, air / 2.0, max(tau_2, 0.02) / 1.0)
    scan = max(round(scan_time / h), 1)
    dt = 60.0 if d.process == "temperature" and d.minute else period / d.points
    every = max(round(dt / h), 1)
    rows = int(min(max(d.periods * period / (every * h), 200), ROWS))
    w = 2.0 * math.pi / natural
    answer = K / abs((1j * w * tau_2 + 1) * (1j * w * tau_1 + 1 if tau_1 > 0.0 else 1j * w))
    swing = 1.2 * d.S * answer
    S = d.S * (1.0 if d.sticks and not d.stands else SOUND)
    ratio = 0.0 if d.law in ("dahl", "backlash") else d.ratio
    span = rows * every * h
    start = (0.2 + 0.5 * (d.seed % 97) / 97.0) * span
    sign = 1.0 if d.gain > 0.0 else -1.0
    band, reach = (math.inf, math.inf) if d.stands else (0.0, 45.0)
    numbers = Numbers(
        h=h, scan=scan, steps=rows * every, K=sign * K, tau_1=tau_1, tau_2=tau_2, theta=theta,
        bend=d.bend if not level else 0.3 * d.bend, K_p=sign * K_p, T_i=T_i, T_d=max(T_d, 2.0 * h * scan),
        form=FORMS.index(d.form), zone=0.0, step_op=0.0, filter=smooth, low=-reach, high=reach,
        law=LAWS.index("backlash"), S=band, J=0.0, air=air, mass=d.mass * air**2, positioner=0, sticking=0.0, noise=0.0,
        driver=DRIVERS.index(d.driver), size=1.0, time=period, shape=d.shape, wander=d.wander, base=0.0,
        push=0.0, manual_from=-1.0, manual_to=-1.0,
    )  # fmt: skip
    size = 0.0
    if d.driver not in ("nothing", "tuning"):
        trial = np.zeros((4, rows))
        run(np.random.default_rng(d.seed), numbers, every, trial)
        moved = float(np.subtract(*np.percentile(trial[2], [97, 3])))
        size = min(d.travel * d.S, 60.0) / moved if moved > 1e-9 and math.isfinite(moved) else 0.0
        if d.driver in ("periodic_sp", "moving_sp", "master"):
            swing = max(swing, 0.7 * size * float(np.subtract(*np.percentile(trial[1], [95, 5]))))
    half = 0.5 * d.limited * d.travel * d.S
    return Tuned(
        numbers._replace(
            size=size, base=d.base * d.S, push=0.5 * max(S, d.base * d.S),
            law=LAWS.index("backlash" if d.stands else d.law), S=band if d.stands else S, J=S * ratio,
            positioner=POSITIONERS.index(d.positioner), sticking=d.hysteresis * swing,
            noise=min(d.noise * swing, 0.3 * d.S / K_p),
            zone=d.zone * swing, step_op=d.step_op * d.S,
            low=-half if half > 0.0 and d.seed % 2 else -45.0,
            high=half if half > 0.0 and not d.seed % 2 else 45.0,
            manual_from=start if d.manual else -1.0, manual_to=start + d.manual * span if d.manual else -1.0,
        ),
        every, swing,
    )  # fmt: skip

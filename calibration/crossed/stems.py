"""Steps of a stem by ``h`` seconds: positioner, air, and eight laws of friction, from their equations.

Forces count in % of OP: the spring's stiffness is one, so that at rest stem = air.  s: what a valve remembers,

    s[0] stem   s[1] speed   s[2] air   s[3] way (-1, 0, 1)   s[4] bristle or mark   s[5] linkage   s[6] positioner

f_s = (S + J) / 2 holds a stem that stands, f_d = (S - J) / 2 drags one that moves.

Sources: M. Kano et al., IFAC DYCOPS 2004; Q. P. He et al., Ind. Eng. Chem. Res. 46:8503, 2007; D. Karnopp, J. Dyn. Sys.
107:100, 1985; C. Canudas de Wit et al., IEEE Trans. Autom. Control 40:419, 1995; P. R. Dahl, 1968.
"""

import math
from typing import Any

from stickslip.logs.compiled import njit

LAWS = ("kano", "he", "karnopp", "stribeck", "lugre", "backlash_and_stick", "dahl", "backlash")
JUMPLESS = ("dahl", "backlash")
POSITIONERS = ("none", "none", "proportional", "digital")
GAIN = 4.0  # of a positioner
GIVES = 0.03  # of f_s: how far a bristle bends before it slips


@njit(cache=True)  # type: ignore[untyped-decorator]
def moved(s: Any, op: float, h: float, law: int, S: float, J: float, lag: float, mass: float, positioner: int) -> None:
    """Move the stem by one step; ``lag`` [s] of air, ``mass`` [s^2]."""
    driven = op
    if positioner >= 2:
        error = op - s[0]
        if positioner == 3:
            if abs(error) < 0.3:
                error = 0.0
            s[6] = min(max(s[6] + error * h / (20.0 * lag), -20.0), 20.0)
        driven = op + GAIN * error + s[6]
        S = S * (1.0 + GAIN)  # it takes dead travel down by its gain; a slip is over before it answers
    before = s[2]
    s[2] += (driven - s[2]) * (1.0 - math.exp(-h / lag))
    if positioner >= 2:
        s[2] = min(max(s[2], before - 30.0 * h / lag), before + 30.0 * h / lag)  # a spool passes so much air
    f_s, f_d, air = 0.5 * (S + J), 0.5 * (S - J), s[2]
    if law == 0:
        _kano(s, air, before, S, J, f_d)
    elif law == 1:
        if abs(air - s[0]) > f_s:
            s[0] = air - math.copysign(f_d, air - s[0])
    elif law == 2 or law == 3:
        _with_mass(s, air, h, law == 3, f_s, f_d, lag, mass, J)
    elif law == 4 or law == 6:
        _bristles(s, air, h, law == 4, f_s, f_d, 0.5 * S, lag, J)
    elif law == 5:
        half = 0.25 * S  # half of the dead travel is play of the linkage; what is left sticks behind it
        s[5] = min(max(s[5], air - half), air + half)
        _stuck(s, s[5], 0.5 * S, min(J, 0.5 * S))
    else:
        s[0] = min(max(s[0], air - 0.5 * S), air + 0.5 * S)


@njit(cache=True)  # type: ignore[untyped-decorator]
def _kano(s: Any, air: float, before: float, S: float, J: float, f_d: float) -> None:
    if s[1] == 0.0 and (air - before) * s[3] <= 0.0:  # s[1] here: 1 while it stands
        s[1], s[4] = 1.0, before
    if s[1] == 1.0:
        way = air - s[4]
        if -s[3] * way > S:
            s[3], s[1] = -s[3], 0.0
        elif s[3] * way > J:
            s[1] = 0.0
    if s[1] == 0.0:
        s[0] = air - s[3] * f_d


@njit(cache=True)  # type: ignore[untyped-decorator]
def _stuck(s: Any, drive: float, S: float, J: float) -> None:
    """Chen's stem by forces: it stands until ``drive`` is f_s away, and moves along until ``drive`` turns."""
    f_s, f_d = 0.5 * (S + J), 0.5 * (S - J)
    c = drive - s[0]
    if s[1] == 0.0 and s[3] * c < f_d:
        s[1] = 1.0
    if s[1] == 1.0 and abs(c) > f_s:
        s[1], s[3] = 0.0, math.copysign(1.0, c)
    if s[1] == 0.0 and s[3] != 0.0:
        s[0] = drive - s[3] * f_d


@njit(cache=True)  # type: ignore[untyped-decorator]
def _with_mass(
    s: Any, air: float, h: float, falls: bool, f_s: float, f_d: float, lag: float, mass: float, J: float
) -> None:
    """Karnopp's stem, or one whose friction falls with speed (Stribeck)."""
    force = air - s[0]
    if s[3] == 0.0:
        if abs(force) <= f_s:
            s[1] = 0.0
            return
        s[3] = math.copysign(1.0, force)
    drag = f_d
    if falls:
        drag = f_d + (f_s - f_d) * math.exp(-((s[1] * lag / (0.1 * J + 1e-6)) ** 2))
    viscous = 0.3 * lag
    v = (mass * s[1] + h * (force - s[3] * drag)) / (mass + h * viscous + h * h)
    if v * s[3] <= 0.0 or (abs(v) * lag < 1e-3 * (f_d + 0.01) and abs(force) < f_s):
        s[1] = s[3] = 0.0
        return
    s[1] = v
    s[0] += h * v


@njit(cache=True)  # type: ignore[untyped-decorator]
def _bristles(
    s: Any, air: float, h: float, falls: bool, f_s: float, f_d: float, even: float, lag: float, J: float
) -> None:
    """Move a light stem on LuGre's bristles, or on Dahl's where friction does not fall with speed."""
    holds = f_s if falls else even
    if holds < 1e-9:
        s[0] = air
        return
    stiff, level = 1.0 / GIVES, holds
    if falls:
        level = f_d + (f_s - f_d) * math.exp(-((s[1] * lag / (0.1 * J + 1e-6)) ** 2)) + 1e-9
    viscous = 0.3 * lag
    v = (air - s[0] - stiff * s[4]) / (viscous + h * (1.0 + stiff))
    z = (s[4] + h * v) / (1.0 + h * abs(v) * stiff / level)
    v = (air - s[0] - stiff * z) / (viscous + h)
    s[4], s[1] = z, v
    s[0] += h * v

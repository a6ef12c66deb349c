"""Dry friction for a solver that knows no events: the mode of a stem follows from its states and what pulls at it.

    |v| > SLOW                             sliding in the direction of v
    |v| <= SLOW and |pull| <= breakaway    stuck: neither x nor v changes
    |v| <= SLOW and |pull| > breakaway     sliding in the direction of the pull
    at a stop and pulled against it        stuck; what speed is left dies out

So python-control can integrate it, also with its default method: a stuck stem is not stiff, and creeps by less than
1e-7 of travel in ten minutes.  Stiff methods need that trace of the pull (``TRACE``) for their Jacobian.
Where friction stops a stem abruptly, the last of its speed dies out smoothly instead (``halted``): within 1e-6 of
travel and 0.1 ms, but without a step in dv/dt, on which methods with a memory (LSODA) take no end of tiny steps.
A stem that follows OP more slowly than SLOW stands still until the pull exceeds the breakaway force.

Source: Karnopp, ASME J. Dynamic Systems, Measurement, and Control 107(1), 1985, pp. 100-103.
"""

import math

STUCK, UP, DOWN, IDEAL = 0.0, 1.0, -1.0, 2.0
SLOW = 2e-6  # [travel/s]
STILL = 1e-6  # [travel/s]: as far as ``ct.linearize`` steps aside a stuck stem keeps its speed, so its slopes are 0
HALT = 1e7  # [1/travel]: 1000 travel/s2 from 0.01 travel/s on
TRACE = 1e-11  # [1/s2] of the pull on a stuck stem: where slopes are 0 a stiff solver steps aside until it breaks away
EVEN = 2e-6  # [travel]: a pull as small leaves no trace, so ``ct.linearize`` at rest, which steps aside by half, has 0


def seen_mode(x: float, v: float, pull: float, breakaway: float, low: float, high: float) -> float:
    """Return the mode of a stem at ``x`` with the speed ``v`` [travel/s]; ``pull`` and ``breakaway`` in one unit."""
    if against_stop(x, v if abs(v) > SLOW else pull, low, high):
        return STUCK
    if abs(v) > SLOW:
        return UP if v > 0.0 else DOWN
    if abs(pull) <= breakaway:
        return STUCK
    return UP if pull > 0.0 else DOWN


def against_stop(x: float, direction: float, low: float, high: float) -> bool:
    """Return whether a stem at ``x`` stands at the stop that lies in ``direction``."""
    return x >= high if direction > 0.0 else x <= low


def halted(v: float, rate: float, pace: float) -> float:
    """Return dv/dt of a stem that slides and will stick: no faster to rest than ``braked``."""
    if v * rate >= 0.0:
        return rate
    most = abs(braked(v, pace))
    return max(-most, min(most, rate))


def braked(v: float, pace: float) -> float:
    """Return dv/dt of a stuck stem: what speed is left dies out, at ``pace`` [1/s] and ever slower near rest."""
    speed = max(abs(v) - STILL, 0.0)
    return -math.copysign(speed * (pace * speed / (speed + 10.0 * SLOW) + HALT * speed), v)


def stuck_rate(v: float, pull: float, pace: float) -> float:
    """Return dv/dt of a stuck stem that ``pull`` [travel] pulls at: it is ``braked``, and feels a trace of the pull."""
    return braked(v, pace) + (TRACE * pull if abs(pull) > EVEN else 0.0)

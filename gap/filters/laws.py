"""What bends between a controller and a process: the law of a valve, and the limits of an output that is not known.

What the valve makes of the opening x that it is told (``law`` and its numbers a, b):
    0  nothing of its own     1  stops at a and b     2  (a^x - 1)/(a - 1)     3  moves by a per scan at most
"""

import math

import numpy as np
from stickslip.logs.compiled import njit

NONE, STOPS, CURVED, SLOW = 0, 1, 2, 3
NODES, WEIGHTS = np.polynomial.hermite_e.hermegauss(7)
WEIGHTS = WEIGHTS / WEIGHTS.sum()


@njit(cache=True)
def through(law, a, b, told, held):  # type: ignore[no-untyped-def]
    """Return (mean opening over the scan, slope, opening at its end); ``held``: the opening at its beginning."""
    if law == STOPS:
        value = min(max(told, a), b)
        return value, (1.0 if value == told else 0.0), value
    if law == CURVED:
        if abs(a - 1.0) < 1e-6:
            return told, 1.0, told
        power = a**told
        return (power - 1.0) / (a - 1.0), power * np.log(a) / (a - 1.0), told
    if law == SLOW:
        way = told - held
        if abs(way) <= a:
            part = abs(way) / a  # of the scan, until it arrives
            return told - 0.5 * way * part, 1.0 - 0.5 * part, told
        end = held + np.copysign(a, way)
        return held + np.copysign(0.5 * a, way), 0.0, end
    return told, 1.0, told


@njit(cache=True)
def blurred(law, a, b, told, sd, held, loose):  # type: ignore[no-untyped-def]
    """Return what a law makes of an opening that is told up to N(0, sd^2): (mean, slope, variance beyond the slope,
    end, its variance); ``held`` the opening at the beginning of the scan, ``loose`` its variance.

    Seven points x_i of Gauss and Hermite with weights w_i: mean = sum w_i f(x_i), slope = sum w_i f(x_i) (x_i - told) /
    sd^2 (Stein's lemma).  What a stem of limited rate has still to go is loose by both variances.
    """
    if sd < 1e-12 and loose < 1e-24:
        mean, slope, end = through(law, a, b, told, held)
        return mean, slope, 0.0, end, 0.0
    if law == CURVED and abs(a - 1.0) >= 1e-6:  # moments of a lognormal law
        power, q = math.exp(math.log(a) * told), (math.log(a) * sd) ** 2
        mean = (power * math.exp(0.5 * q) - 1.0) / (a - 1.0)
        slope = power * math.exp(0.5 * q) * math.log(a) / (a - 1.0)
        square = (power / (a - 1.0)) ** 2 * math.exp(q) * math.expm1(q)
        return mean, slope, max(square - (slope * sd) ** 2, 0.0), told, 0.0
    if law != SLOW:
        loose = 0.0
    variance = sd * sd + loose
    wide = math.sqrt(variance)
    mean, cross, square, end, end_cross, end_square = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for i in range(len(NODES)):
        x = wide * NODES[i]
        value, _, last = through(law, a, b, told + x, held)
        mean += WEIGHTS[i] * value
        cross += WEIGHTS[i] * value * x
        square += WEIGHTS[i] * value * value
        end += WEIGHTS[i] * last
        end_cross += WEIGHTS[i] * last * x
        end_square += WEIGHTS[i] * last * last
    slope, end_slope = cross / variance, end_cross / variance
    more = max(square - mean * mean - slope * slope * variance, 0.0) + (1.0 - slope) ** 2 * loose
    beyond = max(end_square - end * end - end_slope * end_slope * variance, 0.0)
    after = beyond + (1.0 - end_slope) ** 2 * loose if law == SLOW else 0.0
    return mean, slope, more, end, after


@njit(cache=True)
def within(wanted, sd, lo, hi):  # type: ignore[no-untyped-def]
    """Return (mean of what lies within limits, share of it) of N(wanted, sd^2).

    E = lo A + hi (1 - B) + wanted (B - A) + sd (phi(a) - phi(b)),  a, b the limits in sd from wanted, A = Phi(a), ...
    """
    a, b = (lo - wanted) / sd, (hi - wanted) / sd
    A, B = 0.5 * math.erfc(-a / math.sqrt(2.0)), 0.5 * math.erfc(-b / math.sqrt(2.0))
    mean = wanted * (B - A) + sd * (math.exp(-0.5 * a * a) - math.exp(-0.5 * b * b)) / math.sqrt(2.0 * math.pi)
    if A > 0.0:
        mean += lo * A
    if B < 1.0:
        mean += hi * (1.0 - B)
    return mean, B - A

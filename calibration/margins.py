"""The gain at which a loop rings for ever, and the period at which it does.

1 + L(i w) = 0 with L = K_p C(i w) P(i w) exp(-theta i w):  arg L = -180 degrees, K_p = 1 / |C P| there
"""

import math
from dataclasses import dataclass, replace

import numpy as np
from stickslip.logs.arrays import Values

_OMEGA = np.geomspace(1e-4, 1e2, 600)  # rad/s, for a first lag of 10 s


@dataclass(frozen=True)
class Loop:
    """A linear loop but for the gain of its controller; the words and units are those of ``LoopSpec``."""

    process: str
    K: float
    tau1: float
    tau2: float
    theta: float
    controller: str
    T_i: float
    T_d: float
    T_f: float

    def with_integral(self, T_i: float) -> "Loop":
        """Return the loop with another integral time [s]."""
        return replace(self, T_i=T_i)


def ultimate(loop: Loop, scan: float = 0.0) -> tuple[float, float]:
    """Return the gain of the controller [% of OP per % of PV] and the period [s] at which the loop rings for ever.

    ``scan`` [s] is the time between scans, which acts as a dead time of half of it.  Without a frequency at which the
    phase is -180 degrees the gain is infinite.

    >>> import math
    >>> gain, period = ultimate(Loop("integrating", 1.0, 0.0, 0.0, 10.0, "pi", math.inf, 0.0, 0.0))
    >>> round(gain, 3), round(period, 1)            # analytic: pi/(2 theta) and 4 theta
    (0.157, 40.0)
    """
    s = 1j * _OMEGA
    lag2 = loop.tau2 * s + 1.0
    plant = loop.K / (s * lag2 if loop.process == "integrating" else (loop.tau1 * s + 1.0) * lag2)
    integral = np.zeros_like(s) if math.isinf(loop.T_i) else 1.0 / (loop.T_i * s)
    if loop.controller == "pid_series":
        control = (1.0 + integral) * (1.0 + loop.T_d * s) / (1.0 + loop.T_d / 8.0 * s)
    else:
        control = 1.0 + integral + loop.T_d * s / (loop.T_d / 8.0 * s + 1.0)
    open_loop = control * plant / (loop.T_f * s + 1.0)
    angle = _unwrapped(np.angle(open_loop))
    angle -= 2.0 * math.pi * (angle[0] > 0.0)  # two integrators begin at -180 degrees, or just below
    turns = (angle - (loop.theta + 0.5 * scan) * _OMEGA + math.pi) / (2.0 * math.pi)
    rings = np.flatnonzero((np.floor(turns[1:]) < np.floor(turns[:-1])) & (turns[1:] < 0.0))
    if not len(rings):
        return math.inf, 2.0 * math.pi * (loop.theta + loop.tau1)
    i = int(rings[np.argmax(np.abs(open_loop[rings]))])
    size = np.abs(open_loop[i : i + 2])
    part = float((turns[i] - math.floor(turns[i])) / (turns[i] - turns[i + 1]))
    omega = float(_OMEGA[i] * (_OMEGA[i + 1] / _OMEGA[i]) ** part)
    return float(1.0 / (size[0] * (size[1] / size[0]) ** part)), 2.0 * math.pi / omega


def _unwrapped(angle: Values) -> Values:
    """``np.unwrap``, which looks at every step, where few of them are jumps."""
    step = np.diff(angle)
    jumps = np.flatnonzero(np.abs(step) >= math.pi)
    for k in jumps.tolist():
        angle[k + 1 :] += (step[k] + math.pi) % (2.0 * math.pi) - math.pi - step[k]
    return angle

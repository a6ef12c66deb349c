"""Parts that controllers with limited output share: the kernels of a limited PI, and its mode in python-control.

    v = K_p e + z,   OP = v limited to low ... high,   e = action (u_0 - u_1)
    dz/dt = K_p e / T_i + (OP - v) / T_t               tracking: back-calculation (T_t = 0: T_i, inf: none)

Parameters p = K_p, T_i, low, high, T_t, action.  The mode d[0] says where OP is: 0 free, +-1 at the high or low limit,
+-2 leaving it, +-3 riding it (conditional integration, see pi).  Reaching and leaving a limit are located events.
See also: pi (continuous PI), pid (with derivative action), anti_surge (with a gain that grows).
"""

from typing import Any

import numpy as np
from stickslip.blocks.block import Block, Floats
from stickslip.blocks.limits import FREE, HIGH, LOW, MODES, limit_events
from stickslip.blocks.role import Role


def limited(e: float, z: float, p: Any) -> float:
    """Return OP at the error ``e`` without its sign and the integral part ``z``."""
    OP: float = min(max(p[0] * p[5] * e + z, p[2]), p[3])
    return OP


def limited_output(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    """Write OP."""
    y[0] = limited(u[0] - u[1], x[0], p)


def tracking_rate(t: float, x: Any, d: Any, u: Any, p: Any, dx: Any) -> None:
    """Write dz/dt with back-calculation."""
    drive = p[0] * p[5] * (u[0] - u[1])
    dx[0] = drive / p[1]
    if d[0] != FREE:
        limit = p[3] if d[0] > FREE else p[2]
        dx[0] += (limit - drive - x[0]) / (p[4] if p[4] > 0.0 else p[1])


def output_events(t: float, x: Any, d: Any, u: Any, p: Any, g: Any) -> None:
    """Write the two event functions: OP reaches its high or low limit, or leaves it."""
    limit_events(p[0] * p[5] * (u[0] - u[1]) + x[0], p[2], p[3], d, g)


class LimitedController(Block):
    """A controller with p[2], p[3] = low, high; python-control sees the mode that the present values call for."""

    role = Role.CONTROLLER
    modes = MODES
    limit_params = ("low", "high")

    def unlimited(self, x: Floats, u: Floats) -> float:
        """Return v."""
        raise NotImplementedError

    def seen_memory(self, x: Floats, u: Floats) -> Floats:
        """Return the mode, shape (1,): where v lies."""
        v = self.unlimited(x, u)
        return np.array([HIGH if v > self._p_now[3] else LOW if v < self._p_now[2] else FREE])

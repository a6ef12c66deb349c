"""Kernels of a PI controller with limited output, shared by the controllers that are built on one.

    v = K_p e + z,   OP = v limited to low ... high,   e = action (u_0 - u_1)
    dz/dt = K_p e / T_i + (OP - v) / T_t               tracking: back-calculation (T_t = 0: T_i, inf: none)

Parameters p = K_p, T_i, low, high, T_t, action.  The mode d[0] says where OP is: 0 free, +-1 at the high or low limit,
+-2 leaving it, +-3 riding it (conditional integration, see pi).  Reaching and leaving a limit are located events.
See also: pi (continuous PI), anti_surge (with a gain that grows).
"""

from typing import Any

FREE, HIGH, LOW = 0.0, 1.0, -1.0
RIDING = 3.0  # times +-1: held at the limit exactly


def limited_output(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    """Write OP."""
    if d[0] == RIDING:
        y[0] = p[3]
    elif d[0] == -RIDING:
        y[0] = p[2]
    else:
        y[0] = min(max(p[0] * p[5] * (u[0] - u[1]) + x[0], p[2]), p[3])


def tracking_rate(t: float, x: Any, d: Any, u: Any, p: Any, dx: Any) -> None:
    """Write dz/dt with back-calculation."""
    drive = p[0] * p[5] * (u[0] - u[1])
    dx[0] = drive / p[1]
    if d[0] != FREE:
        limit = p[3] if d[0] > FREE else p[2]
        dx[0] += (limit - drive - x[0]) / (p[4] if p[4] > 0.0 else p[1])


def limit_events(t: float, x: Any, d: Any, u: Any, p: Any, g: Any) -> None:
    """Write the two event functions: high and low limit reached, or the limit left."""
    v = p[0] * p[5] * (u[0] - u[1]) + x[0]
    if d[0] == FREE:
        g[0] = v - p[3]
        g[1] = p[2] - v
    else:
        g[0] = p[3] - v if d[0] > FREE else v - p[2]
        g[1] = -1.0


def limit_transition(t: float, x: Any, d: Any, u: Any, p: Any, k: Any) -> None:
    """Change the mode after event ``k[0]``."""
    if d[0] != FREE:
        d[0] = FREE
    else:
        d[0] = HIGH if k[0] == 0.0 else LOW

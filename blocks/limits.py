"""A value that is kept between a low and a high limit: its modes, and the events at which it reaches or leaves one.

    free                        low <= v <= high       event: v > high, or v < low
    at high (low) limit         v beyond that limit    event: v back within

Shared by blocks with limits, so that each limit is located in the same way; v is what the value would be without.
See also: saturation, dead_zone, sensor, limited_pi, gas_turbine.
"""

from typing import Any

FREE, HIGH, LOW = 0.0, 1.0, -1.0
MODES = {"free": FREE, "at high limit": HIGH, "at low limit": LOW}


def limit_events(v: float, low: float, high: float, d: Any, g: Any) -> None:
    """Write the two event functions: high and low limit reached, or the limit left (mode ``d[0]``)."""
    if d[0] == FREE:
        g[0] = v - high
        g[1] = low - v
    else:
        g[0] = high - v if d[0] > FREE else v - low
        g[1] = -1.0


def limit_transition(t: float, x: Any, d: Any, u: Any, p: Any, k: Any) -> None:
    """Change the mode ``d[0]`` after event ``k[0]`` (kernel)."""
    if d[0] != FREE:
        d[0] = FREE
    else:
        d[0] = HIGH if k[0] == 0.0 else LOW

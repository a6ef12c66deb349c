"""A value that is kept between a low and a high limit: its modes, and the events at which it reaches or leaves one.

    free                        low <= v <= high       event: v > high + band, or v < low - band
    at high (low) limit         v beyond that limit    event: v back within by more than the band

The band, 1e-12 (1 + |limit|), keeps rounding from switching modes: a value that rests on its limit differs from it by
next to nothing, and without a band several that feel each other free and catch each other for ever.

Shared by blocks with limits, so that each limit is located in the same way; v is what the value would be without.
See also: saturation, dead_zone, sensor, limited_pi, gas_turbine.
"""

from typing import Any

BAND = 1e-12  # half width of the switching band around a limit, relative
FREE, HIGH, LOW = 0.0, 1.0, -1.0
MODES = {"free": FREE, "at high limit": HIGH, "at low limit": LOW}


def limit_events(v: float, low: float, high: float, d: Any, g: Any) -> None:
    """Write the two event functions: high and low limit reached, or the limit left (mode ``d[0]``)."""
    if d[0] == FREE:
        g[0] = v - high - BAND * (1.0 + abs(high))
        g[1] = low - v - BAND * (1.0 + abs(low))
    else:
        limit = high if d[0] > FREE else low
        g[0] = (limit - v if d[0] > FREE else v - limit) - BAND * (1.0 + abs(limit))
        g[1] = -1.0


def limit_transition(t: float, x: Any, d: Any, u: Any, p: Any, k: Any) -> None:
    """Change the mode ``d[0]`` after event ``k[0]`` (kernel)."""
    if d[0] != FREE:
        d[0] = FREE
    else:
        d[0] = HIGH if k[0] == 0.0 else LOW

"""Numbers of a valve, a sensor, a controller and a planned load, each with its unit; ``instruments`` runs them.

The neutral value of every parameter is its default: with defaults a part does what the data sheets say.
"""

from typing import NamedTuple


class Valve(NamedTuple):
    """A control valve; travel and flow in shares of full."""

    S: float = 0.0  # deadband and stickband [-]
    J: float = 0.0  # slip jump [-]
    leak: float = 0.0  # flow that passes at any opening [-]
    low: float = 0.0  # stops [-]
    high: float = 1.0
    up: float = 1e9  # fastest opening and closing [1/s]
    down: float = 1e9
    tau: float = 0.0  # lag of the positioner [s]
    gain: float = 1.0  # factor of the flow [-]
    R: float = 1.0  # rangeability, 1 is linear [-]
    resolution: float = 0.0  # outside: the positioner takes whole steps of OP only [-]
    sag: float = 0.0  # outside: a leaking bellows pulls the stem shut until it is renewed every 10 min [1/s]
    overshoot: float = 0.0  # outside: the stem swings about where it is sent; natural period [s], damping 0.2


class Sensor(NamedTuple):
    """A transmitter; in the unit of its signal."""

    sd: float = 0.0  # noise, new at each scan
    tau: float = 0.0  # lag [s]
    bias: float = 0.0
    drift: float = 0.0  # [unit/h]
    span: float = 1.0
    noise: float = 1.0  # factor of the noise [-]
    step: float = 0.0
    low: float = -1e30
    high: float = 1e30
    play: float = 0.0  # outside: hysteresis of the element
    grows: float = 0.0  # outside: noise is larger by this share per unit that the signal is above ``grows_from``
    grows_from: float = 0.0
    falls: float = 0.0  # outside: the lag of a falling signal is longer by so much [s]
    freezes: float = 0.0  # outside: share of scans at which the reading freezes, for ``frozen`` scans
    frozen: float = 30.0
    exception: float = 0.0  # outside: reports only changes beyond this


class PI(NamedTuple):
    """A controller that scans; ``K`` in shares of OP per unit of PV, negative where OP has to fall as SP rises."""

    K: float = 1.0
    T_i: float = 1.0
    scan: float = 1.0
    low: float = 0.0
    high: float = 1.0
    tau: float = 0.0  # first-order filter on the error [s]
    leaks: float = 0.0  # outside: the integral decays towards the output at rest [1/s]
    rest: float = 0.0
    squares: float = 0.0  # outside: the gain grows by this share per unit of |e|
    slew: float = 1e9  # outside: fastest OP [1/s]; the integral does not know of it
    misses: float = 0.0  # outside: share of scans that are not executed
    stops: float = 0.0  # 1: the integral stands still while OP is at a limit, in place of following it


class Feed(NamedTuple):
    """What a plan adds to the load, in its unit."""

    sine: float = 0.0
    period: float = 100.0
    step: float = 0.0
    at: float = 0.0
    slug: float = 0.0

"""Low-pressure steam header, let down from high pressure: a valve that chokes feeds heaters whose walls condense it.

    3 dp/dt = 5 f g - q - load           p header [bar absolute], steam flows and load [kg/s], t [s],
                                         f flow share of the let-down valve, linear
    g  = 1 up to p = 6, sqrt(1 - ((p - 6)/6)^2) from 6 to 12 bar: choked below half of the 12 bar before the valve
    q  = 0.09 (Ts - Tw)                  what condenses on the walls;  Ts = 100 p^0.25 saturation [degC]
    20 dTw/dt = Ts - Tw - 0.5 (Tw - 60)  Tw walls of the heaters [degC], which heat water of 60 degC

Blocks     controller, valve (let-down: OP to f), process (header, choking and heaters: f to p), sensor, feed (load is
           steam that others draw beyond their mean, from the header in process)
Numbers    as above; at 5 bar the valve stands at 0.537, at 9 bar at 0.784.  p stays below 12 bar.
Controller reverse acting: K = 0.12 of full OP per bar (12 % OP per bar), T_i = 8 s, OP 0 to 100 %, scan 0.2 s
Valve      positioner of first order, 0.4 s
Sensor     lag 0.3 s, noise 0.012 bar; range 0 to 12 bar
Load       AR(1), standard deviation 0.12 kg/s, time constant 15 s
Log        SP [bar], PV [bar] rounded to 0.005, OP [%] rounded to 0.05; a row every 1 s for 1 h
Set points 4.5 to 9 bar, a move every 4 min on average
Nonlinear: choked and not, and the saturation curve.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from benchmarks.foreign.instruments import feel, kept, pi, pi_at, planned, read, sensor_at, stem, stem_at, through
from benchmarks.foreign.parts import PI, Feed, Sensor, Valve
from benchmarks.foreign.plant import Effect, Load, Moves, Plant


class Process(NamedTuple):
    """Capacity [kg/bar], full flow when choked [kg/s], pressure before the valve [bar], heaters."""

    capacity: float = 3.0
    full: float = 5.0
    before: float = 12.0
    condenses: float = 0.09
    wall: float = 20.0
    gives: float = 0.5
    water: float = 60.0


class Faults(NamedTuple):
    """Travel that a bar across the plug takes [1/bar]; period of a ringing line [s]; error that is ignored [bar]."""

    pushed: float = 0.0
    rings: float = 0.0
    ignored: float = 0.0


class Parameters(NamedTuple):
    """All of it."""

    controller: PI = PI(K=0.12, T_i=8.0, scan=0.2)
    valve: Valve = Valve(tau=0.4)
    process: Process = Process()
    sensor: Sensor = Sensor(sd=0.012, tau=0.3)
    feed: Feed = Feed()
    faults: Faults = Faults()


@njit(cache=True)
def passes(before, p):
    """Return the flow of a valve over its choked flow."""
    over = 2.0 * min(max(p / before, 0.5), 1.0) - 1.0
    return np.sqrt(1.0 - over * over)


@njit(cache=True)
def run(p, sp, load, noise, luck, dt, first, every, out):
    """Run the plant; see ``Plant``."""
    c, g, bad = p.controller, p.process, p.faults
    scan = round(c.scan / dt)
    P = sp[0, 0]
    wall = (100.0 * P**0.25 + g.gives * g.water) / (1.0 + g.gives)
    op = g.condenses * (100.0 * P**0.25 - wall) / (g.full * passes(g.before, P))
    pv, seen = P, P
    held, x, m = pi_at(op), stem_at(op), sensor_at(P)
    line, swing = P, 0.0
    for i in range(sp.shape[1]):
        t = (i - first) * dt
        if i % scan == 0:
            k = int(i * dt / 0.2 + 1e-6)
            seen = sp[0, i]
            pv = read(p.sensor, m, noise[0, k], luck[k], t)
            e = seen - pv
            heard = e - min(max(e, -bad.ignored), bad.ignored)
            op = pi(c, held, heard, 0.0, 0.0, luck[k])
        kept(out, i - first, every, seen, pv, 100.0 * op)
        travel = stem(p.valve, x, op, t, dt) - bad.pushed * (g.before - P - 5.5)
        saturated = 100.0 * P**0.25
        condensed = g.condenses * (saturated - wall)
        drawn = load[0, int(i * dt)] + planned(p.feed, t)
        flow = g.full * through(p.valve, min(max(travel, 0.0), 1.0)) * passes(g.before, P)
        P = max(P + dt / g.capacity * (flow - condensed - drawn), 0.5)
        wall += dt / g.wall * (saturated - wall - g.gives * (wall - g.water))
        if bad.rings > 0.0:
            w = 2.0 * np.pi / bad.rings
            swing += dt * (w * w * (P - line) - 0.2 * w * swing)
            line += dt * swing
        else:
            line = P
        feel(p.sensor, m, line, dt)


PLANT = Plant(
    "steam_header", Parameters(), run,
    tags={"SP": 0.01, "PV": 0.005, "OP": 0.05},
    set_points=(Moves(4.5, 9.0, 240.0, 6.5),), loads=(Load(0.12, 15.0),), sensors=("sensor",),
    hours=1.0, dt=0.02, scan=0.2, row=1.0, warm=120.0,
    alike={"valve_gain": (("process_gain", "process"),), "positioner_lag": (("second_lag", "process"),)},
    effects={
        "stiction": Effect("valve", lambda s: {"valve.S": 0.04 * s, "valve.J": 0.015 * s}),
        "deadband": Effect("valve", lambda s: {"valve.S": 0.03 * s}),
        "positioner_lag": Effect("valve", lambda s: {"valve.tau": 0.4 + 2.0 * s}),
        "valve_gain": Effect("valve", lambda s: {"valve.gain": 1.12**s}, signed=True),
        "valve_characteristic": Effect("valve", lambda s: {"valve.R": 1.0 + 1.5 * s}),
        "sensor_bias": Effect("sensor", lambda s: {"sensor.bias": 0.4 * s}, signed=True),
        "sensor_lag": Effect("sensor", lambda s: {"sensor.tau": 0.3 + 2.0 * s}),
        "controller_gain": Effect("controller", lambda s: {"controller.K": 0.12 * 1.6**s}, signed=True),
        "scan_time": Effect("controller", lambda s: {"controller.scan": 0.2 * max(round(8.0 * s), 1)}),
        "slug": Effect("feed", lambda s: {"feed.slug": 0.4 * s, "feed.period": 45.0}),
    },
    outside={
        # the plug is not balanced: what drops across it pushes it
        "plug_is_pushed": Effect("valve", lambda s: {"faults.pushed": 0.02 * s}),
        # gas in the impulse line: it rings
        "ringing_line": Effect("sensor", lambda s: {"faults.rings": 5.0 * s**0.5}),
        # somebody has chosen a gap: a small error counts nothing
        "gap_action": Effect("controller", lambda s: {"faults.ignored": 0.25 * s}),
    },
)  # fmt: skip

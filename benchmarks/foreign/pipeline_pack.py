"""Gas pipeline in two halves: a valve lets gas in from a station, and the pressure where customers draw is held.

    200 dp1/dt = w_in - w                  p1 first half, p2 second half [bar absolute]; flows and load [kg/s]; t [s]
    300 dp2/dt = w - 12 - load
    w_in = 0.6 f sqrt(60^2 - p1^2)         60 bar at the station;  f = x^2, flow share of travel x: parabolic trim
    w    = 0.6 sqrt(p1^2 - p2^2)

Blocks     controller, valve (inlet: OP to f), process (pipeline: f to p2), sensor (of p2), feed (load is what
           customers draw beyond 12 kg/s, from p2 in process)
Numbers    as above; at 36 bar the valve stands at 0.677, at 40 bar at 0.707, at 44 bar at 0.750.  Flows never turn.
Controller reverse acting: K = 0.05 of full OP per bar, T_i = 1200 s, OP 0 to 1, scan 8 s
Valve      travel x is where OP wants it
Sensor     noise 0.03 bar; range 0 to 80 bar
Load       AR(1), standard deviation 0.6 kg/s, time constant 600 s
Log        SP [bar], PV [bar] rounded to 0.02, OP [0 to 1] rounded to 0.001; a row every 60 s for 24 h, so rows fall
           between scans
Set points 36 to 44 bar, a move every 2 h on average
Nonlinear: trim and both flows; what customers draw is not held by the pressure, so the pack integrates it.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from benchmarks.foreign.instruments import feel, kept, pi, pi_at, planned, read, sensor_at, stem, stem_at, through
from benchmarks.foreign.parts import PI, Feed, Sensor, Valve
from benchmarks.foreign.plant import Effect, Load, Moves, Plant

HELD = 64  # scans that a controller can be late


class Process(NamedTuple):
    """Packs [kg/bar], station [bar], conductance of valve and line [kg/(s bar)], mean draw [kg/s]."""

    first: float = 200.0
    second: float = 300.0
    station: float = 60.0
    inlet: float = 0.6
    line: float = 0.6
    draw: float = 12.0
    settles: float = 0.0


class Faults(NamedTuple):
    """Scans by which the controller's reading is old; time that the stem is locked every 3 h [s]."""

    stale: float = 0.0
    locked: float = 0.0


class Parameters(NamedTuple):
    """All of it."""

    controller: PI = PI(K=0.05, T_i=1200.0, scan=8.0)
    valve: Valve = Valve()
    process: Process = Process()
    sensor: Sensor = Sensor(sd=0.03)
    feed: Feed = Feed()
    faults: Faults = Faults()


@njit(cache=True)
def run(p, sp, load, noise, luck, dt, first, every, out):
    """Run the plant; see ``Plant``."""
    c, g, bad = p.controller, p.process, p.faults
    scan = round(c.scan / dt)
    p2 = sp[0, 0]
    p1 = np.sqrt(p2**2 + (g.draw / g.line) ** 2)
    op = np.sqrt(g.draw / (g.inlet * np.sqrt(g.station**2 - p1**2)))
    pv, seen = p2, p2
    held, x, m = pi_at(op), stem_at(op), sensor_at(p2)
    was, wanted, scanned = np.full(HELD, p2), op, 0
    for i in range(sp.shape[1]):
        t = (i - first) * dt
        if i % scan == 0:
            k = int(i * dt / 8.0 + 1e-6)
            seen = sp[0, i]
            pv = read(p.sensor, m, noise[0, k], luck[k], t)
            was[scanned % HELD] = pv
            op = pi(c, held, seen, was[(scanned - int(bad.stale)) % HELD], 0.0, luck[k])
            scanned += 1
        kept(out, i - first, every, seen, pv, op)
        if not (t >= 0.0 and t % 10800.0 < bad.locked):
            wanted = op
        f = through(p.valve, stem(p.valve, x, wanted, t, dt) ** 2)
        w = g.line * np.sqrt(max(p1**2 - p2**2, 0.0))
        w *= 1.0 - g.settles * min(max((15.0 - w) / 4.0, 0.0), 1.0)
        drawn = g.draw + load[0, int(i * dt)] + planned(p.feed, t)
        p1 += dt / g.first * (g.inlet * f * np.sqrt(max(g.station**2 - p1**2, 0.0)) - w)
        p2 = max(p2 + dt / g.second * (w - drawn), 1.0)
        feel(p.sensor, m, p2, dt)


PLANT = Plant(
    "pipeline_pack", Parameters(), run,
    tags={"SP": 0.01, "PV": 0.02, "OP": 0.001},
    set_points=(Moves(36.0, 44.0, 7200.0, 40.0),), loads=(Load(0.6, 600.0),), sensors=("sensor",),
    hours=24.0, dt=0.5, scan=8.0, row=60.0, warm=7200.0,
    alike={"valve_gain": (("process_gain", "process"),)},
    effects={
        "stiction": Effect("valve", lambda s: {"valve.S": 0.05 * s, "valve.J": 0.02 * s}),
        "deadband": Effect("valve", lambda s: {"valve.S": 0.04 * s}),
        # a motor drives the stem
        "valve_rate_limit": Effect("valve", lambda s: {"valve.up": 3e-4 / s, "valve.down": 3e-4 / s}),
        "valve_leak": Effect("valve", lambda s: {"valve.leak": 0.06 * s}),
        "valve_gain": Effect("valve", lambda s: {"valve.gain": 1.15**s}, signed=True),
        "sensor_span": Effect("sensor", lambda s: {"sensor.span": 1.0 + 0.04 * s}, signed=True),
        "sensor_drift": Effect("sensor", lambda s: {"sensor.drift": 0.1 * s}, signed=True),
        "quantisation": Effect("sensor", lambda s: {"sensor.step": 0.8 * s}),
        "compression": Effect("historian", lambda s: {"compression.PV": 0.5 * s}, log=True),
        "controller_gain": Effect("controller", lambda s: {"controller.K": 0.05 * 1.6**s}, signed=True),
        "sine_disturbance": Effect("feed", lambda s: {"feed.sine": 1.2 * s, "feed.period": 3000.0}),
    },
    outside={
        # liquid settles in the low spots at small flow
        "liquid_settles": Effect("process", lambda s: {"process.settles": 0.35 * s}),
        # a slow bus: the controller has a reading of some scans ago, and the log the fresh one
        "stale_input": Effect("controller", lambda s: {"faults.stale": max(round(18.0 * s), 1) if s else 0.0}),
        # the lock-up relay trips every 3 h, and the stem stays where it is
        "lock_up": Effect("valve", lambda s: {"faults.locked": 1800.0 * s}),
    },
)  # fmt: skip

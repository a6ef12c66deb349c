"""A vessel with a conical wall, drained by gravity through the control valve: area and outflow go with the level.

    pi (0.4 h)^2 dh/dt = 0.02 + load - 0.03 x sqrt(h)       h level above the tip [m], flows [m3/s], t [s]
                                                            x flow share of the outlet valve, linear
Blocks     controller, valve (outlet), process (cone and what flows out of it), sensor, feed (adds to the inflow)
Numbers    as above; the valve stands at 0.67 at 1 m and at 0.43 at 2.4 m; the cone is 3 m high
Controller direct acting: K = -0.4 of full OP per m, T_i = 300 s, OP 0 to 100 %, scan 2 s.  Where K e + I, with the
           new I, is beyond a limit, OP is at that limit and I stays what it was at the scan before.
Sensor     noise 0.004 m; range 0 to 3 m
Load       AR(1), standard deviation 0.0006 m3/s, time constant 400 s
Log        SP [m], PV [m] rounded to 0.002, OP [%] rounded to 0.1; a row every 37 s for 16 h
Set points 1.0 to 2.4 m, a move every 70 min on average
Nonlinear: the area, the root, and their product with the opening.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from benchmarks.foreign.instruments import feel, kept, pi_at, planned, scanned, sensor_at, stem, stem_at, through
from benchmarks.foreign.parts import PI, Feed, Sensor, Valve
from benchmarks.foreign.plant import Effect, Load, Moves, Plant


class Process(NamedTuple):
    """Radius per height [-], inflow [m3/s], flow coefficient [m2.5/s]."""

    slope: float = 0.4
    inflow: float = 0.02
    k: float = 0.03
    vortex: float = 0.0


class Parameters(NamedTuple):
    """All of it."""

    controller: PI = PI(K=-0.4, T_i=300.0, scan=2.0, stops=1.0)
    valve: Valve = Valve()
    process: Process = Process()
    sensor: Sensor = Sensor(sd=0.004)
    feed: Feed = Feed()


@njit(cache=True)
def run(p, sp, load, noise, luck, dt, first, every, out):
    """Run the plant; see ``Plant``."""
    g, scan, h = p.process, round(p.controller.scan / dt), sp[0, 0]
    op = g.inflow / (g.k * np.sqrt(h))
    pv, seen = h, h
    held, x, m = pi_at(op), stem_at(op), sensor_at(h)
    for i in range(sp.shape[1]):
        t = (i - first) * dt
        if i % scan == 0:
            seen, pv, op = scanned(p, held, m, sp[0, i], noise[0], luck, int(i * dt / 2.0 + 1e-6), t)
        kept(out, i - first, every, seen, pv, 100.0 * op)
        gone = g.k * through(p.valve, stem(p.valve, x, op, t, dt)) * np.sqrt(h)
        gone *= 1.0 - g.vortex * max(1.5 - h, 0.0) / 0.5
        area = np.pi * (g.slope * h) ** 2
        h = max(h + dt / area * (g.inflow + load[0, int(i * dt)] + planned(p.feed, t) - gone), 0.05)
        feel(p.sensor, m, h, dt)


PLANT = Plant(
    "cone", Parameters(), run,
    tags={"SP": 0.01, "PV": 0.002, "OP": 0.1},
    set_points=(Moves(1.0, 2.4, 4200.0, 1.7),), loads=(Load(0.0006, 400.0),), sensors=("sensor",),
    hours=16.0, dt=0.2, scan=2.0, row=37.0, warm=2400.0,
    effects={
        "stiction": Effect("valve", lambda s: {"valve.S": 0.05 * s, "valve.J": 0.02 * s}),
        "deadband": Effect("valve", lambda s: {"valve.S": 0.05 * s}),
        "valve_leak": Effect("valve", lambda s: {"valve.leak": 0.05 * s}),
        "valve_gain": Effect("valve", lambda s: {"valve.gain": 1.12**s}, signed=True),
        "valve_saturation": Effect("valve", lambda s: {"valve.high": 0.7 - 0.08 * s}),
        "sensor_bias": Effect("sensor", lambda s: {"sensor.bias": 0.2 * s}, signed=True),
        "sensor_drift": Effect("sensor", lambda s: {"sensor.drift": 0.03 * s}, signed=True),
        "quantisation": Effect("sensor", lambda s: {"sensor.step": 0.05 * s}),
        "compression": Effect("historian", lambda s: {"compression.PV": 0.03 * s}, log=True),
        "controller_integral_time": Effect("controller", lambda s: {"controller.T_i": 300.0 * 2.0**s}, signed=True),
        "step_disturbance": Effect("feed", lambda s: {"feed.step": 0.003 * s, "feed.at": 30000.0}, signed=True),
    },
    outside={
        # the displacer sticks in its tube
        "hysteresis": Effect("sensor", lambda s: {"sensor.play": 0.06 * s}),
        # a vortex below 1.5 m: less flows out
        "vortex": Effect("process", lambda s: {"process.vortex": 0.15 * s}),
        # somebody has chosen the squared error
        "squared_error": Effect("controller", lambda s: {"controller.squares": 2.5 * s}),
    },
)  # fmt: skip

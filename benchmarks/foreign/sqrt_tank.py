"""Level of a tank that empties through a hole, under an analogue PI: the outflow goes with the root of the level.

    2 dh/dt = 0.04 x + load - 0.02 sqrt(h)         h [m], flows [m3/s], x flow share of the inlet valve, linear

Blocks     controller, valve (inlet), process (tank and hole), sensor, feed (adds to the inflow of process)
Numbers    as above; at 1 m the valve stands at 0.5, and the tank's time constant is 200 s
Controller continuous (analogue): K = 1.2 of full OP per m, T_i = 80 s, OP 0 to 100 %; at a limit the integral follows
Sensor     noise 0.003 m, new every 0.5 s and held in between, on a value that is continuous; range 0 to 2 m
Load       AR(1), standard deviation 0.0008 m3/s, time constant 120 s
Log        SP [m], PV [m] rounded to 0.001, OP [%] rounded to 0.05; a row every 4 s for 3 h; values of that instant
Set points 0.6 to 1.5 m, a move every 15 min on average
Nonlinear: the root.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from benchmarks.foreign.instruments import feel, kept, pi, pi_at, planned, read, sensor_at, stem, stem_at, through
from benchmarks.foreign.parts import PI, Feed, Sensor, Valve
from benchmarks.foreign.plant import Effect, Load, Moves, Plant

DT = 0.05


class Process(NamedTuple):
    """Cross section [m2], flow of the open valve [m3/s], outflow [m2.5/s]."""

    A: float = 2.0
    q: float = 0.04
    c: float = 0.02
    clogs: float = 0.0


class Parameters(NamedTuple):
    """All of it."""

    controller: PI = PI(K=1.2, T_i=80.0, scan=DT)
    valve: Valve = Valve()
    process: Process = Process()
    sensor: Sensor = Sensor(sd=0.003)
    feed: Feed = Feed()


@njit(cache=True)
def run(p, sp, load, noise, luck, dt, first, every, out):
    """Run the plant; see ``Plant``."""
    c, g = p.controller, p.process
    scan = round(c.scan / dt)
    h = sp[0, 0]
    op = g.c * np.sqrt(h) / g.q
    pv = h
    held, x, m = pi_at(op), stem_at(op), sensor_at(h)
    for i in range(sp.shape[1]):
        t = (i - first) * dt
        k = int(i * dt / 0.5 + 1e-6)
        pv = read(p.sensor, m, noise[0, k], luck[k], t)
        if i % scan == 0:
            op = pi(c, held, sp[0, i], pv, 0.0, luck[k])
        kept(out, i - first, every, sp[0, i], pv, 100.0 * op)
        flow = g.q * through(p.valve, stem(p.valve, x, op, t, dt)) + load[0, int(i * dt)] + planned(p.feed, t)
        hole = g.c * (1.0 - g.clogs * ((t / 2400.0) % 1.0))
        h = max(h + dt / g.A * (flow - hole * np.sqrt(h)), 1e-4)
        feel(p.sensor, m, h, dt)


PLANT = Plant(
    "sqrt_tank", Parameters(), run,
    tags={"SP": 0.001, "PV": 0.001, "OP": 0.05},
    set_points=(Moves(0.6, 1.5, 900.0, 1.0),), loads=(Load(0.0008, 120.0),), sensors=("sensor",),
    hours=3.0, dt=DT, scan=0.5, row=4.0, warm=600.0,
    effects={
        "stiction": Effect("valve", lambda s: {"valve.S": 0.04 * s, "valve.J": 0.015 * s}),
        "deadband": Effect("valve", lambda s: {"valve.S": 0.04 * s}),
        "positioner_lag": Effect("valve", lambda s: {"valve.tau": 10.0 * s}),
        "valve_leak": Effect("valve", lambda s: {"valve.leak": 0.05 * s}),
        "valve_gain": Effect("valve", lambda s: {"valve.gain": 1.12**s}, signed=True),
        "sensor_bias": Effect("sensor", lambda s: {"sensor.bias": 0.15 * s}, signed=True),
        "sensor_lag": Effect("sensor", lambda s: {"sensor.tau": 10.0 * s}),
        "controller_gain": Effect("controller", lambda s: {"controller.K": 1.2 * 1.4**s}, signed=True),
        "scan_time": Effect("controller", lambda s: {"controller.scan": DT * round(10.0 * s / DT)}),
        "step_disturbance": Effect("feed", lambda s: {"feed.step": 0.004 * s, "feed.at": 5000.0}, signed=True),
    },
    outside={
        # the hole clogs for 40 min until it is flushed
        "clogs": Effect("process", lambda s: {"process.clogs": 0.25 * s}),
        # the float hangs: hysteresis
        "hysteresis": Effect("sensor", lambda s: {"sensor.play": 0.03 * s}),
        # OP is held to a speed
        "slew": Effect("controller", lambda s: {"controller.slew": 0.05 / s}),
    },
)  # fmt: skip

"""Flow of a centrifugal pump through an equal-percentage valve: pump curve, static head, inertia of the pipe.

    3 dQ/dt = 60 - 0.002 Q^2 - (15 + load) - (Q / (20 f))^2         heads in m, Q [m3/h], t [s]
    f = 40^(x - 1)                                                   x travel of the stem, 0 to 1

Blocks     controller, valve (positioner, stem, body), process (pump and pipe), sensor, feed (into the static head)
Numbers    as above: shut-off head 60 m, static head 15 m, flow coefficient 20 m3/h per root m, inertia 3 m s h/m3;
           at 60 m3/h the valve stands at 0.806, at 30 m3/h at 0.60.  Flow never turns back.
Controller K = 0.002 of full OP per m3/h (0.2 % OP per m3/h), T_i = 3 s, OP 0 to 100 %, scan 1 s
Valve      positioner of first order, 1.2 s
Sensor     lag 0.5 s, noise 0.25 m3/h; range 0 to 120 m3/h
Load       AR(1), standard deviation 0.5 m, time constant 60 s
Log        SP [m3/h], PV [m3/h] rounded to 0.05, OP [%] rounded to 0.02; a row every 5 s for 2 h
Set points 30 to 75 m3/h, a move every 10 min on average
Nonlinear: pump curve, valve, square of the flow.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from benchmarks.foreign.instruments import feel, kept, pi_at, planned, scanned, sensor_at, stem, stem_at
from benchmarks.foreign.parts import PI, Feed, Sensor, Valve
from benchmarks.foreign.plant import Effect, Load, Moves, Plant


class Process(NamedTuple):
    """Heads [m], curve [m h2/m6], inertia [m s h/m3], coefficient [m3/h per root m]."""

    head: float = 60.0
    curve: float = 0.002
    static: float = 15.0
    inertia: float = 3.0
    coefficient: float = 20.0
    chokes: float = 0.0
    zero: float = 0.0


class Parameters(NamedTuple):
    """All of it."""

    controller: PI = PI(K=0.002, T_i=3.0)
    valve: Valve = Valve(tau=1.2, R=40.0)
    process: Process = Process()
    sensor: Sensor = Sensor(sd=0.25, tau=0.5)
    feed: Feed = Feed()


@njit(cache=True)
def run(p, sp, load, noise, luck, dt, first, every, out):
    """Run the plant; see ``Plant``."""
    c, g, v = p.controller, p.process, p.valve
    scan = round(c.scan / dt)
    Q = sp[0, 0]
    op = 1.0 + np.log(Q / (g.coefficient * np.sqrt(g.head - g.static - g.curve * Q * Q))) / np.log(v.R)
    pv, seen = Q, Q
    held = pi_at(op)
    x = stem_at(op)
    m = sensor_at(Q)
    for i in range(sp.shape[1]):
        t = (i - first) * dt
        if i % scan == 0:
            seen, pv, op = scanned(p, held, m, sp[0, i], noise[0], luck, int(i * dt + 1e-6), t)
        kept(out, i - first, every, seen, pv, 100.0 * op)
        f = v.gain * v.R ** (stem(v, x, op, t, dt) - 1.0) * (1.0 - g.chokes * (Q / 80.0) ** 4) + v.leak
        against = g.static + load[0, int(i * dt)] + planned(p.feed, t)
        # the loss in the valve is taken at the end of the step: a nearly shut valve is stiff
        ahead = g.head - g.curve * Q * Q - against
        a, b = dt / (g.inertia * (g.coefficient * f) ** 2), Q + dt / g.inertia * ahead
        Q = 0.0 if b <= 0.0 else (np.sqrt(1.0 + 4.0 * a * b) - 1.0) / (2.0 * a)
        feel(p.sensor, m, np.sqrt(Q * Q + g.zero), dt)


PLANT = Plant(
    "pump_flow", Parameters(), run,
    tags={"SP": 0.01, "PV": 0.05, "OP": 0.02},
    set_points=(Moves(30.0, 75.0, 600.0, 60.0),), loads=(Load(0.5, 60.0),), sensors=("sensor",),
    hours=2.0, dt=0.05, scan=1.0, row=5.0, warm=120.0,
    effects={
        "stiction": Effect("valve", lambda s: {"valve.S": 0.02 * s, "valve.J": 0.008 * s}),
        "deadband": Effect("valve", lambda s: {"valve.S": 0.01 * s}),
        # the positioner of the sheet gets slower
        "positioner_lag": Effect("valve", lambda s: {"valve.tau": 1.2 + 3.0 * s}),
        "valve_gain": Effect("valve", lambda s: {"valve.gain": 1.035**s}, signed=True),
        "valve_saturation": Effect("valve", lambda s: {"valve.high": 0.92 - 0.06 * s}),
        "sensor_span": Effect("sensor", lambda s: {"sensor.span": 1.0 + 0.04 * s}, signed=True),
        "quantisation": Effect("sensor", lambda s: {"sensor.step": 1.0 * s}),
        "controller_filter": Effect("controller", lambda s: {"controller.tau": 4.0 * s}),
        "controller_limits": Effect("controller", lambda s: {"controller.high": 0.92 - 0.06 * s}),
        "sine_disturbance": Effect("feed", lambda s: {"feed.sine": 2.0 * s, "feed.period": 75.0}),
    },
    outside={
        # the meter takes the root of a differential pressure whose zero is off
        "dp_zero": Effect("sensor", lambda s: {"process.zero": 100.0 * s}),
        # the fluid flashes in the valve: it passes less the larger the flow
        "chokes": Effect("valve", lambda s: {"process.chokes": 0.1 * s}),
        # a busy control system leaves out scans at random
        "missed_scans": Effect("controller", lambda s: {"controller.misses": 0.4 * s}),
    },
)  # fmt: skip

"""Exothermic reaction in a stirred tank, cooled through a valve: unstable without its controller.

    600 dc/dt = 1 - c - r;         r = c exp(8000 (1/350 - 1/T))       c of the feed is 1 [-], T [K], t [s]
    600 dT/dt = 340 + load - T + 50 r - 0.6 x (T - 290)                x flow share of the coolant valve, linear

Blocks     controller, valve (coolant), process (reactor: x to T), sensor, feed (adds to the 340 K of the feed)
Numbers    as above; at 350 K the valve stands at 0.417, at 344 K at 0.49, at 356 K at 0.35
Controller direct acting: K = -0.15 of full OP per K, T_i = 500 s, OP 0 to 100 %, scan 1 s
Sensor     lag 8 s, noise 0.06 K; range 300 to 400 K
Load       AR(1), standard deviation 0.7 K, time constant 300 s
Log        SP [K], PV [K] rounded to 0.02, OP [%] rounded to 0.1; a row every 12.5 s for 6 h
Set points 345 to 355 K, a move every 30 min on average
Nonlinear: Arrhenius, and the coolant by the difference of temperatures.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from benchmarks.foreign.instruments import feel, kept, pi_at, planned, scanned, sensor_at, stem, stem_at, through
from benchmarks.foreign.parts import PI, Feed, Sensor, Valve
from benchmarks.foreign.plant import Effect, Load, Moves, Plant


class Process(NamedTuple):
    """Residence time [s], temperatures [K], reaction, cooling."""

    tau: float = 600.0
    inlet: float = 340.0
    rise: float = 50.0
    cools: float = 0.6
    coolant: float = 290.0
    energy: float = 8000.0
    decays: float = 0.0


class Parameters(NamedTuple):
    """All of it."""

    controller: PI = PI(K=-0.15, T_i=500.0, rest=0.42)
    valve: Valve = Valve()
    process: Process = Process()
    sensor: Sensor = Sensor(sd=0.06, tau=8.0)
    feed: Feed = Feed()


@njit(cache=True)
def run(p, sp, load, noise, luck, dt, first, every, out):
    """Run the plant; see ``Plant``."""
    g, scan, T = p.process, round(p.controller.scan / dt), sp[0, 0]
    rate = np.exp(g.energy * (1.0 / 350.0 - 1.0 / T))
    conc = 1.0 / (1.0 + rate)
    op = (g.inlet - T + g.rise * rate * conc) / (g.cools * (T - g.coolant))
    pv, seen = T, T
    held, x, m = pi_at(op), stem_at(op), sensor_at(T)
    for i in range(sp.shape[1]):
        t = (i - first) * dt
        if i % scan == 0:
            seen, pv, op = scanned(p, held, m, sp[0, i], noise[0], luck, int(i * dt + 1e-6), t)
        kept(out, i - first, every, seen, pv, 100.0 * op)
        active = 1.0 - g.decays * ((max(t, 0.0) / 5400.0) % 1.0)
        r = active * conc * np.exp(g.energy * (1.0 / 350.0 - 1.0 / T))
        share = through(p.valve, stem(p.valve, x, op, t, dt))
        inlet = g.inlet + load[0, int(i * dt)] + planned(p.feed, t)
        T += dt / g.tau * (inlet - T + g.rise * r - g.cools * share * (T - g.coolant))
        conc += dt / g.tau * (1.0 - conc - r)
        feel(p.sensor, m, T, dt)


PLANT = Plant(
    "exotherm", Parameters(), run,
    tags={"SP": 0.01, "PV": 0.02, "OP": 0.1},
    set_points=(Moves(345.0, 355.0, 1800.0, 350.0),), loads=(Load(0.7, 300.0),), sensors=("sensor",),
    hours=6.0, dt=0.1, scan=1.0, row=12.5, warm=1200.0,
    effects={
        "stiction": Effect("valve", lambda s: {"valve.S": 0.08 * s, "valve.J": 0.03 * s}),
        "deadband": Effect("valve", lambda s: {"valve.S": 0.07 * s}),
        "positioner_lag": Effect("valve", lambda s: {"valve.tau": 25.0 * s}),
        "valve_gain": Effect("valve", lambda s: {"valve.gain": 1.12**s}, signed=True),
        "valve_characteristic": Effect("valve", lambda s: {"valve.R": 1.0 + 1.2 * s}),
        "sensor_bias": Effect("sensor", lambda s: {"sensor.bias": 2.0 * s}, signed=True),
        "sensor_lag": Effect("sensor", lambda s: {"sensor.tau": 8.0 + 20.0 * s}),
        "controller_gain": Effect("controller", lambda s: {"controller.K": -0.15 * 1.5**s}, signed=True),
        "controller_integral_time": Effect("controller", lambda s: {"controller.T_i": 500.0 * 1.8**s}, signed=True),
        "step_disturbance": Effect("feed", lambda s: {"feed.step": 3.0 * s, "feed.at": 11000.0}, signed=True),
    },
    outside={
        # the catalyst decays for an hour and a half, until it is renewed
        "catalyst_decays": Effect("process", lambda s: {"process.decays": 0.2 * s}),
        # the bulb is loose in its well: hysteresis
        "loose_bulb": Effect("sensor", lambda s: {"sensor.play": 0.5 * s}),
        # the integral decays towards 42 % in 20 min
        "integral_leaks": Effect("controller", lambda s: {"controller.leaks": s / 1200.0}),
    },
)  # fmt: skip

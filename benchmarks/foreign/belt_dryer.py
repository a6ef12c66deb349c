"""Belt dryer: steam heats air, the air dries granulate in three zones, and a gauge down the belt reads its moisture.

    120 dT/dt = 25 + 130 f - T                  T air [degC], t [s], f flow share of the steam valve, linear
    80 dX1/dt = 40 + load - X1 - r X1           X1, X2, X3 moisture that leaves each zone [%]
    80 dX2/dt = X1 - X2 - r X2
    80 dX3/dt = X2 - X3 - r X3                  r = 0.02 (T - 40), 0 where T is below 40;  true(t) = X3(t - 60)

Blocks     controller, valve (steam: OP to f), coil (f to T), belt (T to true: zones and 60 s of transport, all three
           zones have the same T), sensor (gauge), feed (adds to the 40 % that come onto belt)
Numbers    as above; to have 4 % the valve stands at 0.559, to have 8 % at 0.388
Controller direct acting: K = -0.02 of full OP per %, T_i = 240 s, OP 0.1 to 0.9, scan 6 s
Sensor     lag 15 s, noise 0.05 %; range 0 to 20 %
Load       AR(1), standard deviation 0.8 %, time constant 400 s
Log        SP, PV [%] rounded to 0.01, OP [0 to 1] rounded to 0.001; a row every 30 s for 14 h
Set points 4 to 8 %, a move every 50 min on average
Nonlinear: what dries goes with moisture times temperature, in each zone.  With dead time.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from benchmarks.foreign.instruments import feel, kept, pi_at, planned, scanned, sensor_at, stem, stem_at, through
from benchmarks.foreign.parts import PI, Feed, Sensor, Valve
from benchmarks.foreign.plant import Effect, Load, Moves, Plant


class Coil(NamedTuple):
    """Gain [degC], time constant [s], air that comes [degC]."""

    gain: float = 130.0
    tau: float = 120.0
    air: float = 25.0
    floods: float = 0.0


class Belt(NamedTuple):
    """Time in a zone [s], moisture that comes [%], drying [1/degC], temperature where it begins, transport [s]."""

    zone: float = 80.0
    comes: float = 40.0
    dries: float = 0.02
    wet_bulb: float = 40.0
    theta: float = 60.0


class Gauge(NamedTuple):
    """How far its calibration is bent: error 2 % off the middle, at 6 % none [%]."""

    bent: float = 0.0


class Parameters(NamedTuple):
    """All of it."""

    controller: PI = PI(K=-0.02, T_i=240.0, scan=6.0, low=0.1, high=0.9)
    valve: Valve = Valve()
    coil: Coil = Coil()
    belt: Belt = Belt()
    sensor: Sensor = Sensor(sd=0.05, tau=15.0)
    feed: Feed = Feed()
    gauge: Gauge = Gauge()


@njit(cache=True)
def run(p, sp, load, noise, luck, dt, first, every, out):
    """Run the plant; see ``Plant``."""
    c, g, b = p.controller, p.coil, p.belt
    scan = round(c.scan / dt)
    rate = (b.comes / sp[0, 0]) ** (1.0 / 3.0) - 1.0
    T = b.wet_bulb + rate / b.dries
    op = (T - g.air) / g.gain
    pv, seen, flood = sp[0, 0], sp[0, 0], 0.0
    held, x, m = pi_at(op), stem_at(op), sensor_at(pv)
    X = np.array([b.comes / (1.0 + rate), b.comes / (1.0 + rate) ** 2, sp[0, 0]])
    late = np.full(max(round(b.theta / dt), 1), sp[0, 0])
    for i in range(sp.shape[1]):
        t = (i - first) * dt
        if i % scan == 0:
            seen, pv, op = scanned(p, held, m, sp[0, i], noise[0], luck, int(i * dt / 6.0 + 1e-6), t)
        kept(out, i - first, every, seen, pv, op)
        flow = through(p.valve, stem(p.valve, x, op, t, dt))
        flood += dt / 300.0 * ((g.floods if flow < 0.46 else 0.0) - flood)
        comes = b.comes + load[0, int(i * dt)] + planned(p.feed, t)
        r = b.dries * max(T - b.wet_bulb, 0.0)
        was = comes
        for zone in range(3):
            now = X[zone]
            X[zone] += dt / b.zone * (was - now - r * now)
            was = now
        T += dt / g.tau * (g.air + g.gain * flow * (1.0 - flood) - T)
        j = i % len(late)
        true = late[j]
        late[j] = X[2]
        feel(p.sensor, m, true + p.gauge.bent * ((true - 6.0) / 2.0) ** 2, dt)


PLANT = Plant(
    "belt_dryer", Parameters(), run,
    tags={"SP": 0.01, "PV": 0.01, "OP": 0.001},
    set_points=(Moves(4.0, 8.0, 3000.0, 6.0),), loads=(Load(0.8, 400.0),), sensors=("sensor",),
    hours=14.0, dt=0.5, scan=6.0, row=30.0, warm=2400.0,
    # a load that nobody measures comes as well sooner as later, so dead time ahead of the belt is dead time behind it
    alike={"process_gain": (("valve_gain", "valve"),), "dead_time": (("dead_time", "coil"),)},
    effects={
        "stiction": Effect("valve", lambda s: {"valve.S": 0.04 * s, "valve.J": 0.015 * s}),
        "deadband": Effect("valve", lambda s: {"valve.S": 0.035 * s}),
        "valve_leak": Effect("valve", lambda s: {"valve.leak": 0.03 * s}),
        "valve_saturation": Effect("valve", lambda s: {"valve.high": 0.55 - 0.03 * s}),
        "dead_time": Effect("belt", lambda s: {"belt.theta": 60.0 + 60.0 * s}),
        "process_gain": Effect("coil", lambda s: {"coil.gain": 130.0 * 1.08**s}, signed=True),
        "process_time_constant": Effect("coil", lambda s: {"coil.tau": 120.0 * 1.6**s}, signed=True),
        "sensor_bias": Effect("sensor", lambda s: {"sensor.bias": 0.6 * s}, signed=True),
        "sensor_noise": Effect("sensor", lambda s: {"sensor.noise": 1.0 + 3.0 * s}),
        "controller_integral_time": Effect("controller", lambda s: {"controller.T_i": 240.0 * 1.7**s}, signed=True),
        "step_disturbance": Effect("feed", lambda s: {"feed.step": 4.0 * s, "feed.at": 26000.0}, signed=True),
    },
    outside={
        # the trap is too small: at small flow condensate rises in the coil
        "coil_floods": Effect("coil", lambda s: {"coil.floods": 0.12 * s}),
        # the calibration of the gauge is bent
        "bent_calibration": Effect("sensor", lambda s: {"gauge.bent": 0.3 * s}),
        # the historian shows a filtered value of OP
        "filtered_tag": Effect("historian", lambda s: {"filter.OP": 240.0 * s}, log=True),
    },
)  # fmt: skip

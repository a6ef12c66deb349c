"""Heat exchanger with dead time: steam heats a stream, and the outlet is measured down the pipe.

    dT/dt = (T_in + 80 x_s(t - 12) - T)/40        x_s = flow share of the steam valve, linear
    T_in  = 20 + load                             load [degC] enters at the inlet of the exchanger

Blocks     controller, valve (steam), process (dead time, gain, lag), sensor (thermowell), feed (into T_in of process)
Numbers    gain 80 degC per full flow, time constant 40 s, dead time 12 s between valve and exchanger, thermowell 6 s
Controller K = 0.008 of full OP per degC (0.8 % OP per degC), T_i = 45 s, OP 0 to 100 %, scan 1 s
Sensor     lag 6 s, noise 0.08 degC; range 0 to 120 degC
Load       AR(1), standard deviation 0.6 degC, time constant 180 s
Log        SP [degC], PV [degC] rounded to 0.02, OP [%] rounded to 0.05; a row every 10 s for 4 h
Set points 45 to 75 degC, a move every 25 min on average
Linear but for limits.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from benchmarks.foreign.instruments import feel, kept, pi_at, planned, scanned, sensor_at, stem, stem_at, through
from benchmarks.foreign.parts import PI, Feed, Sensor, Valve
from benchmarks.foreign.plant import Effect, Load, Moves, Plant


class Process(NamedTuple):
    """Gain [degC], time constant [s], dead time [s]; a second lag [s]."""

    gain: float = 80.0
    tau: float = 40.0
    theta: float = 12.0
    second: float = 0.0
    sag: float = 0.0
    wet: float = 0.0


class Parameters(NamedTuple):
    """All of it."""

    controller: PI = PI(K=0.008, T_i=45.0)
    valve: Valve = Valve()
    process: Process = Process()
    sensor: Sensor = Sensor(sd=0.08, tau=6.0)
    feed: Feed = Feed()


@njit(cache=True)
def run(p, sp, load, noise, luck, dt, first, every, out):
    """Run the plant; see ``Plant``."""
    c, g = p.controller, p.process
    scan = round(c.scan / dt)
    op = (sp[0, 0] - 20.0) / 80.0
    pv, seen = sp[0, 0], sp[0, 0]
    held = pi_at(op)
    x = stem_at(op)
    m = sensor_at(sp[0, 0])
    late = np.full(max(round(g.theta / dt), 1), op)
    T, T2, header = sp[0, 0], sp[0, 0], 0.0
    for i in range(sp.shape[1]):
        t = (i - first) * dt
        if i % scan == 0:
            seen, pv, op = scanned(p, held, m, sp[0, i], noise[0], luck, int(i * dt), t)
        kept(out, i - first, every, seen, pv, 100.0 * op)
        flow = through(p.valve, stem(p.valve, x, op, t, dt)) * (1.0 - header)
        header += dt / 300.0 * (g.sag * flow - header)
        j = i % len(late)
        arrives = late[j]
        late[j] = flow
        T_in = 20.0 + load[0, int(i * dt)] + planned(p.feed, t)
        heat = g.gain * arrives * (1.0 + g.wet * np.sin(2.0 * np.pi * t / 1020.0))
        T += dt / g.tau * (T_in + heat - T)
        T2 = T if g.second <= 0.0 else T2 + dt / g.second * (T - T2)
        feel(p.sensor, m, T2, dt)


PLANT = Plant(
    "heat_exchanger", Parameters(), run,
    tags={"SP": 0.001, "PV": 0.02, "OP": 0.05},
    set_points=(Moves(45.0, 75.0, 1500.0, 60.0),), loads=(Load(0.6, 180.0),), sensors=("sensor",),
    hours=4.0, dt=0.05, scan=1.0, row=10.0, warm=600.0,
    effects={
        "stiction": Effect("valve", lambda s: {"valve.S": 0.025 * s, "valve.J": 0.01 * s}),
        "deadband": Effect("valve", lambda s: {"valve.S": 0.02 * s}),
        "positioner_lag": Effect("valve", lambda s: {"valve.tau": 12.0 * s}),
        "dead_time": Effect("process", lambda s: {"process.theta": 12.0 + 8.0 * s}),
        "process_gain": Effect("process", lambda s: {"process.gain": 80.0 * 1.08**s}, signed=True),
        "process_time_constant": Effect("process", lambda s: {"process.tau": 40.0 * 1.3**s}, signed=True),
        "sensor_bias": Effect("sensor", lambda s: {"sensor.bias": 2.0 * s}, signed=True),
        "sensor_noise": Effect("sensor", lambda s: {"sensor.noise": 1.0 + 1.5 * s}),
        "controller_gain": Effect("controller", lambda s: {"controller.K": 0.008 * 1.4**s}, signed=True),
        "sine_disturbance": Effect("feed", lambda s: {"feed.sine": 2.0 * s, "feed.period": 420.0}),
    },
    outside={
        # the pressure of the header falls with the flow, 5 min late
        "steam_sag": Effect("valve", lambda s: {"process.sag": 0.12 * s}),
        # the thermowell is slower down than up
        "slow_cooling": Effect("sensor", lambda s: {"sensor.falls": 20.0 * s}),
        # condensate builds up and drains every 17 min: the heat of the steam oscillates
        "wet_steam": Effect("process", lambda s: {"process.wet": 0.06 * s}),
    },
)  # fmt: skip

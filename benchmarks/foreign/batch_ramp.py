"""Batch with ramps: steam heats a reactor along a programme of ramps and holds.

    dT/dt = x (140 - T)/900 - (T - 20)/6000 + load        T [degC], t [s], x flow share of the steam valve, linear

Blocks     controller, valve (steam), process (reactor), sensor, feed (adds to dT/dt of process)
Numbers    as above; to hold 80 degC the valve stands at 0.15, to rise by 0.5 degC/min there at 0.28
Controller K = 0.05 of full OP per degC, T_i = 900 s, OP 0 to 1, scan 5 s
Sensor     lag 30 s, noise 0.05 degC; range 0 to 150 degC
Load       AR(1), standard deviation 0.0006 degC/s, time constant 600 s
Log        SP [degC] rounded to 0.01, PV [degC] rounded to 0.02, OP [0 to 1] rounded to 0.001; a row every 60 s for 16 h
Set points hold about 25 min at 45 to 55 degC, rise by 0.3 to 0.45 degC/min to 70 to 85, hold about 40 min, fall by 0.12
           to 0.2 degC/min, and again; the set point moves on with every scan, and the log has what the controller saw
Nonlinear: what steam gives falls with the temperature; the valve cannot cool.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from benchmarks.foreign.instruments import feel, kept, pi_at, planned, scanned, sensor_at, stem, stem_at, through
from benchmarks.foreign.parts import PI, Feed, Sensor, Valve
from benchmarks.foreign.plant import Effect, Load, Plant


class Process(NamedTuple):
    """Time [s] in which open steam heats, and in which heat is lost; temperatures [degC]."""

    heats: float = 900.0
    loses: float = 6000.0
    steam: float = 140.0
    room: float = 20.0
    mass: float = 1.0
    theta: float = 0.0
    fouls: float = 0.0
    evaporates: float = 0.0


# of a rise and of a fall: the range of the level [degC], of the speed [degC/min], and the hold before it [s]
HALVES = ((70.0, 85.0, 0.3, 0.45, 1500.0), (45.0, 55.0, 0.12, 0.2, 2400.0))


class Programme(NamedTuple):
    """Ramps and holds; the first hold begins in the middle of one."""

    start: float = 50.0

    def path(self, rng: np.random.Generator, t: np.ndarray) -> np.ndarray:
        """Return the set point at ``t``."""
        when, level = [0.0], [self.start]
        while when[-1] < t[-1]:
            for low, high, slow, fast, hold in HALVES:
                to = rng.uniform(low, high)
                at = when[-1] + hold * rng.uniform(0.7, 1.3)
                when += [at, at + abs(to - level[-1]) / rng.uniform(slow, fast) * 60.0]
                level += [level[-1], to]
        return np.interp(t, when, level)


class Parameters(NamedTuple):
    """All of it."""

    controller: PI = PI(K=0.05, T_i=900.0, scan=5.0)
    valve: Valve = Valve()
    process: Process = Process()
    sensor: Sensor = Sensor(sd=0.05, tau=30.0)
    feed: Feed = Feed()


@njit(cache=True)
def run(p, sp, load, noise, luck, dt, first, every, out):
    """Run the plant; see ``Plant``."""
    g, scan, T = p.process, round(p.controller.scan / dt), sp[0, 0]
    op = (T - g.room) / g.loses * g.heats / (g.steam - T)
    pv, seen = T, T
    held, x, m = pi_at(op), stem_at(op), sensor_at(T)
    late = np.full(max(round(g.theta / dt), 1), op)
    for i in range(sp.shape[1]):
        t = (i - first) * dt
        if i % scan == 0:
            seen, pv, op = scanned(p, held, m, sp[0, i], noise[0], luck, int(i * dt / 5.0 + 1e-6), t)
        kept(out, i - first, every, seen, pv, op)
        share = through(p.valve, stem(p.valve, x, op, t, dt))
        j = i % len(late)
        was = late[j] if g.theta > 0.0 else share
        late[j] = share
        gives = was * (g.steam - T) / g.heats * (1.0 - g.fouls * ((max(t, 0.0) / 14400.0) % 1.0))
        loses = (T - g.room) / g.loses + g.evaporates * max(T - 65.0, 0.0) ** 2
        T += dt / g.mass * (gives - loses + load[0, int(i * dt)] + planned(p.feed, t))
        feel(p.sensor, m, T, dt)


PLANT = Plant(
    "batch_ramp", Parameters(), run,
    tags={"SP": 0.01, "PV": 0.02, "OP": 0.001},
    set_points=(Programme(),), loads=(Load(0.0006, 600.0),), sensors=("sensor",),
    hours=16.0, dt=0.5, scan=5.0, row=60.0, warm=1200.0,
    effects={
        "stiction": Effect("valve", lambda s: {"valve.S": 0.03 * s, "valve.J": 0.012 * s}),
        "deadband": Effect("valve", lambda s: {"valve.S": 0.025 * s}),
        "positioner_lag": Effect("valve", lambda s: {"valve.tau": 120.0 * s}),
        "valve_leak": Effect("valve", lambda s: {"valve.leak": 0.02 * s}),
        "valve_gain": Effect("valve", lambda s: {"valve.gain": 1.25**s}, signed=True),
        "dead_time": Effect("process", lambda s: {"process.theta": 120.0 * s}),
        "sensor_bias": Effect("sensor", lambda s: {"sensor.bias": 4.0 * s}, signed=True),
        "sensor_lag": Effect("sensor", lambda s: {"sensor.tau": 30.0 + 100.0 * s}),
        "controller_gain": Effect("controller", lambda s: {"controller.K": 0.05 * 1.5**s}, signed=True),
        "controller_limits": Effect("controller", lambda s: {"controller.high": 0.24 - 0.05 * s}),
    },
    outside={
        # a crust grows on the wall for four hours
        "crust": Effect("process", lambda s: {"process.fouls": 0.25 * s}),
        # the batch evaporates above 65 degC
        "evaporates": Effect("process", lambda s: {"process.evaporates": 8e-6 * s}),
        # a leaking bellows lets the stem slide shut, until the positioner pulls it up again every 10 min
        "bellows": Effect("valve", lambda s: {"valve.sag": 8e-5 * s}),
    },
)  # fmt: skip

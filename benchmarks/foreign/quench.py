"""Hot gas quenched by a spray, whose drops shrink by the law of the square of their diameter; the valve fails open.

    8 dT/dt = 400 + load - T - 450 f(t - 3) E     T gas behind the spray [degC], t [s], f flow share of the water valve
    E = 1 - (1 - u)^1.5                           share of the water that evaporates while it is in the gas
    u = (T - 60)/200, at least 0 and at most 1    share of d^2 that is gone by then

Blocks     controller, valve (water: OP to f, its turn of direction included), process (3 s to the lance, spray and
           gas: f to T), sensor (thermocouple), feed (adds to the 400 degC of the gas that comes)
Numbers    as above; at 175 degC the opening is 0.692, at 200 degC 0.532, at 240 degC 0.367
Valve      air to close: the opening that is wanted is 1 - OP, and f is linear in the opening; so OP of 100 % is shut.
           Travel is the opening, and friction, leak and stops are those of the opening.  Positioner of first
           order, 1 s.
Controller K = 0.002 of full OP per degC (0.2 % OP per degC; as OP rises, T rises), T_i = 10 s, OP 0 to 100 %, scan 1 s.
           A filter stands before K: at each scan e_f = e_f + (e - e_f) h/(T_f + h), T_f = 3 s, and e_f takes the place
           of e in OP = K e + I, in I, and in I = OP - K e at a limit.
Sensor     lag 4 s, noise 0.6 degC; range 0 to 500 degC
Load       AR(1), standard deviation 5 degC, time constant 60 s
Log        SP [degC], PV [degC] rounded to 0.1, OP [%] rounded to 0.1; a row every 5 s for 3 h
Set points 175 to 240 degC, a move every 11 min on average
Nonlinear: what evaporates goes with water times a power of the temperature.  With dead time.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from benchmarks.foreign.instruments import feel, kept, pi, pi_at, planned, read, sensor_at, stem, stem_at, through
from benchmarks.foreign.parts import PI, Feed, Sensor, Valve
from benchmarks.foreign.plant import Effect, Load, Moves, Plant


class Process(NamedTuple):
    """Time constant and dead time [s], gas that comes [degC], cooling by all water [degC], d^2 law [degC]."""

    tau: float = 8.0
    theta: float = 3.0
    comes: float = 400.0
    cools: float = 450.0
    wet_bulb: float = 60.0
    life: float = 200.0
    film: float = 0.0


class Faults(NamedTuple):
    """What a wet thermocouple loses at full water [degC]; share of K that lacks where PV is too high."""

    wetted: float = 0.0
    lame: float = 0.0


class Parameters(NamedTuple):
    """All of it."""

    controller: PI = PI(K=0.002, T_i=10.0, tau=3.0)
    valve: Valve = Valve(tau=1.0)
    process: Process = Process()
    sensor: Sensor = Sensor(sd=0.6, tau=4.0)
    feed: Feed = Feed()
    faults: Faults = Faults()


@njit(cache=True)
def evaporates(g, T):
    """Return the share of the water that evaporates in time."""
    return 1.0 - (1.0 - min(max((T - g.wet_bulb) / g.life, 0.0), 1.0)) ** 1.5


@njit(cache=True)
def run(p, sp, load, noise, luck, dt, first, every, out):
    """Run the plant; see ``Plant``."""
    c, g, bad = p.controller, p.process, p.faults
    scan = round(c.scan / dt)
    T = sp[0, 0]
    opening = (g.comes - T) / (g.cools * evaporates(g, T))
    op, pv, seen, film = 1.0 - opening, T, T, 0.0
    held, x, m = pi_at(op), stem_at(opening), sensor_at(T)
    late = np.full(max(round(g.theta / dt), 1), opening)
    for i in range(sp.shape[1]):
        t = (i - first) * dt
        if i % scan == 0:
            k = int(i * dt + 1e-6)
            seen = sp[0, i]
            pv = read(p.sensor, m, noise[0, k], luck[k], t)
            e = seen - pv
            op = pi(c, held, e if e > 0.0 else e * (1.0 - bad.lame), 0.0, 0.0, luck[k])
        kept(out, i - first, every, seen, pv, 100.0 * op)
        j = i % len(late)
        water = late[j]
        late[j] = through(p.valve, stem(p.valve, x, 1.0 - op, t, dt))
        onto = g.film * max(water - 0.4, 0.0)  # what meets the wall evaporates from there, in 3 min
        film += dt / 180.0 * (onto - film)
        comes = g.comes + load[0, int(i * dt)] + planned(p.feed, t)
        T += dt / g.tau * (comes - T - g.cools * ((water - onto) * evaporates(g, T) + film))
        feel(p.sensor, m, T - bad.wetted * max(water - 0.45, 0.0), dt)


PLANT = Plant(
    "quench", Parameters(), run,
    tags={"SP": 0.1, "PV": 0.1, "OP": 0.1},
    set_points=(Moves(175.0, 240.0, 660.0, 205.0),), loads=(Load(5.0, 60.0),), sensors=("sensor",),
    hours=3.0, dt=0.05, scan=1.0, row=5.0, warm=400.0,
    alike={"valve_gain": (("process_gain", "process"),), "positioner_lag": (("second_lag", "process"),)},
    effects={
        "stiction": Effect("valve", lambda s: {"valve.S": 0.05 * s, "valve.J": 0.02 * s}),
        "deadband": Effect("valve", lambda s: {"valve.S": 0.04 * s}),
        "positioner_lag": Effect("valve", lambda s: {"valve.tau": 1.0 + 8.0 * s}),
        "valve_gain": Effect("valve", lambda s: {"valve.gain": 1.12**s}, signed=True),
        "valve_saturation": Effect("valve", lambda s: {"valve.high": 0.69 - 0.08 * s}),
        "dead_time": Effect("process", lambda s: {"process.theta": 3.0 + 4.0 * s}),
        "sensor_lag": Effect("sensor", lambda s: {"sensor.tau": 4.0 + 8.0 * s}),
        "sensor_noise": Effect("sensor", lambda s: {"sensor.noise": 1.0 + 3.0 * s}),
        "controller_filter": Effect("controller", lambda s: {"controller.tau": 3.0 + 10.0 * s}),
        "controller_limits": Effect("controller", lambda s: {"controller.low": 0.31 + 0.08 * s}),
        "step_disturbance": Effect("feed", lambda s: {"feed.step": 25.0 * s, "feed.at": 5400.0}, signed=True),
    },
    outside={
        # the spray is too wide: beyond 40 % of the water some meets the wall, and evaporates there, late
        "wet_wall": Effect("process", lambda s: {"process.film": 0.4 * s}),
        # drops reach the thermocouple
        "wetted_thermocouple": Effect("sensor", lambda s: {"faults.wetted": 60.0 * s}),
        # somebody has halved the gain where it is too hot
        "one_sided_gain": Effect("controller", lambda s: {"faults.lame": min(0.5 * s, 0.9)}),
    },
)  # fmt: skip

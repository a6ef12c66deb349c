"""Split range: one controller cools with one half of its OP and heats with the other; a reaction gives heat.

    400 dT/dt = 90 x_h - 1.2 x_c (T - 15) - 0.5 (T - 25) + 20 + load          T [degC], heat in 400 per degC, t [s]
    x_c = 1 - 2 OP below OP = 0.5, else 0;     x_h = 2 OP - 1 above, else 0

Blocks     controller, cooling_valve (sent to x_c), heating_valve (sent to x_h), process (vessel), sensor,
           feed (adds to the heat of process).  There is no block of that name for the split: it is exact.
Numbers    as above; at 65 degC neither valve is needed, at 50 degC x_c = 0.18, at 75 degC x_h = 0.06
Controller K = 0.04 of full OP per degC (4 % OP per degC), T_i = 250 s, OP 0 to 100 %, scan 1 s
Sensor     lag 15 s, noise 0.05 degC; range 0 to 150 degC
Load       AR(1), standard deviation 1.5 (unit of heat, as above), time constant 300 s
Log        SP [degC], PV [degC] rounded to 0.01, OP [%] rounded to 0.05; a row every 20 s for 8 h
Set points 50 to 78 degC, a move every 40 min on average
Nonlinear: the split, and cooling by the difference of temperatures.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from benchmarks.foreign.instruments import feel, kept, pi_at, planned, scanned, sensor_at, stem, stem_at, through
from benchmarks.foreign.parts import PI, Feed, Sensor, Valve
from benchmarks.foreign.plant import Effect, Load, Moves, Plant


class Process(NamedTuple):
    """Heats and capacity as in the sheet; dead time of what the valves give [s]."""

    C: float = 400.0
    heat: float = 90.0
    cool: float = 1.2
    loss: float = 0.5
    reaction: float = 20.0
    theta: float = 0.0
    gap: float = 0.0
    runs_away: float = 0.0


class Parameters(NamedTuple):
    """All of it."""

    controller: PI = PI(K=0.04, T_i=250.0)
    cooling_valve: Valve = Valve()
    heating_valve: Valve = Valve()
    process: Process = Process()
    sensor: Sensor = Sensor(sd=0.05, tau=15.0)
    feed: Feed = Feed()


@njit(cache=True)
def run(p, sp, load, noise, luck, dt, first, every, out):
    """Run the plant; see ``Plant``."""
    g, scan, T = p.process, round(p.controller.scan / dt), sp[0, 0]
    needs = g.loss * (T - 25.0) - g.reaction
    op = 0.5 + 0.5 * needs / g.heat if needs > 0.0 else 0.5 + 0.5 * needs / (g.cool * (T - 15.0))
    pv, seen = T, T
    held, m = pi_at(op), sensor_at(T)
    cold, hot = stem_at(max(1.0 - 2.0 * op, 0.0)), stem_at(max(2.0 * op - 1.0, 0.0))
    late = np.zeros((max(round(g.theta / dt), 1), 2))
    late[:, 0], late[:, 1] = cold[1], hot[1]
    for i in range(sp.shape[1]):
        t = (i - first) * dt
        if i % scan == 0:
            seen, pv, op = scanned(p, held, m, sp[0, i], noise[0], luck, int(i * dt + 1e-6), t)
        kept(out, i - first, every, seen, pv, 100.0 * op)
        to_cold, to_hot = max(1.0 - 2.0 * op, 0.0), max(2.0 * op - 1.0, 0.0)
        if g.gap > 0.0:
            to_hot = max((to_hot - g.gap) / (1.0 - g.gap), 0.0)
        x_c = through(p.cooling_valve, stem(p.cooling_valve, cold, to_cold, t, dt))
        x_h = through(p.heating_valve, stem(p.heating_valve, hot, to_hot, t, dt))
        j = i % len(late)
        was_c, was_h = late[j, 0], late[j, 1]
        late[j, 0], late[j, 1] = x_c, x_h
        if g.theta == 0.0:
            was_c, was_h = x_c, x_h
        heat = g.heat * was_h - g.cool * was_c * (T - 15.0) - g.loss * (T - 25.0)
        heat += g.reaction * np.exp(g.runs_away * (T - 65.0)) + load[0, int(i * dt)] + planned(p.feed, t)
        T += dt / g.C * heat
        feel(p.sensor, m, T, dt)


PLANT = Plant(
    "split_range", Parameters(), run,
    tags={"SP": 0.01, "PV": 0.01, "OP": 0.05},
    set_points=(Moves(50.0, 78.0, 2400.0, 60.0),), loads=(Load(1.5, 300.0),), sensors=("sensor",),
    hours=8.0, dt=0.1, scan=1.0, row=20.0, warm=1800.0,
    alike={"sensor_lag": (("second_lag", "process"),)},
    effects={
        "stiction": Effect("heating_valve", lambda s: {"heating_valve.S": 0.06 * s, "heating_valve.J": 0.025 * s}),
        "deadband": Effect("cooling_valve", lambda s: {"cooling_valve.S": 0.06 * s}),
        "valve_leak": Effect("cooling_valve", lambda s: {"cooling_valve.leak": 0.06 * s}),
        "valve_gain": Effect("heating_valve", lambda s: {"heating_valve.gain": 1.5**s}, signed=True),
        "positioner_lag": Effect("cooling_valve", lambda s: {"cooling_valve.tau": 25.0 * s}),
        "dead_time": Effect("process", lambda s: {"process.theta": 12.0 * s}),
        "sensor_lag": Effect("sensor", lambda s: {"sensor.tau": 15.0 + 20.0 * s}),
        "sensor_bias": Effect("sensor", lambda s: {"sensor.bias": 3.0 * s}, signed=True),
        "controller_integral_time": Effect("controller", lambda s: {"controller.T_i": 250.0 * 1.6**s}, signed=True),
        "sine_disturbance": Effect("feed", lambda s: {"feed.sine": 5.0 * s, "feed.period": 900.0}),
    },
    outside={
        # the heating valve begins to open late: the split is set wrong
        "split_gap": Effect("heating_valve", lambda s: {"process.gap": 0.06 * s}),
        # the reaction gives more heat the hotter it is
        "reaction_grows": Effect("process", lambda s: {"process.runs_away": 0.03 * s}),
        # the historian's clock for PV is a minute late
        "late_stamp": Effect("historian", lambda s: {"late.PV": 20.0 * max(round(2.0 * s), 1)}, log=True),
    },
)  # fmt: skip

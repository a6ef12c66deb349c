"""Two by two: reflux and steam of a column hold the temperatures of its top and bottom, and each moves both.

    T1 = 50 + 20 G(80, 8)  (u1 + load1 - 0.5) - 12 G(100, 20) (u2 + load2 - 0.5)          [degC]
    T2 = 90 +  9 G(70, 24) (u1 + load1 - 0.5) - 18 G(60, 10)  (u2 + load2 - 0.5)          [degC]
    G(tau, theta) = exp(-theta s)/(tau s + 1), in s;   u1, u2 flow shares of the valves, linear

Blocks     controller_1, controller_2, valve_1, valve_2, process_11 (u1 to T1), process_12 (u2 to T1), process_21 (u1 to
           T2), process_22 (u2 to T2), sensor_1, sensor_2, feed_1, feed_2 (add to the flow shares, for both T)
Controller 1: K = 0.09 of full OP per degC, T_i = 80 s; 2: K = -0.08, T_i = 60 s; OP 0 to 100 %, scan 2 s
Sensor     noise 0.05 degC of 1, 0.04 degC of 2; lag 4 s of both; ranges 0 to 150 degC
Load       both AR(1), standard deviation 0.008, time constant 200 s, independent
Log        SP1, PV1, SP2, PV2 [degC] rounded to 0.01, OP1, OP2 [%] rounded to 0.05; a row every 30 s for 10 h
Set points 46 to 54 degC and 87 to 93 degC, a move of each every 50 min on average
Linear but for limits.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from benchmarks.foreign.instruments import feel, pi, pi_at, planned, read, sensor_at, stem, stem_at, through
from benchmarks.foreign.parts import PI, Feed, Sensor, Valve
from benchmarks.foreign.plant import Effect, Load, Moves, Plant


class Part(NamedTuple):
    """One transfer function: gain [degC], time constant [s], dead time [s]."""

    K: float
    tau: float
    theta: float
    one_sided: float = 0.0
    swings: float = 0.0


class Parameters(NamedTuple):
    """All of it."""

    controller_1: PI = PI(K=0.09, T_i=80.0, scan=2.0)
    controller_2: PI = PI(K=-0.08, T_i=60.0, scan=2.0)
    valve_1: Valve = Valve()
    valve_2: Valve = Valve()
    process_11: Part = Part(20.0, 80.0, 8.0)
    process_12: Part = Part(-12.0, 100.0, 20.0)
    process_21: Part = Part(9.0, 70.0, 24.0)
    process_22: Part = Part(-18.0, 60.0, 10.0)
    sensor_1: Sensor = Sensor(sd=0.05, tau=4.0)
    sensor_2: Sensor = Sensor(sd=0.04, tau=4.0)
    feed_1: Feed = Feed()
    feed_2: Feed = Feed()


@njit(cache=True)
def after(g, flows, i, y, t, dt):
    """Return the state of one transfer function after ``dt``; ``flows`` of all steps so far."""
    u = flows[max(i - round(g.theta / dt), 0)] - 0.5
    if g.one_sided > 0.0 and u < 0.0:
        u *= 1.0 - g.one_sided
    return y + dt / g.tau * (g.K * (1.0 + g.swings * np.sin(2.0 * np.pi * t / 5400.0)) * u - y)


@njit(cache=True)
def run(p, sp, load, noise, luck, dt, first, every, out):
    """Run the plant; see ``Plant``."""
    scan_1, scan_2 = round(p.controller_1.scan / dt), round(p.controller_2.scan / dt)
    n = sp.shape[1]
    op_1, op_2, see_1, see_2, pv_1, pv_2 = 0.5, 0.5, 50.0, 90.0, 50.0, 90.0
    held_1, held_2, x_1, x_2 = pi_at(0.5), pi_at(0.5), stem_at(0.5), stem_at(0.5)
    m_1, m_2 = sensor_at(50.0), sensor_at(90.0)
    u_1, u_2 = np.full(n, 0.5), np.full(n, 0.5)
    y_11, y_12, y_21, y_22 = 0.0, 0.0, 0.0, 0.0
    for i in range(n):
        t = (i - first) * dt
        k = int(i * dt / 2.0 + 1e-6)
        if i % scan_1 == 0:
            see_1 = sp[0, i]
            pv_1 = read(p.sensor_1, m_1, noise[0, k], luck[k], t)
            op_1 = pi(p.controller_1, held_1, see_1, pv_1, 0.0, luck[k])
        if i % scan_2 == 0:
            see_2 = sp[1, i]
            pv_2 = read(p.sensor_2, m_2, noise[1, k], luck[k], t)
            op_2 = pi(p.controller_2, held_2, see_2, pv_2, 0.0, luck[k])
        if i >= first and (i - first) % every == 0:
            row = out[(i - first) // every]
            row[0], row[1], row[2] = see_1, pv_1, 100.0 * op_1
            row[3], row[4], row[5] = see_2, pv_2, 100.0 * op_2
        s = int(i * dt)
        u_1[i] = through(p.valve_1, stem(p.valve_1, x_1, op_1, t, dt)) + load[0, s] + planned(p.feed_1, t)
        u_2[i] = through(p.valve_2, stem(p.valve_2, x_2, op_2, t, dt)) + load[1, s] + planned(p.feed_2, t)
        y_11 = after(p.process_11, u_1, i, y_11, t, dt)
        y_12 = after(p.process_12, u_2, i, y_12, t, dt)
        y_21 = after(p.process_21, u_1, i, y_21, t, dt)
        y_22 = after(p.process_22, u_2, i, y_22, t, dt)
        feel(p.sensor_1, m_1, 50.0 + y_11 + y_12, dt)
        feel(p.sensor_2, m_2, 90.0 + y_21 + y_22, dt)


PLANT = Plant(
    "two_by_two", Parameters(), run,
    tags={"SP1": 0.01, "PV1": 0.01, "OP1": 0.05, "SP2": 0.01, "PV2": 0.01, "OP2": 0.05},
    set_points=(Moves(46.0, 54.0, 3000.0, 50.0), Moves(87.0, 93.0, 3000.0, 90.0)),
    loads=(Load(0.008, 200.0), Load(0.008, 200.0)), sensors=("sensor_1", "sensor_2"),
    hours=10.0, dt=0.2, scan=2.0, row=30.0, warm=1200.0,
    alike={},
    effects={
        "stiction": Effect("valve_1", lambda s: {"valve_1.S": 0.04 * s, "valve_1.J": 0.015 * s}),
        "deadband": Effect("valve_2", lambda s: {"valve_2.S": 0.03 * s}),
        "valve_gain": Effect("valve_1", lambda s: {"valve_1.gain": 1.12**s}, signed=True),
        "process_gain": Effect("process_12", lambda s: {"process_12.K": -12.0 * 1.25**s}, signed=True),
        "dead_time": Effect("process_22", lambda s: {"process_22.theta": 10.0 + 12.0 * s}),
        "process_time_constant": Effect("process_11", lambda s: {"process_11.tau": 80.0 * 1.4**s}, signed=True),
        "sensor_lag": Effect("sensor_2", lambda s: {"sensor_2.tau": 4.0 + 18.0 * s}),
        "sensor_bias": Effect("sensor_1", lambda s: {"sensor_1.bias": 0.6 * s}, signed=True),
        "controller_gain": Effect("controller_2", lambda s: {"controller_2.K": -0.08 * 1.5**s}, signed=True),
        "sine_disturbance": Effect("feed_1", lambda s: {"feed_1.sine": 0.03 * s, "feed_1.period": 700.0}),
    },
    outside={
        # the bottom moves the top less while its valve is less than half open
        "one_sided": Effect("process_12", lambda s: {"process_12.one_sided": 0.35 * s}),
        # the gain swings, with a period of an hour and a half
        "gain_swings": Effect("process_21", lambda s: {"process_21.swings": 0.3 * s}),
        # the transmitter freezes now and then, for a minute
        "freezes": Effect("sensor_1", lambda s: {"sensor_1.freezes": 0.004 * s}),
    },
)  # fmt: skip

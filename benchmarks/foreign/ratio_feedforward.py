"""Ratio with feedforward: the flow of B follows a ratio of a wild flow A, and its controller knows what OP that takes.

    SP = ratio x FA                      the ratio station computes it at each scan from the measured wild flow
    OP = PI(SP - PV) + 0.9 SP/60         the limits hold for the sum, and I = OP - K e - 0.9 SP/60 there
    3 dq/dt = 60 x root(1 + load - (q/90)^2) - q         q flow of B [kg/s], x flow share of the valve, linear, t [s]

Blocks     controller (PI and feedforward), valve, process (pipe with a header that sags), sensor (flow of B),
           feed (adds to the pressure of the header, whose mean is 1, in process)
Numbers    as above; at 30 kg/s the valve stands at 0.53.  The wild flow is 50 kg/s on average.
Controller K = 0.006 of full OP per kg/s, T_i = 3 s, OP 0 to 1, scan 1 s.  K is that of the PI alone; 0.9/60 is fixed.
Sensor     lag 0.5 s, noise 0.15 kg/s; range 0 to 80 kg/s.  The meter of A has noise 0.1 kg/s, which gets into SP.
Load       AR(1), standard deviation 0.02, time constant 30 s
Log        FA [kg/s] rounded to 0.02, RATIO [-], SP [kg/s] rounded to 0.01 (RATIO x FA of the scan, unrounded),
           PV [kg/s] rounded to 0.02, OP [0 to 1] rounded to 0.0005; a row every 3 s for 2 h
Set points the ratio, 0.4 to 0.8, a move every 10 min on average; FA wanders: AR(1), 4 kg/s, 200 s
Nonlinear: the header.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from benchmarks.foreign.instruments import feel, pi, pi_at, planned, read, sensor_at, stem, stem_at, through
from benchmarks.foreign.parts import PI, Feed, Sensor, Valve
from benchmarks.foreign.plant import Effect, Load, Moves, Plant


class Process(NamedTuple):
    """Largest flow [kg/s], time constant [s], flow at which the header is empty [kg/s]."""

    q: float = 60.0
    tau: float = 3.0
    sags: float = 90.0
    ahead: float = 0.015
    late: float = 0.0
    slow_sag: float = 0.0


class Parameters(NamedTuple):
    """All of it."""

    controller: PI = PI(K=0.006, T_i=3.0)
    valve: Valve = Valve()
    process: Process = Process()
    sensor: Sensor = Sensor(sd=0.15, tau=0.5)
    wild: Sensor = Sensor(sd=0.1)
    feed: Feed = Feed()


@njit(cache=True)
def run(p, sp, load, noise, luck, dt, first, every, out):
    """Run the plant; see ``Plant``."""
    c, g = p.controller, p.process
    scan = round(c.scan / dt)
    q = sp[0, 0] * 50.0
    op = q / (g.q * np.sqrt(1.0 - (q / g.sags) ** 2))
    pv, ratio, fa, to = q, sp[0, 0], 50.0, q
    held, x, m, m_a = pi_at(op - g.ahead * q), stem_at(op), sensor_at(q), sensor_at(50.0)
    held[2] = op
    header = 0.0
    ago = np.full(max(round(g.late), 1), q)
    for i in range(sp.shape[1]):
        t = (i - first) * dt
        if i % scan == 0:
            k = int(i * dt + 1e-6)
            ratio = sp[0, i]
            m_a[0] = 50.0 + load[1, k]
            fa = read(p.wild, m_a, noise[1, k], 1.0, t)
            to = ratio * fa
            pv = read(p.sensor, m, noise[0, k], luck[k], t)
            known = to
            if g.late > 0.0:
                known = ago[k % len(ago)]
                ago[k % len(ago)] = to
            op = pi(c, held, to, pv, g.ahead * known, luck[k])
        if i >= first and (i - first) % every == 0:
            row = (i - first) // every
            out[row, 0], out[row, 1], out[row, 2], out[row, 3], out[row, 4] = fa, ratio, to, pv, op
        pressure = 1.0 + load[0, int(i * dt)] + planned(p.feed, t) - (q / g.sags) ** 2 - header
        header += dt / 60.0 * (g.slow_sag * (q / 60.0) ** 2 - header)
        flow = g.q * through(p.valve, stem(p.valve, x, op, t, dt)) * np.sqrt(max(pressure, 0.0))
        q += dt / g.tau * (flow - q)
        feel(p.sensor, m, q, dt)


PLANT = Plant(
    "ratio_feedforward", Parameters(), run,
    tags={"FA": 0.02, "RATIO": 0.001, "SP": 0.01, "PV": 0.02, "OP": 0.0005},
    set_points=(Moves(0.4, 0.8, 600.0, 0.6),), loads=(Load(0.02, 30.0), Load(4.0, 200.0)), sensors=("sensor", "wild"),
    measured=(1,),
    hours=2.0, dt=0.05, scan=1.0, row=3.0, warm=120.0,
    effects={
        "stiction": Effect("valve", lambda s: {"valve.S": 0.02 * s, "valve.J": 0.01 * s}),
        "deadband": Effect("valve", lambda s: {"valve.S": 0.015 * s}),
        "valve_rate_limit": Effect("valve", lambda s: {"valve.up": 0.05 / s, "valve.down": 0.05 / s}),
        "valve_gain": Effect("valve", lambda s: {"valve.gain": 1.05**s}, signed=True),
        "valve_characteristic": Effect("valve", lambda s: {"valve.R": 1.0 + 0.4 * s}),
        "sensor_span": Effect("sensor", lambda s: {"sensor.span": 1.0 + 0.04 * s}, signed=True),
        "sensor_noise": Effect("sensor", lambda s: {"sensor.noise": 1.0 + 2.0 * s}),
        "controller_gain": Effect("controller", lambda s: {"controller.K": 0.006 * 1.6**s}, signed=True),
        "controller_filter": Effect("controller", lambda s: {"controller.tau": 5.0 * s}),
        "slug": Effect("feed", lambda s: {"feed.slug": 0.12 * s, "feed.period": 70.0}),
    },
    outside={
        # the feedforward comes from a slow task: it knows the set point of some scans ago
        "feedforward_late": Effect("controller", lambda s: {"process.late": max(round(6.0 * s), 1)}),
        # the transmitter reports only changes
        "by_exception": Effect("sensor", lambda s: {"sensor.exception": 0.8 * s}),
        # the header sags more, a minute late
        "slow_sag": Effect("process", lambda s: {"process.slow_sag": 0.2 * s}),
    },
)  # fmt: skip

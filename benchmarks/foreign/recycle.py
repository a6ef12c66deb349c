"""Recycle of a compressor: a controller opens the recycle so that the compressor has enough flow.

    40 dp/dt  = m_feed + m_r - m                      p suction pressure [bar], flows [kg/s], t [s]
    0.2 dm/dt = p (3.6 - 0.004 m^2) - 8               m flow of the compressor, discharge header at 8 bar
    m_feed = 11 + load;   m_r = 8 x                   x flow share of the recycle valve, linear (choked from 8 bar)

Blocks     controller, valve (positioner, stem, body), process (drum and compressor: x to m and p), sensor (of m),
           suction_sensor (of p), feed (adds to m_feed of process)
Numbers    as above; at 15 kg/s the recycle valve stands at 0.5 and the suction is at 2.96 bar
Controller K = 0.05 of full OP per kg/s, T_i = 4 s, OP 0 to 100 %, scan 0.25 s
Valve      positioner of first order, 0.6 s
Sensor     sensor: lag 0.4 s, noise 0.08 kg/s; suction_sensor: lag 0.2 s, noise 0.004 bar; both new every 0.25 s
Load       AR(1), standard deviation 0.15 kg/s, time constant 60 s
Log        SP, PV [kg/s] rounded to 0.01, PS (of suction_sensor) [bar] rounded to 0.001, OP [%] rounded to 0.05; a row
           every 1 s for 50 min
Set points 13 to 17 kg/s, a move every 5 min on average
Nonlinear: the map.
"""

from typing import NamedTuple

from numba import njit

from benchmarks.foreign.instruments import feel, pi, pi_at, planned, read, sensor_at, stem, stem_at, through
from benchmarks.foreign.parts import PI, Feed, Sensor, Valve
from benchmarks.foreign.plant import Effect, Load, Moves, Plant


class Process(NamedTuple):
    """Drum [kg/bar], duct, map, flow of the recycle [kg/s], feed [kg/s]."""

    drum: float = 40.0
    duct: float = 0.2
    top: float = 3.6
    curve: float = 0.004
    discharge: float = 8.0
    recycle: float = 8.0
    feed: float = 11.0
    fouls: float = 0.0


class Parameters(NamedTuple):
    """All of it."""

    controller: PI = PI(K=0.05, T_i=4.0, scan=0.25)
    valve: Valve = Valve(tau=0.6)
    process: Process = Process()
    sensor: Sensor = Sensor(sd=0.08, tau=0.4)
    suction_sensor: Sensor = Sensor(sd=0.004, tau=0.2)
    feed: Feed = Feed()


@njit(cache=True)
def run(p, sp, load, noise, luck, dt, first, every, out):
    """Run the plant; see ``Plant``."""
    c, g = p.controller, p.process
    scan = round(c.scan / dt)
    m = sp[0, 0]
    P = g.discharge / (g.top - g.curve * m * m)
    op = (m - g.feed) / g.recycle
    pv, seen, ps = m, m, P
    held, x, m_f, m_p = pi_at(op), stem_at(op), sensor_at(m), sensor_at(P)
    for i in range(sp.shape[1]):
        t = (i - first) * dt
        k = int(i * dt / 0.25 + 1e-6)
        if i % round(0.25 / dt) == 0:
            ps = read(p.suction_sensor, m_p, noise[1, k], luck[k], t)
        if i % scan == 0:
            seen = sp[0, i]
            pv = read(p.sensor, m_f, noise[0, k], luck[k], t)
            op = pi(c, held, seen, pv, 0.0, luck[k])
        if i >= first and (i - first) % every == 0:
            row = out[(i - first) // every]
            row[0], row[1], row[2], row[3] = seen, pv, ps, 100.0 * op
        back = g.recycle * through(p.valve, stem(p.valve, x, op, t, dt))
        P += dt / g.drum * (g.feed + load[0, int(i * dt)] + planned(p.feed, t) + back - m)
        top = g.top * (1.0 - g.fouls * ((t / 900.0) % 1.0))
        m += dt / g.duct * (P * (top - g.curve * m * m) - g.discharge)
        feel(p.sensor, m_f, m, dt)
        feel(p.suction_sensor, m_p, P, dt)


PLANT = Plant(
    "recycle", Parameters(), run,
    tags={"SP": 0.01, "PV": 0.01, "PS": 0.001, "OP": 0.05},
    set_points=(Moves(13.0, 17.0, 300.0, 15.0),), loads=(Load(0.15, 60.0),), sensors=("sensor", "suction_sensor"),
    hours=5.0 / 6.0, dt=0.01, scan=0.25, row=1.0, warm=60.0,
    alike={
        "positioner_lag": (("second_lag", "process"),),
        "valve_leak": (("step_disturbance", "feed"),),
    },
    effects={
        "stiction": Effect("valve", lambda s: {"valve.S": 0.035 * s, "valve.J": 0.015 * s}),
        "deadband": Effect("valve", lambda s: {"valve.S": 0.03 * s}),
        "positioner_lag": Effect("valve", lambda s: {"valve.tau": 0.6 + 1.5 * s}),
        "valve_rate_limit": Effect("valve", lambda s: {"valve.up": 0.04 / s, "valve.down": 0.04 / s}),
        "valve_leak": Effect("valve", lambda s: {"valve.leak": 0.05 * s}),
        "sensor_lag": Effect("sensor", lambda s: {"sensor.tau": 0.4 + 1.5 * s}),
        "sensor_bias": Effect("suction_sensor", lambda s: {"suction_sensor.bias": 0.03 * s}, signed=True),
        "sensor_noise": Effect("sensor", lambda s: {"sensor.noise": 1.0 + 1.5 * s}),
        "controller_filter": Effect("controller", lambda s: {"controller.tau": 2.5 * s}),
        "scan_time": Effect("controller", lambda s: {"controller.scan": 0.25 * max(round(8.0 * s), 1)}),
        "slug": Effect("feed", lambda s: {"feed.slug": 0.8 * s, "feed.period": 50.0}),
    },
    outside={
        # salt on the wheel, washed off every 15 min
        "salt": Effect("process", lambda s: {"process.fouls": 0.015 * s}),
        # the positioner is tuned too sharply: the stem swings
        "swinging_stem": Effect("valve", lambda s: {"valve.overshoot": 14.0 * s}),
        # one impulse line is plugged: the meter is slow to fall
        "plugged_line": Effect("sensor", lambda s: {"sensor.falls": 3.0 * s}),
    },
)  # fmt: skip

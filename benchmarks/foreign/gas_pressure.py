"""Gas pressure at a scan of 0.5 s: gas flows into a drum, a choked valve lets it out (bilinear).

    C dp/dt = m_in - k p x                 x = flow share of the valve, linear; p [bar]; m [kg/s]
    m_in    = 3 + load                     load [kg/s] enters at the inlet of the drum

Blocks     controller, valve (x), process (drum, and the flow k p x out of it), sensor, feed (into m_in of process)
Numbers    C = 4 kg/bar, k = 0.6 kg/(s bar); so at 10 bar the valve stands at 0.5
Controller direct acting: K = -0.25 of full OP per bar, T_i = 12 s, OP 0 to 1, scan 0.5 s
Sensor     lag 0.3 s, noise 0.008 bar; range 0 to 20 bar
Load       AR(1), standard deviation 0.06 kg/s, time constant 40 s
Log        SP [bar], PV [bar] rounded to 0.002, OP [0 to 1] rounded to 0.0005; a row every 2.3 s for 1.5 h
Set points 8 to 12 bar, a move every 8 min on average
Nonlinear: the outflow goes with pressure times opening.
"""

from typing import NamedTuple

from numba import njit

from benchmarks.foreign.instruments import feel, kept, pi_at, planned, scanned, sensor_at, stem, stem_at, through
from benchmarks.foreign.parts import PI, Feed, Sensor, Valve
from benchmarks.foreign.plant import Effect, Load, Moves, Plant


class Process(NamedTuple):
    """Capacity [kg/bar], flow [kg/(s bar)], inflow [kg/s]."""

    C: float = 4.0
    k: float = 0.6
    m_in: float = 3.0


class Parameters(NamedTuple):
    """All of it."""

    controller: PI = PI(K=-0.25, T_i=12.0, scan=0.5, rest=0.5)
    valve: Valve = Valve()
    process: Process = Process()
    sensor: Sensor = Sensor(sd=0.008, tau=0.3, grows_from=8.0)
    feed: Feed = Feed()


@njit(cache=True)
def run(p, sp, load, noise, luck, dt, first, every, out):
    """Run the plant; see ``Plant``."""
    g, scan, P = p.process, round(p.controller.scan / dt), sp[0, 0]
    op = g.m_in / (g.k * P)
    pv, seen = P, P
    held = pi_at(op)
    x = stem_at(op)
    m = sensor_at(P)
    for i in range(sp.shape[1]):
        t = (i - first) * dt
        if i % scan == 0:
            seen, pv, op = scanned(p, held, m, sp[0, i], noise[0], luck, int(i * dt / 0.5 + 1e-6), t)
        kept(out, i - first, every, seen, pv, op)
        share = through(p.valve, stem(p.valve, x, op, t, dt))
        m_in = g.m_in + load[0, int(i * dt)] + planned(p.feed, t)
        P = max(P + dt / g.C * (m_in - g.k * P * share), 0.0)
        feel(p.sensor, m, P, dt)


PLANT = Plant(
    "gas_pressure", Parameters(), run,
    tags={"SP": 0.001, "PV": 0.002, "OP": 0.0005},
    set_points=(Moves(8.0, 12.0, 480.0, 10.0),), loads=(Load(0.06, 40.0),), sensors=("sensor",),
    hours=1.5, dt=0.02, scan=0.5, row=2.3, warm=200.0,
    effects={
        "stiction": Effect("valve", lambda s: {"valve.S": 0.02 * s, "valve.J": 0.008 * s}),
        "deadband": Effect("valve", lambda s: {"valve.S": 0.015 * s}),
        "positioner_lag": Effect("valve", lambda s: {"valve.tau": 1.5 * s}),
        "valve_gain": Effect("valve", lambda s: {"valve.gain": 1.12**s}, signed=True),
        "valve_characteristic": Effect("valve", lambda s: {"valve.R": 1.0 + 1.5 * s}),
        "sensor_span": Effect("sensor", lambda s: {"sensor.span": 1.0 + 0.06 * s}, signed=True),
        "sensor_lag": Effect("sensor", lambda s: {"sensor.tau": 0.3 + 2.0 * s}),
        "controller_integral_time": Effect("controller", lambda s: {"controller.T_i": 12.0 * 1.6**s}, signed=True),
        "step_disturbance": Effect("feed", lambda s: {"feed.step": 0.4 * s, "feed.at": 2400.0}, signed=True),
        "slug": Effect("feed", lambda s: {"feed.slug": 0.4 * s, "feed.period": 90.0}),
    },
    outside={
        # hydrate: the stem opens faster than it shuts
        "vent_freezes": Effect("valve", lambda s: {"valve.up": 0.1 / s, "valve.down": 0.03 / s}),
        # the integral decays towards half of OP in a minute
        "integral_leaks": Effect("controller", lambda s: {"controller.leaks": s / 60.0}),
        # more noise the higher the pressure
        "noise_grows": Effect("sensor", lambda s: {"sensor.grows": 0.8 * s}),
    },
)  # fmt: skip

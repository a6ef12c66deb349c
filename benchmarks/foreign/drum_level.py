"""Level of a boiler drum, which answers the wrong way first: cold feedwater makes its bubbles collapse.

    dL/dt = 0.25 (w - 0.5 - load) - 6 dz/dt        L [%], w flow share of the feedwater valve, linear; t [s]
    20 dz/dt = w - z                                load is the steam drawn beyond its mean, in shares of full feedwater

Blocks     controller, valve (feedwater), process (drum: w to L), sensor, feed (the steam, into process)
Numbers    as above: L = L_0 + integral of 0.25 (w - 0.5 - load) - 6 z.  The load has no wrong-way answer.
Controller K = 0.03 of full OP per %, T_i = 250 s, OP 0 to 1, scan 1 s
Sensor     lag 3 s, noise 0.1 %; range 0 to 100 %
Load       AR(1), standard deviation 0.03, time constant 120 s
Log        SP, PV [%] rounded to 0.02, OP [0 to 1] rounded to 0.001; a row every 8 s for 5 h
Set points 45 to 55 %, a move every 30 min on average
Linear but for limits, and integrating: a constant error of the level leaves no trace but at set points.
"""

from typing import NamedTuple

from numba import njit

from benchmarks.foreign.instruments import feel, kept, pi_at, planned, scanned, sensor_at, stem, stem_at, through
from benchmarks.foreign.parts import PI, Feed, Sensor, Valve
from benchmarks.foreign.plant import Effect, Load, Moves, Plant


class Process(NamedTuple):
    """Rate [%/s], collapse [%], its time constant [s], steam [-]."""

    rate: float = 0.25
    collapse: float = 6.0
    tau: float = 20.0
    steam: float = 0.5


class Parameters(NamedTuple):
    """All of it."""

    controller: PI = PI(K=0.03, T_i=250.0)
    valve: Valve = Valve()
    process: Process = Process()
    sensor: Sensor = Sensor(sd=0.1, tau=3.0, grows_from=48.0)
    feed: Feed = Feed()


@njit(cache=True)
def run(p, sp, load, noise, luck, dt, first, every, out):
    """Run the plant; see ``Plant``."""
    g, scan, L = p.process, round(p.controller.scan / dt), sp[0, 0]
    op = g.steam
    z, mass = op, L + g.collapse * op
    pv, seen = L, L
    held, x, m = pi_at(op), stem_at(op), sensor_at(L)
    for i in range(sp.shape[1]):
        t = (i - first) * dt
        if i % scan == 0:
            seen, pv, op = scanned(p, held, m, sp[0, i], noise[0], luck, int(i * dt + 1e-6), t)
        kept(out, i - first, every, seen, pv, op)
        w = through(p.valve, stem(p.valve, x, op, t, dt))
        mass += dt * g.rate * (w - g.steam - load[0, int(i * dt)] - planned(p.feed, t))
        z += dt / g.tau * (w - z)
        L = mass - g.collapse * z
        feel(p.sensor, m, L, dt)


PLANT = Plant(
    "drum_level", Parameters(), run,
    tags={"SP": 0.01, "PV": 0.02, "OP": 0.001},
    set_points=(Moves(45.0, 55.0, 1800.0, 50.0),), loads=(Load(0.03, 120.0),), sensors=("sensor",),
    hours=5.0, dt=0.1, scan=1.0, row=8.0, warm=1200.0,
    effects={
        "stiction": Effect("valve", lambda s: {"valve.S": 0.05 * s, "valve.J": 0.02 * s}),
        "deadband": Effect("valve", lambda s: {"valve.S": 0.04 * s}),
        "positioner_lag": Effect("valve", lambda s: {"valve.tau": 25.0 * s}),
        "valve_gain": Effect("valve", lambda s: {"valve.gain": 1.2**s}, signed=True),
        "valve_leak": Effect("valve", lambda s: {"valve.leak": 0.05 * s}),
        "sensor_lag": Effect("sensor", lambda s: {"sensor.tau": 3.0 + 30.0 * s}),
        "sensor_noise": Effect("sensor", lambda s: {"sensor.noise": 1.0 + 2.5 * s}),
        "quantisation": Effect("sensor", lambda s: {"sensor.step": 0.8 * s}),
        "compression": Effect("historian", lambda s: {"compression.PV": 0.4 * s}, log=True),
        "controller_filter": Effect("controller", lambda s: {"controller.tau": 15.0 * s}),
        "sine_disturbance": Effect("feed", lambda s: {"feed.sine": 0.06 * s, "feed.period": 300.0}),
    },
    outside={
        # the higher the level the more it is stirred up: noise grows with it
        "stirred_up": Effect("sensor", lambda s: {"sensor.grows": 0.8 * s}),
        # the historian's clock for OP is late
        "late_stamp": Effect("historian", lambda s: {"late.OP": 8.0 * max(round(2.0 * s), 1)}, log=True),
        # a busy control system leaves out scans at random
        "missed_scans": Effect("controller", lambda s: {"controller.misses": 0.8 * min(s, 1.2)}),
    },
)  # fmt: skip

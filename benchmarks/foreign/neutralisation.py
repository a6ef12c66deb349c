"""Neutralisation: base through a valve holds the pH of an acid stream in a stirred tank, with a weak buffer in it.

    600 dW/dt = 6 (-0.02 + load) + 0.1 F_b - (6 + F_b) W             F_b = 2.4 f [L/s], f flow share of the base valve
    600 dB/dt = 6 0.005 - (6 + F_b) B                                W strong ions, B buffer [mol/L], 600 L, t [s]
    W + H - 1e-14/H = B K_a/(K_a + H)          pH = -log10 H,  K_a = 10^-6.35

Blocks     controller, valve (base), process (tank and chemistry, to pH), sensor (electrode), feed (the acid's ions)
Numbers    acid 6 L/s with -0.02 mol/L strong ions and 0.005 mol/L buffer; base 0.1 mol/L, 2.4 L/s at full flow.
           At pH 6.35 the valve stands at about 0.56, and pH moves by 14 per full OP; at pH 5.4 and 7.3 by about 35.
Controller K = 0.04 of full OP per pH, T_i = 60 s, OP 0 to 1, scan 2 s
Sensor     electrode: lag 5 s, noise 0.01 pH; range 0 to 14
Load       AR(1), standard deviation 0.0002 mol/L, time constant 240 s
Log        SP, PV [pH] rounded to 0.005, OP [0 to 1] rounded to 0.0002; a row every 15 s for 5 h
Set points pH 5.4 to 7.3, a move every 20 min on average
Nonlinear: titration curve, and F_b W.
"""

from typing import NamedTuple

import numpy as np
from numba import njit

from benchmarks.foreign.instruments import feel, kept, pi_at, planned, scanned, sensor_at, stem, stem_at, through
from benchmarks.foreign.parts import PI, Feed, Sensor, Valve
from benchmarks.foreign.plant import Effect, Load, Moves, Plant

KW, KA = 1e-14, 10.0**-6.35


class Process(NamedTuple):
    """Volume [L], flows [L/s], concentrations [mol/L]."""

    V: float = 600.0
    acid: float = 6.0
    base: float = 2.4
    ions: float = -0.02
    buffer: float = 0.005
    lye: float = 0.1
    corner: float = 0.0
    fouls: float = 0.0


class Parameters(NamedTuple):
    """All of it."""

    controller: PI = PI(K=0.04, T_i=60.0, scan=2.0)
    valve: Valve = Valve()
    process: Process = Process()
    sensor: Sensor = Sensor(sd=0.01, tau=5.0)
    feed: Feed = Feed()


@njit(cache=True)
def ions_at(pH, B):
    """Return the strong ions [mol/L] that give a pH with buffer ``B``."""
    H = 10.0**-pH
    return B * KA / (KA + H) + KW / H - H


@njit(cache=True)
def pH_of(W, B, guess):
    """Return the pH of strong ions ``W`` and buffer ``B`` [mol/L]: Newton in pH, each step at most 1."""
    pH = guess
    for _ in range(30):
        H = 10.0**-pH
        slope = np.log(10.0) * (B * KA * H / (KA + H) ** 2 + KW / H + H)
        step = min(max((W - ions_at(pH, B)) / slope, -1.0), 1.0)
        pH += step
        if abs(step) < 1e-10:
            break
    return pH


@njit(cache=True)
def run(p, sp, load, noise, luck, dt, first, every, out):
    """Run the plant; see ``Plant``."""
    g, scan, pH = p.process, round(p.controller.scan / dt), sp[0, 0]
    op = 0.55
    for _ in range(50):
        B = g.acid * g.buffer / (g.acid + g.base * op)
        W = ions_at(pH, B)
        op = g.acid * (W - g.ions) / (g.base * (g.lye - W))
    W2, B2 = W, B
    pv, seen = pH, pH
    held = pi_at(op)
    x = stem_at(op)
    m = sensor_at(pH)
    V, V2 = g.V * (1.0 - g.corner), g.V * g.corner
    for i in range(sp.shape[1]):
        t = (i - first) * dt
        if i % scan == 0:
            seen, pv, op = scanned(p, held, m, sp[0, i], noise[0], luck, int(i * dt / 2.0 + 1e-6), t)
        kept(out, i - first, every, seen, pv, op)
        F = g.base * through(p.valve, stem(p.valve, x, op, t, dt))
        ions = g.ions + load[0, int(i * dt)] + planned(p.feed, t)
        swap = V2 / 400.0
        dW = (g.acid * ions + F * g.lye - (g.acid + F) * W + swap * (W2 - W)) / V
        dB = (g.acid * g.buffer - (g.acid + F) * B + swap * (B2 - B)) / V
        W2 += dt * (W - W2) / 400.0
        B2 += dt * (B - B2) / 400.0
        W += dt * dW
        B += dt * dB
        pH = pH_of(W, B, pH)
        if g.fouls > 0.0:
            m[0] += (pH - m[0]) * (1.0 - np.exp(-dt / (p.sensor.tau + g.fouls * (t % 2400.0) / 2400.0)))
        else:
            feel(p.sensor, m, pH, dt)


PLANT = Plant(
    "neutralisation", Parameters(), run,
    tags={"SP": 0.01, "PV": 0.005, "OP": 0.0002},
    set_points=(Moves(5.4, 7.3, 1200.0, 6.5),), loads=(Load(0.0002, 240.0),), sensors=("sensor",),
    hours=5.0, dt=0.1, scan=2.0, row=15.0, warm=600.0,
    effects={
        "stiction": Effect("valve", lambda s: {"valve.S": 0.01 * s, "valve.J": 0.004 * s}),
        "deadband": Effect("valve", lambda s: {"valve.S": 0.008 * s}),
        "positioner_lag": Effect("valve", lambda s: {"valve.tau": 15.0 * s}),
        "valve_gain": Effect("valve", lambda s: {"valve.gain": 1.05**s}, signed=True),
        "sensor_bias": Effect("sensor", lambda s: {"sensor.bias": 0.3 * s}, signed=True),
        "sensor_drift": Effect("sensor", lambda s: {"sensor.drift": 0.12 * s}, signed=True),
        "sensor_lag": Effect("sensor", lambda s: {"sensor.tau": 5.0 + 10.0 * s}),
        "process_time_constant": Effect("process", lambda s: {"process.V": 600.0 * 1.3**s}, signed=True),
        "controller_gain": Effect("controller", lambda s: {"controller.K": 0.04 * 1.4**s}, signed=True),
        "slug": Effect("feed", lambda s: {"feed.slug": 0.0012 * s, "feed.period": 400.0}),
    },
    outside={
        # a part of the tank is a corner that exchanges what it holds in 400 s
        "stagnant": Effect("process", lambda s: {"process.corner": 0.3 * s}),
        # its lag grows for 40 min, until it is cleaned and all begins anew
        "electrode_fouls": Effect("sensor", lambda s: {"process.fouls": 25.0 * s}),
        # the stem takes whole steps of OP only
        "coarse_positioner": Effect("valve", lambda s: {"valve.resolution": 0.012 * s}),
    },
)  # fmt: skip

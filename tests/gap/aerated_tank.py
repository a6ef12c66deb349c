"""Dissolved oxygen by air in plain Python, nonlinear, scanned every 2 s, with a row every 15 s; and its model.

C' = k MV (C_s - C) - q C / (K_s + C) - load          Monod's uptake; Euler at 0.5 s
"""

import math

import numpy as np
from stickslip.blocks import Equations, IdealValve, Noise, SampledPI, SampledSensor
from stickslip.diagram import wire
from stickslip.logs import Log

K, C_S, Q, K_S, STEP, BEFORE = 2e-4, 8.5, 0.045, 0.4, 0.5, 1500.0


def aerated(seed, hours=4.0):
    """Return a log of the tank; set points switch at any instant."""
    rng = np.random.default_rng(seed)
    steps, whole = round((BEFORE + 3600.0 * hours) / STEP), round(2.0 / STEP)
    SP = np.repeat(rng.uniform(1.2, 3.0, steps // 1501 + 1).round(2), 1501)[:steps]
    kept, C, seen, OP, z, load, rows = math.exp(-2.0 / 600.0), SP[0], SP[0], 29.0, 29.0, 0.0, []
    for k in range(steps):
        if k % whole == 0:
            load = kept * load + math.sqrt(1.0 - kept**2) * rng.normal(scale=0.003)
            PV = seen + rng.normal(scale=0.03)
            z = z + 8.0 * 2.0 / 100.0 * (SP[k] - PV)
            OP = min(max(z + 8.0 * (SP[k] - PV), 0.0), 100.0)
        t = k * STEP - BEFORE
        if t >= 0.0 and t % 15.0 == 0.0:
            rows.append((t, SP[k], round(PV, 2), round(OP, 1)))
        seen += STEP / 25.0 * (C - seen)
        C += STEP * (K * OP * (C_S - C) - Q * C / (K_S + C) - load)
    t, SP, PV, OP = np.array(rows).T
    return Log(t, {"SP": SP, "PV": PV, "OP": OP})


def aerated_model():
    """Return the model as a user wires it."""

    def rate(C, MV, load):
        return K * MV * (C_S - C) - Q * C / (K_S + C) - load

    return wire(
        [
            SampledPI(8.0, 100.0, dt=2.0, low=0.0, high=100.0, integral="present", start_op=29.0),
            IdealValve(),
            Noise("load", sd=0.003, dt=2.0, correlation_time=600.0, name="feed"),
            Equations("process", der=rate, states={"C": 2.0}, inputs=["MV", "load"], outputs="C"),
            SampledSensor(2.0, sd=0.03, tau=25.0, start=2.0, inputs="C", outputs="PV"),
        ],
        inputs=["SP"],
    )

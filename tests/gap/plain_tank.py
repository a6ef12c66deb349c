"""A level in plain numpy, from its equations alone: what a plant computes that shares no code with the engine.

    dh/dt = (x + load - outflow(h))/60         outflow: 0.5 sqrt(h), or 0.5 + 0.25 (h - 1)
    x = v = 2 (SP - PV) + z                    at each scan of 2 s, z += 2 (2/120)(SP - PV) behind it; 0 <= x <= 1
    load AR(1) 0.01, 100 s, in steps of 1 s; noise 0.004 each second; a row each 5 s

``model`` is the same wired from blocks.
"""

import math

import numpy as np
from stickslip.blocks import Equations, FirstOrder, IdealValve, Noise, SampledPI, SampledSensor, Sum
from stickslip.diagram import Diagram, wire
from stickslip.logs import Log

LEVELS = (1.0, 1.06, 0.97, 1.1, 1.05, 0.95, 1.02)
K, T_I, SCAN, N, FINE = 2.0, 120.0, 2.0, 10.0, 20
LOAD, LOAD_TIME, NOISE = 0.01, 100.0, 0.004


def logged(effect="none", size=0.0, *, seed=1, root=True, duration=5400.0, quiet=False, levels=LEVELS, digits=4):
    """Return the log of the plant with one effect; ``quiet``: without load and noise; ``digits`` of PV and OP."""
    rng = np.random.default_rng(seed)
    load_sd, noise = (0.0, 0.0) if quiet else (LOAD, NOISE)
    phi, dt, n = math.exp(-1.0 / LOAD_TIME), 1.0 / FINE, int(duration)
    h, op, z, load = 1.0, 0.5, 0.5, load_sd * rng.standard_normal()
    lag = ramp = levels[0]
    last, D, u_lag, rows = None, 0.0, 0.5, []
    z += K * (1.0 - size) * levels[0] if effect == "setpoint_weight" else 0.0
    for s in range(n + 1):
        pv = h + noise * rng.standard_normal()
        sp = levels[min(int(s * len(levels) / duration), len(levels) - 1)]
        if s % int(SCAN) == 0:
            lag += (1.0 - math.exp(-SCAN / size)) * (sp - lag) if effect == "setpoint_filter" else 0.0
            ramp += float(np.clip(sp - ramp, -size * SCAN, size * SCAN)) if effect == "setpoint_ramp" else 0.0
            read = {"setpoint_filter": lag, "setpoint_ramp": ramp}.get(effect, sp)
            if effect == "derivative_action":
                D = (size * (pv - (pv if last is None else last)) + size / N * D) / (size / N + SCAN)
            last = pv
            gain = K * (1.0 + size * (pv - levels[0])) if effect == "gain_schedule" else K
            part = size * read - pv if effect == "setpoint_weight" else read - pv
            v = gain * (part - D) + z
            op = min(max(v, 0.0), 1.0)
            z += gain * SCAN / T_I * (read - pv) + op - v
        if s % 5 == 0:
            rows.append((float(s), sp, pv, op))
        for _ in range(FINE):
            x = op
            if effect == "lead":
                speed = (op - u_lag) / (abs(size) / N)
                u_lag += dt * speed
                x = u_lag + size * speed
            h += dt * (x + load - (0.5 * math.sqrt(max(h, 1e-9)) if root else 0.5 + 0.25 * (h - 1.0))) / 60.0
        load = phi * load + load_sd * math.sqrt(1.0 - phi**2) * rng.standard_normal()
    t, SP, PV, OP = np.array(rows).T
    return Log(t, {"SP": SP, "PV": np.round(PV, digits), "OP": np.round(OP, digits)})


def model(root: bool = True) -> Diagram:
    """Return the plant as a user wires it; SP is open."""
    if root:
        level = [
            Equations(
                "tank", der=lambda h, F, A, k: (F - k * max(h, 1e-9) ** 0.5) / A, states={"h": 1.0},
                params={"A": 60.0, "k": 0.5}, inputs="F",
            )
        ]  # fmt: skip
    else:
        level = [
            Sum("F_net", {"F": 1.0}, offset=-0.25),
            FirstOrder(4.0, 240.0, start=1.0, name="tank", inputs="F_net", outputs="h"),
        ]
    return wire(
        [
            SampledPI(K, T_I, dt=SCAN, start_op=0.5, inputs=["SP", "PV"], name="controller"),
            IdealValve(inputs="OP", outputs="MV"),
            Noise("load", sd=LOAD, dt=1.0, correlation_time=LOAD_TIME, name="feed"),
            Sum("F", {"MV": 1.0, "load": 1.0}, name="inflow"),
            *level,
            SampledSensor(dt=1.0, sd=NOISE, start=1.0, inputs="h", outputs="PV"),
        ],
        inputs=["SP"],
    )

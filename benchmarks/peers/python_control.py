"""The ideal loop in python-control alone: ``input_output_response`` has no events, so friction is regularised.

    F(v) = F_v v + c [F_c + (F_s - F_c) exp(-q^2)] tanh(SHARPNESS q),   q = v / V_S,

with c -> 1 away from v = 0 and chosen so that the peak of the first term is F_s exactly. Without c the peak is
too low and the largest error of e is 5.9e-3 instead of 1.5e-5 (20 to 380 times, depending on V_S); with the
customary tanh(5 q) it is 10 % low, and the loop runs into another cycle. A stuck stem creeps, at up to a few
V_S / SHARPNESS. Sharper settings stop BDF ("step size is less than spacing between numbers").
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from typing import NamedTuple

import control as ct
import numpy as np
from stickslip.cases.exact import IDEAL_HIGH, ExactLoop

V_S = 1e-6  # [1/s], width of the Stribeck peak
SHARPNESS = 100.0
RTOL, ATOL = 1e-6, 1e-10


class ControlLog(NamedTuple):
    """Time and control error at the log times, each of shape (n,), and the wall time of the response [s]."""

    t: np.ndarray
    e: np.ndarray
    seconds: float


def friction(F_s: float, F_c: float, v_s: float, sharpness: float) -> Callable[[float], float]:
    """Return the function v -> smooth friction [N] whose peak is F_s exactly, without the viscous part."""
    q = np.geomspace(1e-3, 1.0, 100_000) / math.sqrt(sharpness)
    excess = F_s - F_c
    peak = float(((F_c + excess * np.exp(-q * q)) * np.tanh(sharpness * q)).max())
    lift = F_s / peak - 1.0

    def force(v: float) -> float:
        q = v / v_s
        if abs(q) > 25.0:  # exp(-q^2) < 1e-271
            return math.copysign(F_c, q)
        near = math.exp(-q * q)
        return (F_c + excess * near) * math.tanh(sharpness * q) * (1.0 + lift * near)

    return force


def build(loop: ExactLoop = IDEAL_HIGH, v_s: float = V_S, sharpness: float = SHARPNESS) -> ct.InterconnectedSystem:
    """The closed loop from SP to (PV, OP, MV), of four blocks; states in the order of the block list."""
    force = friction(loop.F_s, loop.F_c, v_s, sharpness)

    def stem(t: float, w: np.ndarray, u: np.ndarray, params: dict) -> tuple[float, float]:
        x, v = w
        return v, (loop.k * (u[0] - x) - force(v) - loop.F_v * v) / loop.M

    return ct.interconnect(
        [
            ct.ss(0.0, 1.0, loop.K_i, loop.K_p, inputs="e", outputs="OP", name="controller"),
            ct.nlsys(stem, lambda t, w, u, params: w[0], inputs="OP", outputs="MV", states=["x", "v"], name="stem"),
            ct.ss(loop.a, loop.b, 1.0, 0.0, inputs="MV", outputs="PV", name="process"),
            ct.summing_junction(["SP", "-PV"], "e", name="error"),
        ],
        inputs="SP",
        outputs=["PV", "OP", "MV"],
        name="ideal_loop",
    )


def run(
    loop: ExactLoop = IDEAL_HIGH,
    v_s: float = V_S,
    sharpness: float = SHARPNESS,
    rtol: float = RTOL,
    atol: float = ATOL,
    method: str = "BDF",
) -> ControlLog:
    """Simulate the loop; ``seconds`` is the response without building the system."""
    system = build(loop, v_s, sharpness)
    t = np.arange(round(loop.duration / loop.log_interval) + 1) * loop.log_interval
    start = time.perf_counter()
    response = ct.input_output_response(
        system,
        t,
        np.full_like(t, loop.SP),
        [loop.z_0 / loop.K_i, loop.x_0, 0.0, loop.PV_0],
        solve_ivp_method=method,
        solve_ivp_kwargs={"rtol": rtol, "atol": atol},
    )
    seconds = time.perf_counter() - start
    return ControlLog(t, loop.SP - np.asarray(response.outputs)[0], seconds)

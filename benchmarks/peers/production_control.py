"""The production plant in python-control alone: ``input_output_response`` has no events, so friction is regularised.

Two twins, both with stems that have mass:

    flat     one ``ct.nlsys`` of the flat equations on Python's own numbers, the fastest that runs interpreted; the
             friction is that of ``benchmarks.peers.python_control``
    diagram  the plant wired of blocks, as a python-control system: each rate asks all of its 49 blocks; stems are
             blocks as well, seen as python-control sees them (``stickslip.blocks.seen_stem``)

BDF with V_S = 1e-6 is the best: it follows the plant with mass to 7e-6 bar until the fourth slip.  A peak a hundred
times wider is up to twice as fast, but on another path after 20 s (0.8 bar); LSODA then runs, and gives up ("Unexpected
istate") at V_S = 1e-5 and below; Radau is slower throughout.  With its rates compiled by numba the flat twin takes two
thirds of the time: the rest is scipy's BDF.
"""

import time
from typing import NamedTuple

import control as ct
import numpy as np
from stickslip.blocks.stick_slip import StickSlip
from stickslip.diagram.diagram import Diagram

from benchmarks.peers import production_equations as equations
from benchmarks.peers.production_lsoda import Problem
from benchmarks.peers.python_control import SHARPNESS, V_S, friction

RTOL, ATOL = 1e-6, 1e-9
M, K, F_V, F_C = 1.36, 52500.0, 612.0, 1250.0  # of the stems, thesis table A.1


class ControlLog(NamedTuple):
    """Time (n,), p_1 [Pa] and V_1 [m3] at the log times, and the processor time of the response [s]."""

    t: np.ndarray
    p_1: np.ndarray
    V_1: np.ndarray
    seconds: float


def stem_rate(OP: float, x: float, v: float, force) -> float:
    """Return dv/dt of a stem [1/s2]."""
    return (K * (OP - x) - force(v) - F_V * v) / M


def flat(given: Problem, F_s: float, v_s: float = V_S, sharpness: float = SHARPNESS):
    """Return the flat twin and its start: 23 states of the plant, position and velocity of both stems."""
    c, force = tuple(given.c.tolist()), friction(F_s, F_C, v_s, sharpness)

    def rates(t, y, u, params):
        *s, x_oil, v_oil, x_gas, v_gas = y.tolist()
        OP_oil, OP_gas = equations.openings(s)
        a_oil = stem_rate(equations.clip(OP_oil), x_oil, v_oil, force)
        a_gas = stem_rate(equations.clip(OP_gas), x_gas, v_gas, force)
        return np.array((*equations.rates(s, x_oil, x_gas, c), v_oil, a_oil, v_gas, a_gas))

    def outputs(t, y, u, params):
        return np.array(equations.pressure_and_level(y))

    names = [key.replace(".", "_") for key in equations.ORDER]
    states = [*names, "x_VLCS1", "v_VLCS1", "x_VPCS1", "v_VPCS1"]
    system = ct.nlsys(rates, outputs, inputs=1, outputs=["p_1", "V_1"], states=states, name="flat")
    return system, np.array([*given.y, given.valves[1], 0.0, given.valves[3], 0.0])


def diagram(plant: Diagram, F_s: float):
    """Return the wired plant with stems that have mass, and its start."""
    for valve in ("VLCS1", "VPCS1"):
        start = float(plant[valve].d0[plant[valve].memory_names.index("x")])
        plant = plant.replace(valve, StickSlip(F_s, F_C, k=K, M=M, F_v=F_V, start=start, name=valve))
    twin = Diagram(plant.blocks, outputs=["p_1", "V_1"], name="diagram")
    return twin, twin.x0


def run(
    system, start: np.ndarray, duration: float, every: float = 0.1, rtol: float = RTOL, atol: float = ATOL,
    method: str = "BDF",
) -> ControlLog:  # fmt: skip
    """Simulate a twin; ``seconds`` is the processor time of the response without building the system."""
    t = np.arange(round(duration / every) + 1) * every
    begin = time.process_time()
    response = ct.input_output_response(
        system, t, np.zeros((system.ninputs, t.size)), start, solve_ivp_method=method,
        solve_ivp_kwargs={"rtol": rtol, "atol": atol},
    )  # fmt: skip
    seconds = time.process_time() - begin
    p_1, V_1 = np.asarray(response.outputs)
    return ControlLog(t, p_1, V_1, seconds)

"""The diagrams of the simulated loops, one per structure, and the parameters that make a loop of one.

    load ---------\
    SP -> PI -> valve -> (+) -> process -> sensor -> PI

All values are deviations from rest: OP and MV in % of the span from ``op0``, PV in % of its span.
"""

from collections.abc import Mapping
from functools import lru_cache
from typing import Any, TypeAlias

from stickslip.blocks import (
    PID,
    Biquad,
    ChenValve,
    FirstOrder,
    HeValve,
    Integrator,
    KanoValve,
    LuGreStem,
    SampledFilter,
    SampledPI,
    SampledSensor,
    SecondOrder,
    StickSlip,
    StribeckStem,
    Sum,
)  # fmt: skip
from stickslip.blocks.block import Block
from stickslip.calibration.excitation import Excitation
from stickslip.calibration.spec import LoopSpec
from stickslip.diagram import Diagram, wire

Structure: TypeAlias = tuple[str, str, str]
"""Valve, process and controller, by the words of ``LoopSpec``."""

STEMS = ("stick_slip", "stribeck", "lugre")
DAMPING = 1.2  # of a stem without dry friction: no overshoot


def _valve(word: str) -> list[Block]:
    own: dict[str, Any] = {"low": -50.0, "high": 50.0, "inputs": {"OP": "OP"}, "outputs": {"MV": "MV"}}
    if word == "kano":
        return [KanoValve(1.0, 0.5, 1.0, **own)]
    if word == "chen":
        return [ChenValve(1.0, 0.5, 1.0, **own)]
    if word == "he":
        return [HeValve(0.75, 0.25, 1.0, **own)]
    if word == "stick_slip":
        return [StickSlip(0.75, 0.25, k=1.0, M=0.1, F_v=1.0, **own)]
    own["inputs"] = {"OP": "air"}
    lag = FirstOrder(1.0, 1.0, name="actuator", inputs={"MV": "OP"}, outputs={"PV": "air"})
    if word == "stribeck":
        return [lag, StribeckStem(0.75, 0.25, k=1.0, M=0.1, F_v=1.0, v_s=0.1, **own)]
    return [lag, LuGreStem(0.75, 0.25, k=1.0, M=0.1, F_v=1.0, sigma_0=50.0, sigma_1=1.0, v_s=0.1, **own)]


def _process(word: str) -> Block:
    wires: dict[str, Any] = {"inputs": {"MV": "F"}, "outputs": {"PV": "PV"}}
    if word == "one_lag":
        return FirstOrder(1.0, 10.0, 1.0, name="process", **wires)
    if word == "two_lags":
        return SecondOrder.from_lags(1.0, 10.0, 5.0, 1.0, name="process", **wires)
    return Integrator(1.0, 1.0, 1.0, name="process", inputs={"MV": "F_l"}, outputs={"PV": "PV"})


def _controller(word: str) -> list[Block]:
    limits: dict[str, Any] = {"low": -50.0, "high": 50.0, "outputs": {"OP": "OP"}, "name": "controller"}
    if word == "pi":
        return [SampledPI(1.0, 10.0, dt=1.0, inputs={"SP": "SP", "PV": "PV_m"}, **limits)]
    if word == "pi_filtered":
        smooth = SampledFilter("PV_f", "PV_m", 1.0, 1.0, name="filter")
        return [smooth, SampledPI(1.0, 10.0, dt=1.0, inputs={"SP": "SP", "PV": "PV_f"}, **limits)]
    if word == "pid_weighted":
        return [PID(1.0, 10.0, 1.0, N=8.0, c=0.0, inputs={"SP": "SP", "PV": "PV_m"}, **limits)]
    lead = Biquad("PV_f", "PV_m", b=[1.0, 0.0, 0.0], a=[0.0, 0.0], dt=1.0, name="lead")
    return [lead, SampledPI(1.0, 10.0, dt=1.0, inputs={"SP": "SP", "PV": "PV_f"}, **limits)]


@lru_cache(maxsize=128)
def diagram(structure: Structure) -> Diagram:
    """Return the diagram of a structure, built once."""
    valve, process, controller = structure
    blocks: list[Block] = [Excitation("load", 1.0), Excitation("SP", 1.0), *_valve(valve)]
    blocks.append(Sum("F", {"MV": 1.0, "load": 1.0}))
    if process == "integrating":
        blocks.append(FirstOrder(1.0, 1.0, name="lag", inputs={"MV": "F"}, outputs={"PV": "F_l"}))
    sensor = SampledSensor(1.0, sd=1.0, name="sensor", inputs={"PV": "PV"}, outputs={"PV_m": "PV_m"})
    blocks += [_process(process), sensor, *_controller(controller)]
    return wire(blocks, outputs=["SP", "PV_m", "OP", "MV"])


def structure_of(spec: LoopSpec) -> Structure:
    """Return which diagram a loop runs on."""
    return spec.valve, spec.process, spec.controller


def parameters(spec: LoopSpec, valve: str, limited: bool) -> Mapping[str, float]:
    """Return the parameters of process, controller and valve of one loop, by the names of its diagram.

    The times of the spec count in scans here.  ``valve``: law of friction in place of the spec's; ``limited``: OP
    stops at its limits.
    """
    low, high = (-spec.op0, 100.0 - spec.op0) if limited else (-1e6, 1e6)
    found = {"F.w_MV": spec.authority, "controller.low": low, "controller.high": high}
    found |= {"controller.K_p": spec.K_p, "controller.T_i": spec.T_i, "process.theta": spec.theta}
    found["controller.action"] = 1.0 if spec.K > 0.0 else -1.0
    if spec.controller == "pid_weighted":  # a filter no faster than a scan
        found |= {"controller.b": spec.b, "controller.T_d": spec.T_d, "controller.N": min(8.0, spec.T_d)}
    if spec.controller == "pid_series":  # PI of (1 + T_d s)/(1 + T_f s) PV, with s = 1 - 1/z
        T_f = series_filter(spec.T_d)
        found |= {"lead.b_0": (1.0 + spec.T_d) / (1.0 + T_f), "lead.b_1": -spec.T_d / (1.0 + T_f)}
        found["lead.a_1"] = -T_f / (1.0 + T_f)
    if spec.controller == "pi_filtered":
        found["filter.tau"] = spec.T_f
    if spec.process == "integrating":
        found |= {"process.K": spec.K, "lag.tau": max(spec.tau2, 0.01)}
    elif spec.process == "one_lag":
        found |= {"process.K": spec.K, "process.tau": spec.tau1}
    else:
        root = (spec.tau1 * spec.tau2) ** 0.5
        found |= {"process.K": spec.K, "process.omega": 1.0 / root}
        found["process.zeta"] = (spec.tau1 + spec.tau2) / (2.0 * root)
    return found | _bands(spec, valve, low, high)


def series_filter(T_d: float) -> float:
    """Return the filter's time constant of the PID in series form for a derivative time, both in scans."""
    return max(T_d / 8.0, 0.5)


def _bands(spec: LoopSpec, valve: str, low: float, high: float) -> dict[str, float]:
    """Return the parameters of the valve."""
    S, J = spec.S, spec.J
    static, kinetic = 0.5 * (S + J), 0.5 * (S - J)
    found = {"valve.low": low, "valve.high": high}
    if valve in ("kano", "chen"):
        return found | {"valve.S": S, "valve.J": J}
    if valve == "he":
        return found | {"valve.f_s": static, "valve.f_d": kinetic}
    if valve == "creeping":
        creep = {"valve.give": spec.give * S, "valve.uneven": spec.unevenness, "valve.lag": spec.valve_lag}
        return found | {"valve.S": S, "valve.J": J} | creep
    mass = (spec.valve_lag / (2.0 * DAMPING)) ** 2
    found |= {"valve.F_s": max(static, 1e-3), "valve.F_c": max(kinetic, 1e-3), "valve.F_v": spec.valve_lag}
    found["valve.M"] = mass
    if valve == "stick_slip":
        return found | {"valve.v_stop": 1e-3 * max(S, 1.0)}
    found |= {"actuator.tau": spec.valve_lag, "valve.v_s": 0.02 * max(J, 0.1) / spec.valve_lag}
    if valve == "lugre":
        stiffness = max(static, 0.05) / (0.02 * max(S, 1.0))
        found |= {"valve.sigma_0": stiffness, "valve.sigma_1": (stiffness * mass) ** 0.5}
    return found

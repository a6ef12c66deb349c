"""Loops without noise into which the tests put effects, and a small and a plain size of every effect."""

from stickslip.blocks import Staircase
from stickslip.cases.models import ideal_flow
from stickslip.diagram import simulate, wire
from stickslip.gap.effects import effect

EXACT = {"rtol": 1e-12, "atol": 1e-14}
SP, T = Staircase("SP", [1.5, 1.8, 1.35, 1.65], dwell=100.0), 400.0
LOGGED = ("SP", "PV", "OP")


def quiet(model=ideal_flow, sp=SP, rest=1.5):
    """Return a loop without its noises, driven by a staircase."""
    loop = model(rest=rest)
    return wire([sp, *loop.with_params({f"{b.name}.sd": 0.0 for b in loop.blocks if "sd" in b.params}).blocks])


def run(diagram, **keywords):
    return simulate(diagram, T, every=1.0, **{**EXACT, **keywords}).log


def put(name, place, loop=None, **values):
    return effect(name).insert(quiet() if loop is None else loop, place, **values)


# a small and a plain size of every effect of a loop: near the neutral values, and well away from them
SIZES = {
    "stiction": ("valve", {"S": 1e-7, "J": 5e-8}, {"S": 5.0, "J": 2.0}),
    "deadband": ("valve", {"width": 1e-7}, {"width": 3.0}),
    "valve_leak": ("valve", {"flow": 1e-7}, {"flow": 2.0}),
    "valve_saturation": ("valve", {"low": 1e-7}, {"high": 55.0}),
    "valve_rate_limit": ("valve", {"rate": 1e9}, {"rate": 1.0}),
    "positioner_lag": ("valve", {"tau": 1e-7}, {"tau": 3.0}),
    "valve_characteristic": ("valve", {"rangeability": 1.0 + 1e-8}, {"rangeability": 10.0}),
    "valve_gain": ("valve", {"factor": 1.0 + 1e-8}, {"factor": 1.2}),
    "dead_time": ("process", {"theta": 0.02}, {"theta": 3.0}),
    "process_gain": ("process", {"factor": 1.0 + 1e-8}, {"factor": 1.2}),
    "process_time_constant": ("process", {"factor": 1.0 + 1e-8}, {"factor": 1.3}),
    "second_lag": ("process", {"tau": 1e-7}, {"tau": 3.0}),
    "sensor_bias": ("sensor", {"offset": 1e-8}, {"offset": -0.1}),
    "sensor_drift": ("sensor", {"rate": 1e-8}, {"rate": 0.5}),
    "sensor_span": ("sensor", {"factor": 1.0 + 1e-8}, {"factor": 1.1}),
    "sensor_lag": ("sensor", {"tau": 1e-7}, {"tau": 3.0}),
    "quantisation": ("sensor", {"step": 1e-3}, {"step": 0.05}),
    "sensor_saturation": ("sensor", {"high": 1e9}, {"high": 1.6}),
    "controller_gain": ("controller", {"factor": 1.0 + 1e-8}, {"factor": 1.5}),
    "controller_integral_time": ("controller", {"factor": 1.0 + 1e-8}, {"factor": 1.5}),
    "controller_limits": ("controller", {"low": 1e-8}, {"high": 58.0}),
    "controller_filter": ("controller", {"tau": 1e-7}, {"tau": 3.0}),
    "scan_time": ("controller", {"period": 1e-4}, {"period": 4.0}),
    "derivative_action": ("controller", {"T_d": 1e-6}, {"T_d": 3.0}),
    "gain_schedule": ("controller", {"slope": 1e-8}, {"slope": 1.0}),
    "setpoint_filter": ("controller", {"tau": 1e-7}, {"tau": 5.0}),
    "setpoint_ramp": ("controller", {"rate": 1e9}, {"rate": 0.02}),
    "setpoint_weight": ("controller", {"b": 1.0 + 1e-8}, {"b": 0.4}),
    "lead": ("process", {"T": 1e-6}, {"T": -3.0}),
    "sine_disturbance": ("feed", {"amplitude": 1e-8, "period": 60.0}, {"amplitude": 0.05, "period": 60.0}),
    "step_disturbance": ("feed", {"amplitude": 1e-8, "time": 50.0}, {"amplitude": 0.05, "time": 50.0}),
    "slug": ("feed", {"amplitude": 1e-8, "period": 90.0}, {"amplitude": 0.05, "period": 90.0}),
}
ELSEWHERE = {"tank_overflow", "sensor_noise", "compression"}
EXACTLY = {"first": {"SP": 1.5, "PV": 1.5, "OP": 0.5}}

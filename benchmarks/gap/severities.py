"""How large each effect of the benchmark is, by severity, and how it stands in the numbers of ``physics``.

Sizes are tied to what they do: "just visible" moves PV by about as much as its noise, "typical" is what a technician
would correct, "gross" what an operator notices.  Each record draws its own within +-20 % of these.
"""

import math
from collections.abc import Callable, Mapping

import numpy as np

from benchmarks.gap.settings import Setting

SEVERITIES = ("just visible", "typical", "gross")
Values = dict[str, float]
Random = np.random.Generator

# name -> main size for just visible, typical, gross, in the units of the contract
IDEAL: Mapping[str, tuple[float, float, float]] = {
    "stiction": (0.6, 3.0, 8.0), "deadband": (0.4, 2.0, 6.0), "valve_leak": (0.15, 1.0, 4.0),
    "valve_saturation": (2.0, 5.0, 10.0), "valve_rate_limit": (6.0, 1.0, 0.3), "positioner_lag": (0.3, 2.0, 6.0),
    "valve_characteristic": (1.2, 4.0, 25.0), "valve_gain": (1.01, 1.1, 1.35),
    "dead_time": (0.2, 1.5, 4.0), "process_gain": (1.01, 1.1, 1.35), "process_time_constant": (1.03, 1.2, 1.7),
    "second_lag": (0.3, 2.0, 6.0),
    "sensor_bias": (0.006, 0.05, 0.2), "sensor_drift": (0.006, 0.06, 0.3), "sensor_span": (1.005, 1.05, 1.2),
    "sensor_lag": (0.3, 2.0, 6.0), "sensor_noise": (1.15, 2.0, 5.0), "quantisation": (0.005, 0.02, 0.06),
    "compression": (0.004, 0.012, 0.04),
    "controller_gain": (1.02, 1.2, 1.7), "controller_integral_time": (1.05, 1.3, 2.0),
    "controller_limits": (2.0, 5.0, 10.0), "controller_filter": (0.3, 2.0, 6.0), "scan_time": (0.5, 2.0, 6.0),
    "sine_disturbance": (0.0006, 0.005, 0.03), "step_disturbance": (0.002, 0.015, 0.06), "slug": (0.0012, 0.008, 0.04),
}  # fmt: skip
# where the load and the tolerances hide what is smaller
SITE: Mapping[str, tuple[float, float, float]] = {
    **IDEAL, "stiction": (1.0, 3.0, 8.0), "deadband": (0.7, 2.0, 6.0), "valve_leak": (0.5, 2.0, 6.0),
    "valve_characteristic": (1.6, 4.0, 25.0), "valve_gain": (1.08, 1.2, 1.5), "process_gain": (1.08, 1.2, 1.5),
    "process_time_constant": (1.15, 1.4, 2.0), "sensor_bias": (0.03, 0.1, 0.3), "sensor_drift": (0.03, 0.1, 0.4),
    "sensor_span": (1.08, 1.2, 1.5), "positioner_lag": (0.7, 2.0, 6.0), "second_lag": (0.7, 2.0, 6.0),
    "sensor_lag": (0.7, 2.0, 6.0), "dead_time": (0.5, 1.5, 4.0), "scan_time": (2.0, 3.0, 6.0),
    "sine_disturbance": (0.003, 0.012, 0.04), "step_disturbance": (0.015, 0.04, 0.1), "slug": (0.006, 0.02, 0.06),
}  # fmt: skip
# effects that no catalogue has: size and second number for the three severities; only the first set sets gates
OUTSIDE: Mapping[str, tuple[tuple[float, float], ...]] = {
    "sensor_hysteresis": ((0.006, 0.0), (0.03, 0.0), (0.1, 0.0)),
    "multiplicative_noise": ((0.001, 0.0), (0.004, 0.0), (0.012, 0.0)),
    "sticky_sensor": ((0.01, 0.0), (0.03, 0.0), (0.08, 0.0)),
    "gain_by_direction": ((0.004, 0.0), (0.02, 0.0), (0.06, 0.0)),
    "inverse_response": ((0.3, 0.5), (2.0, 2.0), (5.0, 3.0)),
    "intermittent_dead_time": ((0.4, 0.0), (2.0, 0.0), (5.0, 0.0)),
    "asymmetric_lag": ((0.05, 0.0), (0.2, 0.0), (0.5, 0.0)),
    "oscillating_gain": ((0.003, 200.0), (0.02, 200.0), (0.08, 200.0)),
    "quantised_output": ((0.004, 0.0), (0.015, 0.0), (0.05, 0.0)),
    "controller_gap": ((0.004, 0.0), (0.015, 0.0), (0.05, 0.0)),
    "frozen_sensor": ((0.01, 8.0), (0.05, 15.0), (0.15, 30.0)),
    "wavy_trim": ((0.003, 0.15), (0.012, 0.15), (0.03, 0.25)),
    "set_point_weight": ((0.97, 0.0), (0.8, 0.0), (0.3, 0.0)),
    "jammed_stem": ((0.02, 10.0), (0.08, 20.0), (0.2, 40.0)),
    "wave_packet": ((0.004, 60.0), (0.015, 60.0), (0.06, 60.0)),
    "wandering_load": ((0.0015, 300.0), (0.006, 300.0), (0.02, 300.0)),
    "fouling_gain": ((0.01, 7200.0), (0.06, 7200.0), (0.25, 7200.0)),
    "leaking_integral": ((3e-4, 0.0), (1.5e-3, 0.0), (6e-3, 0.0)),
    "switching_bias": ((0.006, 200.0), (0.03, 200.0), (0.1, 200.0)),
    "spiking_sensor": ((0.02, 60.0), (0.1, 60.0), (0.4, 60.0)),
    "bursting_noise": ((0.5, 120.0), (2.0, 120.0), (5.0, 120.0)),
    "chirping_load": ((0.001, 0.0), (0.005, 0.0), (0.03, 0.0)),
}
KNOWN = tuple(OUTSIDE)[:16]
NAMED_NOW = ("set_point_weight",)  # the catalogue has it since 26 November 2026
OUTSIDE_FOR_TUNING = tuple(name for name in KNOWN[::2] if name not in NAMED_NOW)
OUTSIDE_FOR_REPORT = KNOWN[1::2]
NEVER_SEEN = tuple(OUTSIDE)[16:]  # made after all gates had been set; only report_4 has them


def drawn(name: str, severity: int, rng: Random, setting: Setting, reach: float, seconds: int) -> Values:
    """Return the parameters of an effect in the units of the contract.

    ``reach``: the highest opening of the valve in this record without the effect [%], which limits are set by.
    """
    size = (SITE if setting.scanned else IDEAL)[name][severity]
    swing = float(np.exp(rng.uniform(-0.18, 0.18)))
    if name in FACTORS:
        factor = 1.0 + (size - 1.0) * swing
        return {FACTORS[name]: factor if name in ONE_WAY or rng.random() < 0.5 else 1.0 / factor}
    size *= swing * (setting.slow if name in OF_TIME else setting.span if name in OF_PV else 1.0)
    if name == "stiction":
        return {"S": size, "J": size * rng.uniform(0.25, 0.8)}
    if name in ("valve_saturation", "controller_limits"):
        return {"low": 0.0, "high": reach - size}
    if name in ("sine_disturbance", "slug"):
        period = float(np.exp(rng.uniform(*np.log((25.0, 250.0) if name == "sine_disturbance" else (150.0, 900.0)))))
        return {"amplitude": size, "period": setting.slow * period, "phase": float(rng.uniform())}
    if name == "step_disturbance":
        return {"amplitude": size * rng.choice([-1.0, 1.0]), "time": float(round(rng.uniform(0.15, 0.85) * seconds))}
    if name in ("sensor_bias", "sensor_drift"):
        size *= float(rng.choice([-1.0, 1.0]))
    if name == "dead_time":
        size = round(size, 2)
    if name == "scan_time":
        size = max(2.0, round(size)) if setting.scanned else max(0.2, round(size, 1))
    return {SIZE[name]: float(size)}


FACTORS = {
    "valve_characteristic": "rangeability", "valve_gain": "factor", "process_gain": "factor",
    "process_time_constant": "factor", "sensor_span": "factor", "sensor_noise": "factor", "controller_gain": "factor",
    "controller_integral_time": "factor",
}  # fmt: skip
OF_TIME = ("positioner_lag", "dead_time", "second_lag", "sensor_lag", "controller_filter", "scan_time")
OF_PV = ("sensor_bias", "sensor_drift", "quantisation", "compression")
ONE_WAY = ("valve_characteristic", "sensor_noise")
SIZE = {
    "deadband": "width", "valve_leak": "flow", "valve_rate_limit": "rate", "positioner_lag": "tau",
    "dead_time": "theta", "second_lag": "tau", "sensor_bias": "offset", "sensor_drift": "rate", "sensor_lag": "tau",
    "quantisation": "step", "compression": "deviation", "controller_filter": "tau", "scan_time": "period",
}  # fmt: skip

# effect -> what it makes of the numbers of the loop; friction, noise and compression are done where records are made
ACTS: Mapping[str, Callable[[Values, Values], Values]] = {
    "deadband": lambda v, p: {"play": v["width"] / 100.0},
    "valve_leak": lambda v, p: {"leak": v["flow"] / 100.0},
    "valve_saturation": lambda v, p: {
        "stop_low": v["low"] / 100.0 if v["low"] > 0.0 else -math.inf, "stop_high": v["high"] / 100.0,
    },
    "valve_rate_limit": lambda v, p: {"rate": v["rate"] / 100.0},
    "positioner_lag": lambda v, p: {"positioner": v["tau"]},
    "valve_characteristic": lambda v, p: {"rangeability": v["rangeability"]},
    "valve_gain": lambda v, p: {"valve_gain": v["factor"]},
    "dead_time": lambda v, p: {"theta": p["theta"] + v["theta"]},
    "process_gain": lambda v, p: {"K": p["K"] * v["factor"]},
    "process_time_constant": lambda v, p: {"tau": p["tau"] * v["factor"], "second": p["second"] * v["factor"]},
    "second_lag": lambda v, p: {"sensor" if p["second"] or p["integrating"] else "second": v["tau"]},
    "sensor_bias": lambda v, p: {"bias": v["offset"]},
    "sensor_drift": lambda v, p: {"drift": v["rate"] / 3600.0},
    "sensor_span": lambda v, p: {"span": v["factor"]},
    "sensor_lag": lambda v, p: {"sensor": v["tau"]},
    "quantisation": lambda v, p: {"step": v["step"]},
    "controller_gain": lambda v, p: {"K_p": p["K_p"] * v["factor"]},
    "controller_integral_time": lambda v, p: {"T_i": p["T_i"] * v["factor"]},
    "controller_limits": lambda v, p: {"low": v["low"] / 100.0, "high": v["high"] / 100.0},
    "controller_filter": lambda v, p: {"filter": v["tau"]},
    "scan_time": lambda v, p: {"scan": v["period"], "present": v.get("present", 1.0)},
    "sine_disturbance": lambda v, p: {"sine": v["amplitude"], "sine_period": v["period"], "sine_phase": v["phase"]},
    "step_disturbance": lambda v, p: {"jump": v["amplitude"], "jump_at": v["time"]},
    "slug": lambda v, p: {"slug": v["amplitude"], "slug_period": v["period"], "slug_phase": v["phase"]},
}  # fmt: skip

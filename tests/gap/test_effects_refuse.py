"""Values that an effect cannot have are refused with the value, the rule and the remedy."""

import math

import pytest
from stickslip.cases.models import cascaded_tanks, ideal_flow
from stickslip.gap.effects import effect
from stickslip.gap.insertion.effect import EffectError
from stickslip.logs import Log

from tests.gap.effect_loops import SIZES, quiet


@pytest.mark.parametrize(
    ("name", "values", "said"),
    [
        ("deadband", {"width": -1.0}, "width = -1, but it must be finite and at least 0; give 0 for none"),
        ("valve_leak", {"flow": math.inf}, "flow = inf, but it must be finite"),
        (
            "valve_saturation",
            {"low": 70.0, "high": 60.0},
            "low = 70 %, high = 60 %, but .* low below high; correct them",
        ),
        ("valve_rate_limit", {"rate": 0.0}, "rate = 0 %/s, but a stem that moves has a rate above 0"),
        ("positioner_lag", {"tau": -1.0}, "tau = -1"),
        ("valve_characteristic", {"rangeability": 0.0}, "rangeability = 0, but it must be finite and above 0; give 1"),
        ("valve_gain", {"factor": -1.0}, "factor = -1"),
        ("dead_time", {"theta": -1.0}, "theta = -1"),
        ("process_gain", {"factor": 0.0}, "factor = 0"),
        ("process_time_constant", {"factor": 0.0}, "factor = 0"),
        ("second_lag", {"tau": -1.0}, "tau = -1"),
        ("sensor_bias", {"offset": math.inf}, "offset = inf, but it must be finite; give 0 for none"),
        ("sensor_drift", {"rate": math.inf}, "rate = inf"),
        ("sensor_span", {"factor": 0.0}, "factor = 0"),
        ("sensor_lag", {"tau": -1.0}, "tau = -1"),
        ("quantisation", {"step": -0.1}, "step = -0.1"),
        ("sensor_saturation", {"low": 2.0, "high": 1.0}, "low = 2, but it must be below high = 1; correct them"),
        ("controller_gain", {"factor": 0.0}, "factor = 0"),
        ("controller_integral_time", {"factor": 0.0}, "factor = 0"),
        ("controller_limits", {"low": 90.0, "high": 60.0}, "low = 90 %, but it must be below high = 60 %"),
        ("controller_filter", {"tau": -1.0}, "tau = -1"),
        ("setpoint_filter", {"tau": -1.0}, "tau = -1"),
        ("setpoint_ramp", {"rate": 0.0}, "rate = 0 per s, but a ramp that moves"),
        ("setpoint_weight", {"b": math.inf}, "b = inf, but it must be finite; give 1 for none"),
        ("derivative_action", {"T_d": -1.0}, "T_d = -1"),
        ("derivative_action", {"T_d": 1.0, "N": 0.0}, "N = 0"),
        ("gain_schedule", {"slope": math.inf}, "slope = inf"),
        ("scan_time", {"period": -1.0}, "period = -1"),
        ("scan_time", {"period": 1.0, "present": 0.5}, "present = 0.5, but it is 0 or 1"),
        ("scan_time", {"period": 1.0, "offset": -1.0}, "the first scan is at 0 s or later"),
        ("sine_disturbance", {"amplitude": 0.1, "period": 0.0}, "period = 0, but .* above 0; give seconds"),
        ("step_disturbance", {"amplitude": math.inf}, "amplitude = inf"),
        ("slug", {"amplitude": -0.1}, "amplitude = -0.1"),
    ],
)
def test_values_that_it_cannot_have_are_refused(name, values, said):
    with pytest.raises(EffectError, match=said):
        effect(name).insert(quiet(), SIZES[name][0], **values)


def test_tanks_noise_and_compression_refuse_too():
    for name, place, loop, values in (
        ("tank_overflow", "tank_1", cascaded_tanks(), {"level": 0.0}),
        ("tank_overflow", "tank_1", cascaded_tanks(), {"level": 5.0, "share": 2.0}),
        ("sensor_noise", "sensor", ideal_flow(), {"factor": -1.0}),
        ("compression", "historian", ideal_flow(), {"deviation": -1.0}),
        ("sensor_noise", "sensor", quiet(), {"factor": 2.0}),
    ):
        with pytest.raises(EffectError):
            effect(name).insert(loop, place, **values)
    with pytest.raises(EffectError, match="deviation = -1"):
        effect("compression").on_log(Log(t=[0.0, 1.0], signals={"PV": [0.0, 1.0]}), deviation=-1.0)

"""What a controller of a plant does that the model's does not, beside a plant in plain numpy."""

import math
from dataclasses import replace

import numpy as np
import pytest
from stickslip.blocks import Staircase
from stickslip.diagram import simulate
from stickslip.diagram.inputs import close
from stickslip.gap import diagnose
from stickslip.gap.effects import effect
from stickslip.gap.likelihood.candidates import by_race
from stickslip.gap.likelihood.hypothesis import Hypothesis
from stickslip.gap.likelihood.search import model_alone
from stickslip.gap.likelihood.settling import settled

from tests.gap.plain_tank import LEVELS, logged, model
from tests.gap.root_tank import framed

SIZES = {
    "setpoint_filter": ("controller", "tau", 15.0), "setpoint_ramp": ("controller", "rate", 0.0015),
    "setpoint_weight": ("controller", "b", 0.4), "derivative_action": ("controller", "T_d", 15.0),
    "gain_schedule": ("controller", "slope", 2.0), "lead": ("tank", "T", 20.0),
}  # fmt: skip
ALIKE = (
    *SIZES, "controller_gain", "controller_integral_time", "process_gain", "process_time_constant", "second_lag",
    "dead_time", "valve_rate_limit", "step_disturbance", "deadband",
)  # fmt: skip
FIRST = {"SP": 1.0, "PV": 1.0, "OP": 0.5, "MV": 0.5, "F": 0.5, "h": 1.0}
AT = [math.ceil(5400.0 * k / len(LEVELS)) for k in range(len(LEVELS))]


@pytest.mark.parametrize("name", SIZES)
def test_an_effect_does_what_a_plant_in_plain_numpy_does(name):
    place, key, size = SIZES[name]
    still = model().with_params({"feed.sd": 0.0, "sensor.sd": 0.0})
    changed = effect(name).started(effect(name).insert(still, place, **{key: size}), place, FIRST)
    run = simulate(close(changed, {"SP": Staircase("SP", at=AT, levels=LEVELS)}), 5400.0, every=5.0).log
    plant, other = logged(name, size, quiet=True), logged(quiet=True)
    for signal, near in (("PV", 5e-4), ("OP", 1e-3)):
        left = float(np.abs(run[signal] - plant[signal]).max())
        assert left < near and left < 0.1 * float(np.abs(other[signal] - plant[signal]).max())


@pytest.mark.parametrize(("name", "root"), [("setpoint_ramp", False), ("gain_schedule", True), ("lead", False)])
def test_it_is_named_with_its_size(name, root):
    place, key, size = SIZES[name]
    log, known = logged(name, size, root=root, duration=2700.0), [effect(one) for one in ALIKE]
    report = diagnose(model(root), log, catalogue=known, limits=False)
    (cause,) = report.causes
    assert (cause.effect, cause.place) == (name, place)
    assert cause.parameters[key].value == pytest.approx(size, rel=0.12)


def test_a_ramp_that_takes_minutes_is_among_the_first_sizes():
    # rates below 2e-4 of span a second were out of bounds, and first rates lay a factor 3.2 apart
    rough = model_alone(replace(framed(model(), logged("setpoint_ramp", 1e-4, duration=3600.0)), apart=True))
    ramp = Hypothesis(rough.best.hypothesis.frame, effect("setpoint_ramp"), "controller")
    (found,) = by_race(settled(rough), rough, [ramp])
    assert found.values["rate"] == pytest.approx(1e-4, rel=0.05)

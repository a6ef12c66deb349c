"""Straight lines that a historian draws, and those that rounding draws."""

import pytest
from stickslip.gap.diagnosis import held_against
from stickslip.gap.effects import effect
from stickslip.gap.fits.digits import straightened
from stickslip.gap.likelihood.digits import by_digits
from stickslip.gap.likelihood.framing import when_switched
from stickslip.gap.likelihood.search import model_alone
from stickslip.gap.likelihood.verdict import Verdict
from stickslip.logs import Log

from benchmarks.foreign.record import record
from benchmarks.foreign_models.cone import model as cone
from benchmarks.foreign_models.pipeline_pack import model as pipeline
from benchmarks.foreign_models.sqrt_tank import model
from benchmarks.foreign_models.two_by_two import model as pair
from benchmarks.gap.plant import MODELS, PlantRun


def test_lines_that_rounding_draws_are_no_historian():
    # a play makes p_1 move in ramps: 68 % of its triples are straight, 61 % of those of the model, by rounding alone
    log = PlantRun("separator_section", "deadband", "VPCS1", seed=3001).made()
    assert straightened(held_against(MODELS["separator_section"][0](), log), 0) == ""


def held_by(plant, wired, **settings):
    """A record of another hand against its model."""
    made = record(plant, **settings)
    log = Log(made.signals["time"], {s: by * made.signals[tag] for s, (by, tag) in wired.signals.items()})
    return held_against(wired.diagram, log)


def test_where_noise_is_less_than_stated_rounding_draws_the_lines():
    # noise of half the stated one: each was a compression at .95 where nothing is
    held = held_by("sqrt_tank", model(), seed=537079806, noise_factor=0.5613, load_factor=0.8888)
    assert straightened(held, 0) == "", "its lines meet in no corners; by their number it was one"
    held = held_by("pipeline_pack", pipeline(), seed=101, noise_factor=0.5, load_factor=0.5)
    assert straightened(held, 0) == "PV"
    assert straightened(held, 0, [{"sensor.sd": 0.015, "feed.sd": 0.3}]) == ""


@pytest.mark.parametrize(("plant", "wired", "effect_name", "size", "seed", "noise", "load"), [
    ("two_by_two", pair, "dead_time", 0.7066, 1874811447, 0.5655, 0.501),
    ("cone", cone, "controller_integral_time", -1.2136, 643354578, 0.5664, 0.5915),  # lines of 1.5 roundings of the log
])  # fmt: skip
def test_where_an_effect_hides_that_noise_is_less_rounding_draws_the_lines_too(
    plant, wired, effect_name, size, seed, noise, load
):
    # effects in loops whose noise and loads are half as large as stated: each was a compression at .95
    found = {"effect": effect_name, "size": size, "seed": seed, "noise_factor": noise, "load_factor": load}
    null = model_alone(when_switched(held_by(plant, wired(), **found)))
    gap = Verdict(100.0, "", 0.0, 4.0)
    assert by_digits(null, gap, [effect("compression")], 0) is None

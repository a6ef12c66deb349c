"""Straight lines that a historian draws, and those that rounding draws."""

from stickslip.gap.diagnosis import held_against
from stickslip.gap.fits.digits import straightened

from benchmarks.gap.plant import MODELS, PlantRun


def test_lines_that_rounding_draws_are_no_historian():
    # a play makes p_1 move in ramps: 68 % of its triples are straight, 61 % of those of the model, by rounding alone
    log = PlantRun("separator_section", "deadband", "VPCS1", seed=3001).made()
    assert straightened(held_against(MODELS["separator_section"][0](), log), 0) == ""

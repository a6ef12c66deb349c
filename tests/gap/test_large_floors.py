"""Floors of large diagrams: made by runs with the record's own set points, so that no record is odd by these."""

import pytest
from stickslip.gap.diagnosis import held_against
from stickslip.gap.likelihood.left import judged_by_loss
from stickslip.gap.likelihood.search import model_alone

from benchmarks.gap.plant import MODELS, PlantRun

SECTION = MODELS["separator_section"][0]


@pytest.mark.parametrize("seed", [1051, 1060, 2053])
def test_a_record_without_a_gap_is_as_likely_as_runs_of_the_model(seed):
    # a standard deviation of the loss of runs is the unit; losses in the fitted noise were 2 to 4 above the mean
    size = judged_by_loss(model_alone(held_against(SECTION(), PlantRun("separator_section", seed=seed).made()))).size
    assert abs(size) < 2.0

"""Floors of large diagrams: made by runs with the record's own set points, so that no record is odd by these."""

import numpy as np
import pytest
from stickslip.gap.diagnosis import held_against
from stickslip.gap.likelihood.left import judged_by_loss
from stickslip.gap.likelihood.search import model_alone
from stickslip.logs import Log

from benchmarks.gap.plant import MODELS, PlantRun

SECTION = MODELS["separator_section"][0]


def size(log):
    """Return by how many standard deviations of the loss of runs a record leaves more than they do."""
    return judged_by_loss(model_alone(held_against(SECTION(), log))).size


@pytest.mark.parametrize("seed", [1051, 1060, 2053])
def test_a_record_without_a_gap_is_as_likely_as_runs_of_the_model(seed):
    # losses in the fitted noise were 2 to 4 above the mean
    assert abs(size(PlantRun("separator_section", seed=seed).made())) < 2.0


def test_rows_that_the_log_lacks_are_lacking_in_the_runs():
    # with whole runs it was 40 below their mean, so that a gap of that size did not show
    log = PlantRun("separator_section", seed=2052).made()
    good = ~((np.arange(len(log)) >= 600) & (np.arange(len(log)) < 1000))
    holed = Log(log.t, {s: log[s] for s in log.names}, quality={s: good for s in log.names if not s.startswith("SP")})
    assert abs(size(holed)) < 4.0

"""Floors of large diagrams: kept for the next record, their score placed by runs with that record's set points."""

import numpy as np
import pytest
import stickslip.gap.linearised.filtered as filtered
import stickslip.gap.linearised.usual as usual
from stickslip.gap.diagnosis import held_against
from stickslip.gap.floors.floor import Floor, scored
from stickslip.gap.likelihood.left import judged_by_loss, left
from stickslip.gap.likelihood.search import model_alone
from stickslip.gap.linearised.usual import _placed

from benchmarks.gap.plant import MODELS, PlantRun

SECTION = MODELS["separator_section"][0]


@pytest.fixture
def counted(monkeypatch, tmp_path):
    """Return how many runs each call made, with a cache of its own."""
    monkeypatch.setenv("STICKSLIP_CACHE", str(tmp_path))
    made = []
    for where in (usual, filtered):
        whole = where.without_gap
        monkeypatch.setattr(
            where, "without_gap", lambda m, r, n, seed, whole=whole: (made.append(n), whole(m, r, n, seed))[1]
        )
    return made


def test_the_second_record_of_a_model_makes_no_floor(counted):
    first = model_alone(held_against(SECTION(), PlantRun("separator_section", seed=1051).made()))
    assert counted == [40, 12] and not judged_by_loss(first).unusual
    # at 5068 this one lies 20 of the floor's deviations above the first; its own runs lie there, too
    second = model_alone(held_against(SECTION(), PlantRun("separator_section", seed=1060).made()))
    assert counted == [40, 12, 12] and left(second.best) > 1.15 * left(first.best)
    np.testing.assert_array_equal(first.hypothesis.frame.floor.A, second.hypothesis.frame.floor.A)
    assert abs(judged_by_loss(second).size) < 3.5


def test_a_much_shorter_record_has_a_floor_of_its_own(counted):
    held_against(SECTION(), PlantRun("separator_section", seed=1052).made(hours=0.25))
    held_against(SECTION(), PlantRun("separator_section", seed=1053).made())
    assert counted == [40, 12, 40, 12]


@pytest.mark.parametrize(("spread", "share"), [(0.2, 1.0), (3.0, 1.0), (0.2, 0.7)])
def test_a_floor_is_placed_by_a_records_own_runs(spread, share):
    # expected: the mean of their scores, and its own spread times sqrt(1 + 1/12), analytic, or theirs if that is wider
    rng = np.random.default_rng(0)
    shape = Floor(np.zeros(2, bool), np.zeros((0, 2, 2)), np.eye(2), 20, 500.0 + rng.normal(size=40), 100)
    found = rng.normal(size=(12, 420, 2)) * (1.0 + spread * rng.uniform(size=(12, 1, 1)))
    found[:, rng.uniform(size=420) > share] = np.nan  # rows in which nothing was logged
    placed = _placed(shape, found)
    known = np.isfinite(found[0, 20:]).mean()
    own = scored(found[:, 20:]) / known
    assert placed.rows == 400 and placed.mean * placed.rows == pytest.approx(own.mean())
    floor = shape.scores.std(ddof=1) * 2.0  # of four times the rows
    assert placed.scores.std(ddof=1) == pytest.approx(max(floor, own.std(ddof=1)) * np.sqrt(13.0 / 12.0))

"""The figures of both stages: counted apart where the calibrated answer leaves a record open."""

import json
import math

import pytest

from benchmarks.detect import posterior
from benchmarks.detect.posterior import NOTES, Own, Pair, pairs, summed_up


def pair(sticky, p, unsure):
    return Pair(sticky, 5.0, 3.0, None, (p, 5.0, 3.0), unsure)


def test_the_unsure_are_counted_apart():
    found = summed_up(
        [pair(True, 0.9, False), pair(False, 0.1, False), pair(True, 0.4, True), pair(False, 0.6, True)], loops=10
    )
    assert found["unsure_records"] == 2 and found["unsure_model_auc"] == 0.0 and found["unsure_model_right"] == 0.0
    assert found["model_auc"] == 0.75  # analytic: three of the four pairs of a sticky and another loop stand in order
    assert set(found) == set(NOTES)
    # analytic: both unsure records have the wrong side at 0.4; simulation says nothing, which counts as 0.5
    assert found["unsure_model_log_loss"] == pytest.approx(-math.log(0.4))
    assert found["unsure_simulate_log_loss"] == pytest.approx(math.log(2.0))
    odds = math.sqrt(0.4 / 0.6)  # half the log odds
    assert found["unsure_together_log_loss"] == pytest.approx(-math.log(odds / (1.0 + odds)))


def test_one_side_alone_has_no_area():
    found = summed_up([pair(True, 0.4, True), pair(False, 0.2, False)], 10)
    assert found["unsure_model_auc"] is None and found["unsure_simulate_right"] == 0.0


def test_a_record_that_was_asked_is_not_asked_again(tmp_path, monkeypatch):
    """One real record, read from the file the second time, and equal."""
    (one,) = pairs(1, 60, seed=5, folder=tmp_path)
    assert one.own is None or isinstance(one.own, Own)
    monkeypatch.setattr(posterior, "_row", None)
    assert pairs(1, 60, seed=5, folder=tmp_path) == [one]
    (line,) = next(tmp_path.glob("posterior_5_*.jsonl")).read_text().splitlines()
    assert json.loads(line)["sticky"] == one.sticky

"""An accusation of which the model is not sure stands only where simulation bears it out; nothing else is changed."""

from dataclasses import replace

import pytest

from calibration import at_record, draw, second_look, simulate
from detect import diagnose
from detect.judge.model import calibrated


@pytest.fixture(scope="module")
def looked():
    """Return the diagnosis of a sticky loop, set so as if the model were not sure, and what simulation says of it."""
    spec = next(one for one in draw(40, 71_900) if one.cause == "stiction" and one.group == "cycling")
    ((record, _),) = simulate([spec], 1)
    found = diagnose(record)
    return replace(found, verdict="stiction", probability=0.8), at_record(record, loops=120, workers=1)


@pytest.mark.parametrize(("simulated", "word"), [(0.2, "inconclusive"), (0.9, "stiction")])
def test_an_accusation_stands_where_both_together_reach_the_limit(looked, simulated, word):
    # analytic: the mean log odds of 80 % and 20 % are those of 50 %, of 80 % and 90 % those of 86 %; the limit is 74 %
    assert 0.5 < calibrated().accuse < 0.86
    accused, found = looked
    told = second_look(accused, replace(found, probability=simulated))
    assert told.verdict == word
    assert (told.amount is None) is (word == "inconclusive" or accused.amount is None)
    if word == "inconclusive":
        assert "80 %" in told.reason and "20 %" in told.reason and "50 %" in told.reason
        assert told.causes == accused.causes and told.action == accused.action


@pytest.mark.parametrize(("verdict", "p"), [("stiction", 0.95), ("stiction", None), ("inconclusive", 0.8)])
def test_no_other_verdict_is_changed(looked, verdict, p):
    accused, found = looked
    given = replace(accused, verdict=verdict, probability=p)
    assert second_look(given, replace(found, probability=0.01)) is given

"""A pair of which one effect is not there is one effect, with the sizes that the pair has found."""

import pytest
from stickslip.cases.models import ideal_flow
from stickslip.gap.diagnosis import prepared
from stickslip.gap.effects import effect
from stickslip.gap.explanations.candidates import candidates
from stickslip.gap.explanations.joint import apart, improved
from stickslip.gap.explanations.one_of_pair import enough_alone
from stickslip.gap.explanations.pair import Pair
from stickslip.gap.fits.search import best_of
from stickslip.gap.fits.together import marked, together

S, J, WRONG = 4.0, 1.5, 4.4  # what is there, and an S that a search had ended at
STEM = ("stiction", "valve", {"S": S, "J": J})


def made(log, factor):
    """The problem, single fits with wrong sizes, and a pair of the right stem and a gain of the controller."""
    problem = prepared(ideal_flow(), log)
    legal = candidates(problem, problem.quiet, [effect("stiction"), effect("controller_gain")])
    stem = next(one for one in legal if one.effect.hidden)
    gain = next(one for one in legal if not one.effect.hidden)
    singles = [best_of(stem.tried([{"S": WRONG, "J": J}])), best_of(gain.tried([{"factor": 1.1}]))]
    both = together(stem, gain)
    pair = apart(problem, best_of(both.tried([{**marked({"S": S, "J": J}, "1."), **marked({"factor": factor}, "2.")}])))
    return problem, singles, pair


def test_an_effect_that_is_not_there_is_left_out(with_effects):
    problem, singles, pair = made(with_effects(5, STEM), 1.0001)
    first, *others = enough_alone(problem, pair, singles)
    assert first.effect.name == "stiction" and first.values["S"] == pytest.approx(S)
    assert first.total < singles[0].total and [fit.effect.name for fit in others] == ["controller_gain"]


def test_an_effect_that_is_there_stays(with_effects):
    problem, singles, pair = made(with_effects(5, STEM, ("controller_gain", "controller", {"factor": 1.2})), 1.2)
    assert enough_alone(problem, pair, singles) is None


def test_a_pair_of_a_model_with_tolerances_is_taken_apart(with_effects):
    model = ideal_flow().with_tolerances({"process.K": 0.05})
    problem = prepared(model, with_effects(5, STEM))
    legal = candidates(problem, problem.quiet, [effect("sensor_lag"), effect("controller_gain")])
    lag, gain = (next(one for one in legal if one.effect.name == name) for name in ("sensor_lag", "controller_gain"))
    single = best_of(lag.tried([{"tau": 1.0, "process.K": 3.05}])), best_of(gain.tried([{"factor": 1.1}]))
    pair = improved(problem, Pair(*single))
    assert pair.first.values["process.K"] == pair.second.values["process.K"]
    assert set(pair.second.values) == {"factor", "process.K"}

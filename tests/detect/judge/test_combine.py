"""Rules of the vote, by property: they hold for any verdicts, weights and margins."""

import types

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from stickslip.detect import Verdict, Weight, WeightedVote, diagnose
from stickslip.logs import LoopRecord

ORDER = {"no_stiction": 0, "inconclusive": 1, "stiction": 2}
WORDS = ("stiction", "no_stiction", "inconclusive", "not_applicable")


def vote(word, name="m"):
    code = "no_oscillation" if word == "not_applicable" else None
    return Verdict(name, word, None if code else 1.0, 1.0, "Seen so.", code=code)


votes = st.lists(st.builds(vote, st.sampled_from(WORDS), st.sampled_from("abcd")), max_size=25)
weight = st.builds(Weight, st.floats(0.01, 10), st.floats(0.01, 10))
rules = st.builds(WeightedVote, st.dictionaries(st.sampled_from("abcd"), weight), st.floats(1.01, 10))


@pytest.mark.parametrize("many, one", [("stiction", "no_stiction"), ("no_stiction", "stiction")])
def test_nineteen_against_one_decide(many, one):
    assert WeightedVote()([vote(many)] * 19 + [vote(one)]) == many


@pytest.mark.parametrize("accusing, acquitting", [(1, 1), (2, 1), (1, 2), (10, 10), (12, 8), (8, 12)])
def test_a_contradiction_of_comparable_weight_stays_open(accusing, acquitting):
    assert WeightedVote()([vote("stiction")] * accusing + [vote("no_stiction")] * acquitting) == "inconclusive"


@given(rules, votes, st.randoms())
def test_the_order_of_the_methods_does_not_matter(rule, said, random):
    mixed = list(said)
    random.shuffle(mixed)
    assert rule(mixed) == rule(said)


@given(rules, votes, st.sampled_from("abcd"))
def test_one_more_vote_never_moves_the_answer_the_other_way(rule, said, name):
    before = rule(said)
    with_accusation, with_acquittal = (rule([*said, vote(word, name)]) for word in ("stiction", "no_stiction"))
    if before == "not_applicable":
        assert (with_accusation, with_acquittal) == ("stiction", "no_stiction")
    else:
        assert ORDER[with_acquittal] <= ORDER[before] <= ORDER[with_accusation]


@given(rules, votes, st.integers(0, 30), st.integers(0, 30))
def test_abstentions_count_nothing(rule, said, unsure, refused):
    more = [vote("inconclusive")] * unsure + [vote("not_applicable")] * refused
    if any(v.applicable for v in said):
        assert rule([*said, *more]) == rule(said)
    else:
        assert rule([*said, *more]) == ("inconclusive" if unsure else "not_applicable")


@given(votes, st.floats(1.01, 10))
def test_accusation_and_acquittal_are_treated_alike(said, margin):
    turned = {"stiction": "no_stiction", "no_stiction": "stiction"}
    mirrored = [vote(turned.get(v.verdict, v.verdict), v.method) for v in said]
    answer = WeightedVote(margin=margin)(said)
    assert WeightedVote(margin=margin)(mirrored) == turned.get(answer, answer)


def test_weights_are_data():
    said = [vote("stiction", "loud"), vote("no_stiction", "sure")]
    assert WeightedVote({"loud": Weight(accuse=0.2)})(said) == "no_stiction"
    assert WeightedVote({"loud": Weight(acquit=0.0)})(said) == "inconclusive"  # its other side is not asked
    assert WeightedVote({"loud": Weight(accuse=0.0)})(said[:1]) == "inconclusive"  # no weight: it looked, no more


@pytest.mark.parametrize("bad", [-1.0, float("nan"), float("inf")])
def test_bad_weights_are_refused(bad):
    with pytest.raises(ValueError, match="finite number, 0 or more"):
        Weight(accuse=bad)


def test_a_margin_of_one_is_refused():
    with pytest.raises(ValueError, match=r"margin = 1\.0; give more than 1"):
        WeightedVote(margin=1.0)


def test_diagnose_takes_the_rule():
    t = np.arange(500.0)
    record = LoopRecord.from_arrays(t, pv=np.sin(t / 8), op=50 + np.cos(t / 8), sp=0 * t)
    said = [vote("stiction", "a")] * 19 + [vote("no_stiction", "b")]
    asked = [types.SimpleNamespace(detect=lambda record, v=v: v) for v in said]
    assert diagnose(record, asked, WeightedVote()).verdict == "stiction"
    assert "B disagrees and is outweighed: Seen so." in diagnose(record, asked, WeightedVote()).reason
    assert diagnose(record, asked, combine=lambda said: "inconclusive").verdict == "inconclusive"
    with pytest.raises(ValueError, match="combine gave 'maybe'"):
        diagnose(record, asked, combine=lambda said: "maybe")

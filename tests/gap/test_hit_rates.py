"""Stated probabilities: what effects outside every catalogue make of them."""

import pytest
from stickslip.gap.answers.evidence import Evidence
from stickslip.gap.answers.hit_rates import BENCHMARK, MISTAKEN, OUTSIDE, PRIOR, RECALLED, HitRates

KINDS = sorted(BENCHMARK)


@pytest.mark.parametrize("kind", sorted(MISTAKEN))
def test_a_name_is_less_sure_by_the_share_of_unknown_effects_that_get_it(kind):
    # of 1 + b answers, b go to effects outside; b = 0 would leave the share among the catalogue's (Bayes)
    right, of = BENCHMARK[kind]
    assert HitRates().probability(Evidence(kind, 100.0)) == pytest.approx(
        (right + 0.5) / (of + 1.0) / (1.0 + MISTAKEN[kind])
    )
    many = HitRates({kind: (10**6, 10**6)}, 10**6)
    assert many.probability(Evidence(kind, 100.0)) == pytest.approx(1.0 / (1.0 + MISTAKEN[kind]), rel=1e-4)


def test_runs_of_a_catalogues_effects_do_not_make_unknown_improbable():
    # 90 runs, 6 of them wrongly unknown: of 30 effects outside, R are called so, rightly (Bayes)
    right, of = BENCHMARK["unknown"]
    outside = RECALLED * 90 * OUTSIDE / (1.0 - OUTSIDE)
    prior = (right + 0.5) / (of + 1.0)
    expected = (outside + PRIOR * prior) / (6 + outside + PRIOR)
    assert HitRates({"unknown": (0, 6)}, 90).probability(Evidence("unknown", 100.0)) == pytest.approx(expected)
    assert expected > 0.7


@pytest.mark.parametrize("kind", KINDS)
def test_no_answer_is_certain(kind):
    assert 0.0 < HitRates().probability(Evidence(kind, 100.0)) < 1.0

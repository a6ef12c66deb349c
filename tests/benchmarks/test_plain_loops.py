"""Loops of plain recursions: stems by their laws, loops that are the same each time, and figures by hand."""

from types import SimpleNamespace

import numpy as np
import pytest

from benchmarks.plain_loops import _stem, figures, plain_loop


@pytest.mark.parametrize("law", ["slips", "steps", "creeps"])
def test_a_stem_holds_within_its_band_and_moves_beyond_it(law):
    S, J = 4.0, 1.0
    stem, x = _stem(law, S, J, 0.5), 50.0
    for u in (51.5, 48.5, 51.9):  # analytic: within S / 2 of where it stands none of them moves
        x = stem(u, x)
    assert x == 50.0
    assert stem(56.0, x) > 51.0


def test_slips_to_half_of_what_is_left_of_S_beside_OP():
    S, J = 4.0, 1.0
    assert _stem("slips", S, J, 0.5)(52.6, 50.0) == pytest.approx(52.6 - 0.5 * (S - J))  # analytic
    assert _stem("steps", S, J, 0.5)(54.1, 50.0) == pytest.approx(54.1 - 0.5 * (S - J))  # analytic


def test_a_seed_gives_the_same_loop_and_even_ones_stick():
    for seed in (95_000, 95_001):
        one, again = plain_loop(seed), plain_loop(seed)
        assert (one.S > 0.0) == (seed % 2 == 0)
        for name in ("pv", "op", "sp"):
            assert np.array_equal(getattr(one.record, name), getattr(again.record, name))
        assert np.ptp(one.record.op) > 0.0


def test_figures_are_those_of_four_verdicts():
    def said(verdict, p, S=None, limit=None):
        amount = None if S is None else {"S": SimpleNamespace(value=S)}
        return SimpleNamespace(verdict=verdict, probability=p, amount=amount, detection_limit=limit)

    def loop(S, load="sine"):
        return SimpleNamespace(S=S, load=load)

    found = figures([
        (loop(2.0), said("stiction", 0.9, S=3.0)), (loop(1.0), said("no_stiction", 0.05, limit=(0.5, "% of OP"))),
        (loop(0.0, "triangle"), said("stiction", 0.8)), (loop(0.0), said("inconclusive", None)),
    ])  # fmt: skip
    assert found == {
        "auc": 0.5, "found": 0.5, "called": 0.5, "accused": 0.5, "accused_triangle": 1.0, "cleared": 0.5,
        "S_error": 0.5,
    }  # analytic  # fmt: skip

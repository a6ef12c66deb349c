"""What an explanation may leave of a gap, however large the gap is."""

import math
from dataclasses import replace

import pytest
from stickslip.gap.likelihood.judge import Verdict, chance, enough


@pytest.mark.parametrize(
    ("left", "alone", "is_enough"),
    [(4.0, 10.0, True), (6.0, 10.0, False), (20.0, 2000.0, True), (848.0, 60000.0, False), (26.0, 60000.0, False)],
)
def test_little_of_a_large_gap_may_be_left_but_no_more_than_25_standard_deviations(left, alone, is_enough):
    verdict, model = (Verdict(size, "size of OP", 0.5, 5.0) for size in (left, alone))
    assert enough(None, verdict, model) is is_enough


def test_a_record_that_leaves_far_less_than_runs_is_sure_to_be_exceeded():
    """Where runs leave the track in every run the exponential of the deviate had no number: an OverflowError."""
    assert chance(-1e5) == 1.0
    assert chance(1e5) < 1e-300


def test_a_fit_whose_own_runs_fail_is_not_enough():
    alone = Verdict(85.0, "size of PV", 0.0, 6.6)
    assert not enough(None, Verdict(20.0, "PV", 1.0, math.inf), alone)
    assert enough(None, Verdict(20.0, "PV", 1.0, math.inf), replace(alone, limit=math.inf))  # of neither a run is known

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from stickslip.detect.half_waves.half_cycles import HalfCycle
from stickslip.detect.half_waves.lateness import closed_form, lag_of, lateness


def half(peak, before, after):
    return HalfCycle(0.0, 1.0, 2.0, peak, before, after, 20, 0.0, 0.0)


def test_pv_is_below_sp_where_e_is_positive():
    """e = SP - PV: the late half cycles have e > 0."""
    late = lateness([half(1.0, 3.0, 1.0), half(-1.0, 1.0, 1.0)] * 5, 100, 0, 0.9)
    assert late.sides["below"] == (3.0, 5)  # analytic
    assert late.sides["above"] == (1.0, 5)  # analytic
    pooled = late.R
    assert pooled == pytest.approx(2.0)  # analytic: areas are pooled, 20 / 10
    assert late.low < 2.0 < late.high


def test_a_side_without_half_cycles_is_left_out():
    assert set(lateness([half(-1.0, 3.0, 1.0)] * 5, 100, 0, 0.9).sides) == {"above"}


@settings(max_examples=50, deadline=None)
@given(tau=st.floats(2.6, 400.0))
def test_the_lag_of_a_ratio_inverts_the_closed_form(tau):
    assert lag_of(closed_form(25.0 / tau), 25.0) == pytest.approx(tau, rel=0.06)  # two digits


def test_ratios_that_no_lag_gives_are_held_at_the_ends():
    assert (lag_of(0.9, 25.0), lag_of(1e6, 25.0)) == (500.0, 2.5)  # rule: 20 and a tenth of the half period


def test_resampling_is_repeatable():
    some = [half(sign, before, 1.0) for sign, before in zip([1, -1] * 10, np.linspace(1, 3, 20), strict=True)]
    assert lateness(some, 200, 5, 0.9) == lateness(some, 200, 5, 0.9)

"""What a log says of itself: the lattice of its values, straight lines, scans."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from stickslip.gap.fits.scans import read_off
from stickslip.gap.fits.straightness import sloping
from stickslip.gap.records.record import Record, rounding
from stickslip.logs import Log


@given(st.sampled_from([1e-6, 1e-3, 0.0015, 0.02, 0.25, 5.0]), st.integers(0, 1000))
def test_the_rounding_of_a_log_is_read_off_it(step, seed):
    values = np.round(np.random.default_rng(seed).normal(0.5, 200.0 * step, 400) / step) * step
    assert rounding(values) == pytest.approx(step, rel=1e-6)  # analytic


def test_values_that_are_not_rounded_have_no_lattice():
    assert rounding(np.random.default_rng(0).normal(size=400)) == 0.0
    assert rounding([1.0, 1.0]) == 0.0


def test_noise_has_no_straight_lines_and_an_interpolated_archive_has():
    noise = np.random.default_rng(0).normal(size=2000).round(6)
    assert sloping(noise, 1e-6) < 0.01
    drawn = np.interp(np.arange(2000.0), np.arange(0.0, 2000.0, 5.0), noise[::5])
    assert sloping(drawn, 1e-6) == pytest.approx(0.8, abs=0.02)  # analytic: 4 of 5 triples lie within a line


@given(st.integers(2, 9), st.integers(0, 8))
def test_the_scan_of_a_controller_is_read_off_its_output(period, first):
    t = np.arange(600.0)
    scans = np.floor((t - first) / period)
    (P, at), *_ = read_off(t, np.sin(scans))
    assert (P, at) == (period, first % period)  # analytic


def test_an_output_that_is_always_new_shows_no_scan():
    assert read_off(np.arange(50.0), np.random.default_rng(0).normal(size=50)) == []


def test_a_ramp_is_read_at_the_scans_whatever_the_rows_lie_at():
    # analytic: rows at 0.4, 2.4, ... on the line u = t, read each 0.75 s from 0 on
    t = 0.4 + 2.0 * np.arange(6)
    source = Record(Log(t, {"SP": t}), ("SP",), (), ramps={"SP": 0.75}).source("SP")
    for at in (2.5, 3.7, 6.1):
        assert source.output(at, [], [])[0] == pytest.approx(0.75 * np.floor(at / 0.75), abs=1e-9)

"""A wave that keeps time and one that does not: two laws with known answers, and what methods make of them."""

import numpy as np
import pytest
from stickslip.detect.health.conditions import drawn_op
from stickslip.detect.methods import cross_correlation, curve_fit, hammerstein, relay_fit
from stickslip.detect.oscillation.clock import CYCLES_MIN, RATIO_MAX, Clock, clock_of
from stickslip.detect.prepare.prepared import Prepared
from stickslip.logs import LoopRecord

from tests.detect.conftest import _outside_square, _sticky

OWN = (cross_correlation, curve_fit, hammerstein, relay_fit)
by_method = pytest.mark.parametrize("method", OWN, ids=lambda method: method.CARD.name)


def wave_of(crossings):
    """A sine that crosses zero at these times, one sample a second."""
    t = np.arange(crossings[0] + 1, crossings[-1])
    return t, np.sin(np.pi * np.interp(t, crossings, np.arange(len(crossings))))


def mean_ratio(cycles, diffuses, draws=60):
    r = np.random.default_rng(7)
    found = []
    for _ in range(draws):
        shifts = 1.5 * r.normal(size=2 * cycles)
        crossings = 40.0 * np.arange(2 * cycles) + (np.cumsum(shifts) if diffuses else shifts)
        found.append(clock_of(*wave_of(crossings)).ratio)
    return float(np.mean(found))


@pytest.mark.parametrize("cycles", [20, 60])
def test_a_clock_has_one_half(cycles):
    # analytic: the variance of a difference of two independent errors is twice that of one
    assert mean_ratio(cycles, diffuses=False) == pytest.approx(0.5, abs=0.05)


@pytest.mark.parametrize("cycles", [30, 60])
def test_a_random_walk_has_n_over_15(cycles):
    # analytic: a random walk less its straight line has a variance of n / 15 steps
    assert mean_ratio(cycles, diffuses=True) == pytest.approx(cycles / 15.0, rel=0.25)


def test_unit_sign_and_start_of_time_do_not_matter():
    t, x = wave_of(40.0 * np.arange(60) + np.random.default_rng(1).normal(size=60))
    first = clock_of(t, x)
    assert clock_of(60.0 * t + 1e4, 25.0 * x).ratio == pytest.approx(first.ratio, rel=1e-6)
    assert clock_of(t, -x).ratio == pytest.approx(first.ratio, rel=0.25)  # other crossings, the same law


def test_short_and_exactly_repeating_waves_say_nothing():
    t = np.arange(3000.0)
    exact = clock_of(t, np.sin(2 * np.pi * t / 50))  # fifty samples a cycle: every one the same
    assert np.isnan(exact.ratio) and not exact.keeps_time
    assert not Clock(0.3, CYCLES_MIN - 1).keeps_time and Clock(RATIO_MAX - 0.01, CYCLES_MIN).keeps_time


@by_method
def test_what_keeps_time_is_refused_by_name(method):
    record = next(r for r in map(_outside_square, range(20)) if Prepared(r).clock.keeps_time)
    v = method.detect(record)
    assert v.code in {"outside_wave", "wrong_process_type"}, v.reason
    if v.code == "outside_wave":
        assert "keeps time as a clock" in v.reason and "cycles" in v.reason


@by_method
@pytest.mark.parametrize("noise", [0.02, 0.1])
def test_a_cycle_of_the_valve_is_not(method, noise):
    assert method.detect(_sticky(noise=noise, n=6000)).code != "outside_wave"


def test_op_that_a_historian_has_drawn_is_refused_where_its_shape_is_read():
    """A round wave of OP, stored as straight lines, has triangles in it that no valve made."""
    r, t = np.random.default_rng(2), np.arange(3000.0)
    phase = np.cumsum(1 + 0.2 * r.normal(size=3000)) * 2 * np.pi / 60
    op = 50 + 3 * np.cos(phase)
    kept = np.append(np.arange(0, 2999, 15), 2999)
    drawn = np.interp(t, t[kept], op[kept])
    records = [
        LoopRecord.from_arrays(
            t, pv=30 + np.sin(phase) + 0.02 * r.normal(size=3000), op=x, sp=0 * t + 30, process="self_regulating"
        )
        for x in (op, drawn)
    ]
    assert [drawn_op(record).present for record in records] == [False, True]
    assert curve_fit.detect(records[0]).code != "compressed" == curve_fit.detect(records[1]).code
    assert "OP samples lie on straight lines" in curve_fit.detect(records[1]).reason


def test_op_held_between_scans_is_not_drawn():
    t = np.arange(2000.0)
    held = (50 + 3 * np.cos(t / 9))[(t // 5 * 5).astype(int)]
    assert not drawn_op(LoopRecord.from_arrays(t, pv=np.sin(t / 9), op=held)).present

"""The compiled sums of the screening against the same formulas written with whole arrays (labelled analytic)."""

import itertools
import sys

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from stickslip.detect.half_waves.cycles import Params
from stickslip.detect.half_waves.half_cycles import in_pieces
from stickslip.detect.health.conditions import on_grid
from stickslip.detect.oscillation import acf_crossings
from stickslip.detect.oscillation.acf_crossings import significant_crossings
from stickslip.detect.oscillation.acf_kernels import beat, centred, correlated, levelled, short_beat
from stickslip.detect.prepare.prepared import Prepared
from stickslip.detect.signals.crossings import crossings
from stickslip.detect.signals.gaps import split, taken
from stickslip.detect.signals.kernels import spread
from stickslip.detect.signals.order import median_step, percentile, percentiles
from stickslip.detect.signals.runs import runs, stands
from stickslip.detect.signals.smoothing import moving_average, noise_std
from stickslip.logs import LoopRecord

from tests.detect.one_by_one import measure

numbers = st.lists(st.floats(-1e3, 1e3), min_size=2, max_size=60).map(np.array)
coarse = st.lists(st.integers(0, 2), min_size=2, max_size=200).map(lambda x: np.array(x, dtype=float))


def crossings_by_arrays(acf, band, most=None):
    """Thornhill's crossings within Bartlett's band, lobe by lobe, as the module's docstring says them."""
    n = len(acf)
    k = np.flatnonzero((acf[:-1] > 0) != (acf[1:] > 0))
    if len(k) == 0:
        return np.empty(0)
    where, bounds = k + acf[k] / (acf[k] - acf[k + 1]), np.append(k, n - 1)
    variance = (1 + 2 * np.sum(acf[1 : k[0] + 1] ** 2)) / n
    kept = 0
    for i in range(len(k) if most is None else min(most, len(k))):
        lobe = np.abs(acf[bounds[i] + 1 : bounds[i + 1] + 1])
        lag = bounds[i] + 1 + int(np.argmax(lobe))
        if lobe.max() < band * np.sqrt(variance * (1 - lag / n)):
            break
        kept = i + 1
    return where[:kept]


@given(st.integers(0, 10_000), st.integers(20, 900), st.floats(4.0, 200.0), st.sampled_from([None, 1, 5, 11]))
@settings(max_examples=150, deadline=None)
def test_crossings_are_those_of_the_formula(seed, n, period, most):
    rng = np.random.default_rng(seed)
    y = np.sin(2 * np.pi * np.arange(n) / period) + rng.uniform(0, 3) * rng.normal(size=n)
    acf = np.correlate(y - y.mean(), y - y.mean(), "full")[n - 1 :]
    acf /= acf[0]
    expected = crossings_by_arrays(acf, 1.96, most)  # analytic
    assert significant_crossings(acf, 1.96, most) == pytest.approx(expected, rel=1e-12)
    assert significant_crossings(7.0 * acf, 1.96, most) == pytest.approx(expected, rel=1e-12)  # any scale


@given(st.integers(0, 10_000), st.integers(20, 500), st.floats(4.0, 100.0))
@settings(max_examples=60, deadline=None)
def test_a_beat_is_that_of_the_crossings(seed, n, period):
    rng = np.random.default_rng(seed)
    y = np.sin(2 * np.pi * np.arange(n) / period) + rng.uniform(0, 2) * rng.normal(size=n)
    acf = np.correlate(y - y.mean(), y - y.mean(), "full")[n - 1 :]
    found = crossings_by_arrays(acf / acf[0], 1.96, 11)
    gaps = np.diff(found)
    expected = (
        (gaps.mean(), gaps.std(ddof=1) if len(gaps) > 1 else 0.0, gaps.min(), gaps.max()) if len(gaps) else [0] * 4
    )
    count, *rest = beat(acf, 1.96, 11)
    assert count == len(found) and rest == pytest.approx(expected, rel=1e-9, abs=1e-9)  # analytic
    std, *again = short_beat(y, 1.96, 11)
    assert std == pytest.approx(np.std(y), rel=1e-12) and again == pytest.approx([count, *rest], rel=1e-6, abs=1e-6)


def readied(t, x, period, p):
    """The control error of one piece less its mean or drift, smoothed, as the module of ``cycles`` says it."""
    e, std, drifts = x - x.mean(), np.std(x), False
    if t[-1] - t[0] > 4 * period:
        baseline = moving_average(t, x, 2 * period, ends="hold")
        if np.std(baseline) > p.drift_share * np.std(x - baseline):
            e, std, drifts = x - baseline, np.std(x - baseline), True
    sigma = noise_std(t, e)
    sigma = 0.0 if sigma < 1e-3 * std else sigma
    dt = np.median(np.diff(t))
    width = min(dt * (sigma / (p.noise_share * std)) ** 2, p.smooth_max * period) if sigma > p.noise_share * std else 0
    if width > 2 * dt:
        e, sigma = moving_average(t, e, width), sigma * np.sqrt(dt / width)
    cuts = crossings(t, e, 0.1 * std)
    if len(cuts) >= 3 and not drifts:
        whole = (t >= cuts[0]) & (t <= (cuts[-1] if len(cuts) % 2 else cuts[-2]))
        e = e - np.trapezoid(e[whole], t[whole]) / np.ptp(t[whole])
    return e, sigma, drifts


@given(st.integers(0, 10_000), st.floats(0.0, 0.4), st.booleans(), st.booleans())
@settings(max_examples=40, deadline=None)
def test_pieces_at_once_are_the_pieces_one_by_one(seed, noise, drifting, uneven):
    """Analytic: the steps of the preparation written with whole arrays, and ``measure`` of each half cycle."""
    r, p = np.random.default_rng(seed), Params()
    lengths, periods = r.integers(30, 400, 4), r.uniform(15, 60, 4)
    bounds = np.concatenate([[0], np.cumsum(lengths)])
    t = np.cumsum(r.uniform(0.5, 1.5, bounds[-1])) if uneven else np.arange(float(bounds[-1]))
    x = np.concatenate([np.tanh(2 * np.sin(2 * np.pi * t[a:b] / P)) + r.normal()
                        for (a, b), P in zip(itertools.pairwise(bounds), periods, strict=True)])  # fmt: skip
    x += noise * r.normal(size=len(t)) + 0.01 * drifting * t
    found, e, drifts = in_pieces(t, x, bounds, periods, p.smooth_max, p.noise_share, p.drift_share)
    expected, came_off = [], False
    for (a, b), period in zip(itertools.pairwise(bounds), periods, strict=True):
        made, left, drift = readied(t[a:b], x[a:b], period, p)
        came_off |= drift
        assert e[a:b] == pytest.approx(made, abs=1e-9)
        firm = crossings(t[a:b], made, max(0.1 * np.std(made), min(3 * left, 0.5 * np.std(made))))
        expected += [measure(t[a:b], made, *pair, left)[:9] for pair in itertools.pairwise(firm)]
    assert drifts == came_off and len(found) == len(expected)
    for half, one in zip(found, expected, strict=True):
        assert half[:9] == pytest.approx(one, rel=1e-6, abs=1e-7)


def test_twenty_pieces_are_not_looked_at_by_calls_of_their_own_for_every_sum():
    """Calls from Python are most of what a record under set-point moves costs; there were 4,300."""
    t = np.arange(7200.0)
    e = np.tanh(2 * np.sin(2 * np.pi * t / 70)) + 0.05 * np.random.default_rng(1).normal(size=7200)
    sp = np.repeat(np.random.default_rng(2).normal(size=20), 360)

    def calls():
        made = Prepared(LoopRecord.from_arrays(t, pv=sp - e, op=50 + np.cos(t / 11), sp=sp, process="self_regulating"))
        _, count = made.facts, 0

        def counted(frame, event, arg):
            nonlocal count
            count += event in ("call", "c_call")

        sys.setprofile(counted)
        try:
            found = made.cycles
        finally:
            sys.setprofile(None)
        assert len(made.pieces.all) == 19 and len(found.half_cycles) > 100
        return count

    calls()  # loads what is compiled
    assert calls() < 2000


def test_short_and_long_signals_have_one_autocorrelation(monkeypatch):
    y = np.random.default_rng(1).normal(size=500).cumsum()
    found = np.empty(500)
    centre = np.empty(500)
    assert centred(y, centre) == pytest.approx(np.std(y), rel=1e-12)
    correlated(centre, found)
    assert found == pytest.approx(np.correlate(y - y.mean(), y - y.mean(), "full")[499:], rel=1e-9, abs=1e-9)
    t = np.arange(1000.0)
    wave = np.sin(t / 9) + 0.1 * np.cos(t * 1.7)
    gates = []
    for limit in (0, 2000):  # by spectra, lag by lag
        monkeypatch.setattr(acf_crossings, "_SHORT", limit)
        gates.append(acf_crossings.find_in(t, wave))
    assert gates[0].period == pytest.approx(gates[1].period, rel=1e-9)
    assert gates[0].regularity == pytest.approx(gates[1].regularity, rel=1e-6)


@pytest.mark.parametrize("n", [3, 512, 513, 7200, 14_401, 99_991])
def test_quick_lengths_are_long_enough_and_products_of_small_primes(n):
    length = acf_crossings._quick_length(n)
    assert n <= length <= max(2, 1.13 * n) + 8
    for prime in (2, 3, 5):
        while length % prime == 0:
            length //= prime
    assert length == 1


def test_levelled_is_interpolated_and_without_its_straight_line():
    t = np.cumsum(np.random.default_rng(2).uniform(0.2, 2.0, 300))
    x = np.sin(t / 7) + 0.3 * t - 5
    grid, y = np.empty(300), np.empty(300)
    sd, largest = levelled(t, x, grid, y)
    even = np.linspace(t[0], t[-1], 300)
    on_even = np.interp(even, t, x)
    expected = on_even - np.polynomial.Polynomial.fit(even, on_even, 1)(even)  # analytic
    assert grid == pytest.approx(even, rel=1e-14) and y == pytest.approx(expected, abs=1e-9)
    assert sd == pytest.approx(np.std(expected), rel=1e-9) and largest == np.max(np.abs(x))


@given(numbers)
@settings(max_examples=80, deadline=None)
def test_spread_is_that_of_numpy(x):
    mean, sd = spread(x)
    assert mean == pytest.approx(np.mean(x), abs=1e-9) and sd == pytest.approx(np.std(x), abs=1e-9)


def test_what_stands_has_a_spread_of_exactly_nothing():
    assert spread(np.full(37, 5.3)) == (5.3, 0.0)  # numpy.std gives 2e-15, which would count as a movement


@given(numbers, st.floats(0, 100), st.floats(0, 100))
@settings(max_examples=100, deadline=None)
def test_percentiles_are_those_of_numpy(x, one, two):
    assert percentiles(x, one, two) == pytest.approx(np.percentile(x, [one, two]).tolist(), abs=1e-9)
    assert percentile(x, one) == pytest.approx(np.percentile(x, one), abs=1e-9)


@given(st.lists(st.sampled_from([0.5, 1.0, 3.0]), min_size=1, max_size=50))
@settings(max_examples=50, deadline=None)
def test_median_step(steps):
    assert median_step(np.cumsum([0.0, *steps])) == pytest.approx(np.median(steps), abs=1e-12)


@given(coarse, coarse)
@settings(max_examples=80, deadline=None)
def test_stands_and_repeats_are_those_counted_by_hand(x, y):
    n = min(len(x), len(y))
    x, y = x[:n], y[:n]
    edges = [0, *(np.flatnonzero(np.diff(x)) + 1).tolist(), n]
    first, length = stands(x)
    assert list(zip(first, first + length, strict=True)) == list(itertools.pairwise(edges))
    both = (x[1:] == x[:-1]) & (y[1:] == y[:-1])
    start, end = runs(both)
    assert len(start) == np.count_nonzero(both & ~np.append(False, both[:-1])) and (end - start).sum() == both.sum()


@pytest.mark.parametrize("off, expected", [(0.0, True), (0.09, True), (0.11, False), (1.0, False)])
def test_a_grid_is_a_grid_while_nine_of_ten_lie_on_it(off, expected):
    rng = np.random.default_rng(4)
    x = 0.25 * rng.integers(0, 40, 1000).astype(float)
    x[1 : 1 + round(off * 999)] += 0.1
    assert on_grid(x, 0.25) is expected


def test_noise_on_an_even_clock_is_that_on_one_that_is_hardly_uneven():
    rng = np.random.default_rng(5)
    t = np.arange(3000.0)
    x = np.sin(t / 20) + 0.1 * rng.normal(size=3000)
    uneven = t + 1e-7 * rng.uniform(-1, 1, 3000)
    assert noise_std(uneven, x) == pytest.approx(noise_std(t, x), rel=1e-5)


def test_an_even_record_is_its_own_grid():
    rng = np.random.default_rng(6)
    t, pv, op = np.arange(2000.0), rng.normal(size=2000), rng.normal(size=2000)
    exact = Prepared(LoopRecord.from_arrays(t, pv=pv, op=op, sp=0 * t)).whole
    shifted = t.copy()
    shifted[1:-1] += 1e-9  # off the grid by less than what counts as late
    other = Prepared(LoopRecord.from_arrays(shifted, pv=pv, op=op, sp=0 * t)).whole
    assert (exact.pv == pv).all() and (exact.op == op).all() and (other.op == op).all()
    assert other.pv == pytest.approx(exact.pv, abs=1e-7) and exact.drawn == other.drawn == 0.0


def test_what_is_taken_is_what_was_split():
    pv = np.arange(40.0)
    pv[[7, 8, 20]] = np.nan
    record = LoopRecord.from_arrays(np.arange(40.0), pv=pv, op=np.ones(40))
    for bridged in (1.5, 2.5, 10.0):
        for part in split(record, bridged):
            assert record.pv[taken(part)].tolist() == record.pv[part].tolist()


@pytest.mark.parametrize("cycles", [3.6, 4.5, 5.8, 7.0, 9.0])
@pytest.mark.parametrize("change", [1.0, 1.15, 1.6])
def test_halves_too_short_for_a_period_of_their_own_are_not_asked(cycles, change):
    """The answer is that of asking them: a half of fewer than 3.5 cycles cannot pass (analytic)."""
    t = np.arange(700.0)
    period = 700.0 / cycles
    phase = np.cumsum(np.where(t < 350, 1 / period, change / period))
    x = np.sin(2 * np.pi * phase)
    p = acf_crossings.Params()
    gate = acf_crossings.find_in(t, x, p)
    halves = tuple(acf_crossings._find_one(t[a:b], x[a:b], p) for a, b in ((0, 350), (350, 700)))
    whole = acf_crossings._find_one(t, x, p)
    drifts = acf_crossings._drifts(halves, p)
    assert (len(gate.stretches) > 1) == (whole.oscillating and drifts) or not whole.oscillating

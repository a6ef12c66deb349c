"""Blank and bad cells: short gaps leave the verdict as it is, others are named with place and length."""

from dataclasses import replace

import numpy as np
import pytest
from stickslip.detect.half_waves import cycles
from stickslip.detect.methods.area_ratio import closed_form, detect
from stickslip.detect.oscillation import acf_crossings as oscillation
from stickslip.detect.prepare.prepared import Prepared
from stickslip.detect.signals.gaps import Gap, bridgeable, describe, gaps_in, split

T = np.arange(3000.0)
HOLES = np.arange(75, 3000, 150)


def limit_cycle(wave, loop, period=100.0):
    return loop(T, wave("exponential", T, period, tau=period * 8 / 50))


def blank(record):
    return record.log.with_signals(PV=np.where(np.isin(T, HOLES), np.nan, record.pv))


def marked_bad(record):
    """Bad cells often hold a number, such as zero."""
    bad = np.isin(T, HOLES)
    log = record.log.with_signals(PV=np.where(bad, 0.0, record.pv))
    return replace(log, quality={"PV": ~bad})


def no_set_point(record):
    return record.log.with_signals(SP=np.where(np.isin(T, HOLES), np.nan, record.sp))


def two_in_a_row(record):
    return record.log.with_signals(OP=np.where(np.isin(T, [*HOLES, *HOLES + 1]), np.nan, record.op))


@pytest.mark.parametrize("damage", [blank, marked_bad, no_set_point, two_in_a_row])
def test_one_bad_cell_in_150_changes_nothing(wave, loop, damage):
    whole = limit_cycle(wave, loop)
    v = detect(replace(whole, log=damage(whole)))
    assert v.verdict == "stiction"
    assert v.index == pytest.approx(closed_form(25 / 8), rel=0.03)  # analytic
    assert "20 gaps" in v.reason and "bridged" in v.reason


@pytest.mark.parametrize("seed", range(10))
def test_scattered_bad_cells_change_nothing(wave, loop, seed):
    """One cell in fifty is bad, anywhere: hardly ten cycles in a row are whole."""
    rng = np.random.default_rng(seed)
    t, bad = np.arange(2000.0), rng.random(2000) < 0.02
    clean = loop(t, wave("exponential", t, 50.15, rng.uniform()) + 0.05 * rng.normal(size=2000))
    holed = replace(clean, log=clean.log.with_signals(PV=np.where(bad, np.nan, clean.pv)))
    before, after = detect(clean), detect(holed)
    assert after.verdict == before.verdict == "stiction"
    assert after.index == pytest.approx(before.index, rel=0.15)


def test_missing_rows_are_gaps_too(wave, loop):
    t = T[(T % 300 < 290) | (T < 300)]
    record = loop(t, wave("exponential", t, 200.0, tau=32.0))
    assert [gap.length for gap in gaps_in(record)] == [11.0] * 8  # 290 to 299 are missing
    assert detect(record).verdict == "stiction"


@pytest.mark.parametrize("lost, bridged", [(9, True), (12, False)])
def test_a_tenth_of_a_period_is_bridged(wave, loop, lost, bridged):
    """Rule: 9 lost samples make a gap of 10 s, a tenth of the period of 100 s; 12 make one of 13 s."""
    e = wave("sine", T, 100.0)
    e[1480 : 1480 + lost] = np.nan
    found = cycles.cut(loop(T, e))
    (note,) = [note for note in found.notes if "gap" in note]
    assert f"1 gap ({lost + 1} s at 1479 s)" in note
    assert ("bridged" in note) is bridged
    assert ("2 pieces" in note) is not bridged


def test_a_straight_line_over_a_tenth_of_a_period_misses_a_sine_by_5_percent():
    """Analytic: the sagitta of the chord across the peak, 1 - cos(pi / 10)."""
    t = np.linspace(-0.05, 0.05, 1001)
    chord = np.cos(2 * np.pi * 0.05)
    assert np.max(np.cos(2 * np.pi * t) - chord) == pytest.approx(1 - np.cos(np.pi / 10))
    assert 1 - np.cos(np.pi / 10) < 0.05


def test_a_peak_in_a_gap_is_not_used(wave, loop):
    """The sine of period 100 peaks at 1025; a gap from 1021 to 1029 takes that peak away."""
    e = np.where((T > 1021) & (T < 1029), np.nan, wave("sine", T, 100.0))
    found = cycles.cut(loop(T, e))
    faulty = [half for half in found.half_cycles if half.fault]
    assert [half.fault for half in faulty] == ["gap"]
    assert faulty[0].start == pytest.approx(1000, abs=1.0)  # analytic


def test_long_gaps_are_named_with_place_and_length(wave, loop):
    e = wave("exponential", T, 50.15)
    e[1000:1210] = np.nan
    e[2000:2040] = np.nan
    reason = detect(loop(T, e)).reason
    assert "2 gaps (211 s at 999 s, 41 s at 1999 s) cut the record into 3 pieces" in reason


def test_a_refusal_names_them_too(loop):
    e = np.random.default_rng(0).normal(size=3000)
    e[1000:1210] = np.nan
    v = detect(loop(T, e))
    assert v.code == "no_oscillation"
    assert "211 s at 999 s" in v.reason


def test_moves_of_the_set_point_are_told_from_gaps(wave):
    from stickslip.logs import LoopRecord

    e, sp = wave("sine", T), np.where(T < 1500, 30.0, 35.0)
    found = cycles.cut(LoopRecord.from_arrays(T, pv=sp - e, op=50 + 0.1 * np.cumsum(e), sp=sp))
    assert any("1 move of the set point cut the record into 2 pieces" in note for note in found.notes)


def test_a_whole_record_has_no_gap(wave, loop):
    record = limit_cycle(wave, loop)
    assert gaps_in(record) == ()
    assert not [note for note in cycles.cut(record).notes if "gap" in note]
    assert oscillation.find(record).oscillating


def test_a_period_is_sought_for_the_grid_only_where_there_is_a_gap(wave, loop):
    whole = Prepared(limit_cycle(wave, loop))
    assert len(whole.whole) == len(T) and "pieces" not in vars(whole)
    e = wave("exponential", T, 100.0, tau=16.0)
    e[[500, 501, 502, 1800, 1801, 1802]] = np.nan
    holed = Prepared(loop(T, e))  # four steps are a twenty-fifth of a period: bridged, though not without a period
    assert len(split(holed.record, bridgeable(holed.record, 0.0))) == 3
    assert len(holed.whole) == len(T) and "pieces" in vars(holed)


def test_uneven_sampling_is_no_gap(wave, loop):
    t = np.cumsum(np.random.default_rng(0).uniform(0.2, 1.8, 2000))
    assert gaps_in(loop(t, wave("sine", t))) == ()


def test_no_good_sample_at_all(loop):
    assert split(loop(T, np.full(3000, np.nan)), 10.0) == []


def test_at_least_single_samples_are_bridged(wave, loop):
    assert bridgeable(loop(T, wave("sine", T)), 5.0) == 2.5  # rule: one missing sample leaves two steps


def test_only_the_longest_are_named():
    words = describe([Gap(10.0 * i, 10.0 * i + length) for i, length in enumerate((2.0, 5.0, 3.0, 4.0, 1.0))])
    assert words == "5 gaps (5 s at 10 s, 4 s at 30 s, 3 s at 20 s, 2 shorter)"

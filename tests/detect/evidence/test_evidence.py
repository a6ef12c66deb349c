"""Stem, spectrum, correlation and windows of a loop: what is read is what the loop was made with."""

from datetime import datetime

import numpy as np
import pytest
from stickslip.detect import diagnose
from stickslip.detect.evidence import correlation, over_time, spectrum, stem_trend
from stickslip.detect.figures.evidence import plot_correlation, plot_over_time, plot_pv_op, plot_spectrum, plot_stem_op
from stickslip.detect.figures.loop_trend import plot_cycles, plot_trend
from stickslip.detect.judge.answer import Amount
from stickslip.detect.judge.confirming import confirming_rows as plan_of
from stickslip.detect.methods import play_fit, stem_play
from stickslip.detect.prepare.prepared import Prepared
from stickslip.logs import Log, LoopRecord


@pytest.fixture
def seen(sticky):
    """A sticky flow loop with its stem logged."""
    return sticky(S=6.0, J=4.0, noise=0.02, n=3000)


def without_stem(record):
    return LoopRecord.from_arrays(record.t, pv=record.pv, op=record.op, sp=record.sp, name=record.name)


def test_the_reconstructed_stem_moves_when_the_true_one_does(seen):
    found = stem_trend([play_fit.detect(without_stem(seen))])
    true = np.interp(found.t, seen.t, seen.mv)
    assert not found.logged and found.better > 1.5
    assert np.corrcoef(found.mv, true)[0, 1] > 0.85  # but for what a lag may hide
    still = np.abs(np.diff(seen.mv)) < 1e-9
    assert found.share == pytest.approx(np.mean(still), abs=0.15)
    assert np.all(np.diff(found.sticks, axis=1) > 0.0) and len(found.slips) == len(found.sticks)


def test_a_logged_stem_is_shown_as_it_is(seen):
    found = stem_trend([stem_play.detect(seen), play_fit.detect(seen)])
    assert found.logged and np.all(np.isin(np.round(found.mv, 6), np.round(seen.mv, 6)))


def test_no_stem_where_a_play_tells_nothing():
    rng = np.random.default_rng(2)
    t = np.arange(1500.0)
    op = 50.0 + np.cumsum(rng.normal(size=1500)) * 0.3
    said = stem_trend([play_fit.detect(LoopRecord.from_arrays(t, pv=rng.normal(size=1500), op=op, sp=0 * t))])
    assert isinstance(said, str) and said.startswith("No stem")
    assert "did not run" in stem_trend([])


@pytest.mark.parametrize(("shape", "third"), [("sine", 0.0), ("triangle", 1.0 / 9.0)])
def test_harmonics_of_known_waves(shape, third):
    t = np.arange(6000.0)
    wave = np.sin(2 * np.pi * t / 60.0) if shape == "sine" else 2.0 * np.abs(2.0 * (t / 60.0 % 1.0) - 1.0) - 1.0
    found = spectrum(Prepared(LoopRecord.from_arrays(t, pv=wave, op=50 + wave, sp=0 * t)))
    assert found.fundamental == pytest.approx(1.0 / 60.0, rel=0.02)
    assert found.of_pv[3] == pytest.approx(third, abs=0.01)  # analytic: Fourier series
    assert found.of_pv[2] == pytest.approx(0.0, abs=0.01)


def test_the_lag_of_two_waves():
    t = np.arange(5000.0)
    op, pv = 50 + np.sin(2 * np.pi * t / 100.0), np.sin(2 * np.pi * (t - 25.0) / 100.0)
    found = correlation(Prepared(LoopRecord.from_arrays(t, pv=pv, op=op, sp=0 * t)))
    assert found.lag == pytest.approx(25.0, abs=1.0)  # analytic: a quarter of the period
    assert found.at_lag == pytest.approx(1.0, abs=0.02) and found.at_zero == pytest.approx(0.0, abs=0.03)
    assert found.op[100] == pytest.approx(1.0, abs=0.02) and found.op[50] == pytest.approx(-1.0, abs=0.02)


def waves(start=None, days=3.0, every=60.0):
    t = np.arange(0.0, days * 86400.0, every)
    pv = 60 + np.sin(t / 400) + 0.01 * np.random.default_rng(1).normal(size=len(t))
    log = Log(t=t, signals={"PV": pv, "OP": 50 + np.cos(t / 400), "SP": 60 + 0 * t}, start=start)
    return log.loop(name="TIC9")


def test_windows_are_days_of_the_clock():
    found = over_time(waves(datetime(2024, 5, 6, 18, 0)))
    starts = [(found.record.log.start.hour * 3600 + w.start) % 86400.0 for w in found.windows]
    assert starts[0] == 18 * 3600.0 and starts[1:] == [0.0] * 3
    assert sum(w.samples for w in found.windows) == len(found.record)
    assert found.divided == "Windows of a day, by the clock."


def test_many_days_are_joined_to_few_windows():
    found = over_time(waves(datetime(2024, 5, 6, 18, 0), days=40.0, every=600.0))
    assert len(found.windows) <= 12 and "4 days" in found.divided


def test_a_short_record_is_divided_or_says_why_not(seen):
    parts = over_time(without_stem(seen))
    assert 2 <= len(parts.windows) <= 6 and "equal parts" in parts.divided
    short = over_time(waves(days=0.1))
    assert short.windows == () and "too short" in short.divided and short.words == ""


def test_a_valve_that_gets_worse_is_seen_to():
    from dataclasses import replace

    found = over_time(waves())

    def sized(sizes):
        return tuple(
            replace(w, verdict="stiction", S=Amount(s, 0.9 * s, 1.1 * s, "% of OP"))
            for w, s in zip(found.windows * (len(sizes) // len(found.windows)), sizes, strict=True)
        )

    worse = replace(found, windows=sized([4.0, 4.2, 4.4, 5.5, 6.0, 6.2]))
    assert "S goes from 4.2 to 6 % of OP, a trend that a constant valve shows in 0.3%" in worse.words  # 2 / 6!
    same = replace(found, windows=sized([4.0, 4.2, 4.1, 4.2, 4.0, 4.1]))
    assert "no trend" in same.words
    short = replace(found, windows=sized([4.0, 5.0, 6.0]))  # analytic: this order has a chance of 2 / 3! in any valve
    assert "tested from 6" in short.words and "has changed" not in short.words


def test_the_confirming_test_brackets_S():
    rows = plan_of(Amount(4.0, 3.0, 5.0, "% of OP"))
    assert [row[1] for row in rows] == ["+8 %"] + ["-1 %"] * 6
    assert [row[3] for row in rows[1:]] == ["stands"] * 2 + ["stands or jumps"] * 3 + ["has jumped"]


def test_every_picture_is_drawn(seen):
    record = without_stem(seen)
    answer, loop = diagnose(record), Prepared(record)
    stem = stem_trend(answer.methods)
    assert not isinstance(stem, str)
    for figure in (
        plot_trend(record, stem), plot_cycles(record, loop.period, stem), plot_cycles(record, float("nan"), None),
        plot_pv_op(record, loop.period, stem), plot_stem_op(record, loop.period, stem),
        plot_spectrum(spectrum(loop)), plot_correlation(correlation(loop)), plot_over_time(over_time(record)),
    ):  # fmt: skip
        figure.canvas.draw()
    assert any("stem stands" in label for label in plot_trend(record, stem).axes[1].get_legend_handles_labels()[1])


def test_a_logged_stem_is_shown_though_no_method_judged_it(seen):
    found = stem_trend([play_fit.detect(seen)], seen)
    assert found.logged and np.array_equal(found.mv, seen.mv[seen.good])
    still = np.abs(np.diff(seen.mv)) < 1e-9
    assert found.share == pytest.approx(np.mean(still), abs=0.1)


def test_a_stem_at_rest_sticks_nowhere():
    t = np.arange(600.0)
    ripple = 0.2238 + 1e-14 * np.sin(t / 9.0)
    still = LoopRecord.from_arrays(t, pv=ripple, op=ripple, mv=0.2238 + 0.0 * t)
    found = stem_trend([], still)
    assert found.logged and len(found.sticks) == 0


def test_over_a_loop_at_rest_axes_are_wide_and_plain():
    t = np.arange(600.0)
    ripple = 0.2238 + 1e-14 * np.sin(t / 9.0)
    still = LoopRecord.from_arrays(t, pv=ripple, op=ripple)
    (ax,) = plot_pv_op(still, float("nan"), None).axes
    ax.figure.canvas.draw()
    for axis, limits in ((ax.xaxis, ax.get_xlim()), (ax.yaxis, ax.get_ylim())):
        assert np.ptp(limits) == pytest.approx(0.02238) and axis.get_offset_text().get_text() == ""


def test_a_start_up_does_not_squeeze_pv_against_op(seen):
    pv = seen.pv.copy()
    pv[:5] = -1000.0
    (ax,) = plot_pv_op(LoopRecord.from_arrays(seen.t, pv=pv, op=seen.op), 60.0, None).axes
    low, high = ax.get_ylim()
    assert low < seen.pv.min() and high > seen.pv.max() and high - low < 2.0 * np.ptp(seen.pv)


def test_sizes_over_time_are_whole_on_the_axis(seen):
    from dataclasses import replace

    found = over_time(seen)
    assert all(w.probability is None for w in found.windows), "the logged stem answers"
    (ax,) = plot_over_time(found).axes  # no empty panel of probabilities
    assert ax.get_ylim()[1] > 1.1 * max(w.S.high for w in found.windows)
    none = replace(found, windows=tuple(replace(w, S=None, probability=0.2) for w in found.windows))
    assert [panel.get_ylabel() for panel in plot_over_time(none).axes] == ["probability\nof stiction"]


def test_a_set_point_that_swings_is_what_pv_follows():
    from stickslip.detect.evidence import set_point_words

    t = np.arange(1800.0)
    wave = 2.0 * np.pi * t / 60.0
    pv, op = 50.0 + 0.5 * np.sin(wave - 0.8), 50.0 + np.sin(wave)
    swings = LoopRecord.from_arrays(t, pv=pv, op=op, sp=50.0 + np.sin(wave))
    # analytic: 0.8 rad of a minute are 7.6 s
    assert "PV follows 7.6 s later, 0.5 times as far" in set_point_words(swings, 60.0)
    assert set_point_words(LoopRecord.from_arrays(t, pv=pv, op=op, sp=0.0 * t + 50.0), 60.0) == ""
    stepped = LoopRecord.from_arrays(t, pv=pv, op=op, sp=np.where(t > 900.0, 51.0, 50.0))
    assert set_point_words(stepped, 60.0) == "" and set_point_words(swings, float("nan")) == ""

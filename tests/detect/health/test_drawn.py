"""A noise-free log is not taken for a compressed one, and a compressed one is still refused."""

import numpy as np
import pytest
from stickslip.cases import find
from stickslip.detect.health.conditions import compressed, drawn_op
from stickslip.detect.health.drawn import controlled_as_logged, drawn, free_of_noise
from stickslip.detect.oscillation.clock import clock_of
from stickslip.detect.prepare.prepared import Prepared
from stickslip.logs import LoopRecord
from stickslip.logs.dirt import swinging_door

CASES = ("ideal_high", "ideal_half_gain", "ideal_integrating")


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("deviation", [0.002, 0.01])
@pytest.mark.parametrize("signals", [("PV",), ("PV", "OP")])
def test_a_noise_free_log_that_is_compressed_is_still_refused(case, deviation, signals):
    record = find(case).loop()
    assert not compressed(record).present and not drawn_op(record).present
    door = swinging_door(record.log, {name: deviation * float(np.ptp(record.log[name])) for name in signals})
    assert compressed(door.loop()).present
    if "OP" in signals:
        assert drawn_op(door.loop()).present


@pytest.mark.parametrize("every", [2, 3, 10])
def test_lines_between_common_knots_are_seen_though_both_signals_have_them(every):
    """Analytic: between knots dOP and de are constant and e is not, so that no integral part fits."""
    record = find("ideal_integrating").loop()
    t, kept = record.t, np.arange(0, len(record), 10)
    t, pv, op = t[kept], record.pv[kept] + 0.01 * np.sin(t[kept] / 7.0), record.op[kept]
    e = -pv
    op = 0.2 * e + np.concatenate([[0.0], np.cumsum(0.5 * (e[1:] + e[:-1]) * 0.2 / 400.0)])
    raw = LoopRecord.from_arrays(t, pv=pv, op=op, sp=0.0 * t)
    lines = LoopRecord.from_arrays(
        t, pv=np.interp(t, t[::every], pv[::every]), op=np.interp(t, t[::every], op[::every]), sp=0.0 * t
    )
    assert controlled_as_logged(raw) and not controlled_as_logged(lines)


def test_a_proportional_controller_shows_nothing():
    t = np.arange(1000.0)
    pv = np.interp(t, t[::9], np.sin(t[::9] / 20.0))
    assert not controlled_as_logged(LoopRecord.from_arrays(t, pv=pv, op=50 - 3 * pv, sp=0 * t))


@pytest.mark.parametrize("digits", [np.float64, np.float32])
def test_rounding_leaves_lines_lines_and_curves_curves(digits):
    t = np.arange(4000.0)
    wave = np.sin(2 * np.pi * t / 4000.0)  # analytic: bends of 2.5e-6 at most, half of the swing's 1e-6
    assert drawn(t, wave).mean() < 0.05
    lines = np.interp(t, t[::50], wave[::50]).astype(digits).astype(float)
    assert drawn(t, lines).mean() > 0.85


def test_held_samples_are_drawn():
    t = np.arange(1000.0)
    assert drawn(t, np.repeat(np.random.default_rng(0).normal(size=100), 10)).mean() == pytest.approx(0.8, abs=0.01)


def test_noise_of_any_size_that_a_transmitter_has_is_noise():
    t, r = np.arange(5000.0), np.random.default_rng(3)
    wave = np.sin(2 * np.pi * t / 100.0)
    assert free_of_noise(t, wave)
    for sd in (1e-3, 1e-2, 0.1):
        assert not free_of_noise(t, wave + sd * r.normal(size=len(t)))
    assert not free_of_noise(t, np.round(wave, 2))
    assert not free_of_noise(t, np.interp(t, t[::7], wave[::7]))


def test_the_clock_says_nothing_of_a_noise_free_limit_cycle():
    """Its phase is shifted by the level's cycle, not by chance."""
    loop = Prepared(find("plant_1_normal").loop("PCS11"))
    assert clock_of(loop.stretch.t, loop.wave("OP")).keeps_time and not loop.clock.keeps_time

import numpy as np
import pytest
from stickslip.detect.half_waves import cycles


def usable(found):
    return [half for half in found.half_cycles if not half.fault]


def test_every_half_cycle_is_found(wave, loop):
    t = np.arange(1000.0)
    found = cycles.cut(loop(t, wave("sine", t, phase=0.1)))
    assert len(usable(found)) == 39  # analytic: 40 crossings in 20 cycles off phase
    assert found.period == pytest.approx(50, rel=0.01)


def test_gap_cuts_no_half_cycle_in_two(wave, loop):
    t = np.concatenate([np.arange(500.0), np.arange(710.0, 1300.0)])
    found = cycles.cut(loop(t, wave("sine", t)))
    assert any("2 pieces" in note for note in found.notes)
    assert all(not (half.start < 499 and half.end > 710) for half in found.half_cycles)
    assert len(usable(found)) > 35


def test_set_point_step_is_cut_out(wave, loop):
    from stickslip.logs import LoopRecord

    t = np.arange(2000.0)
    sp = np.where(t < 1000, 30.0, 35.0)
    e = wave("sine", t)
    found = cycles.cut(LoopRecord.from_arrays(t, pv=sp - e, op=50 + np.cumsum(e) * 0.1, sp=sp))
    assert not [half for half in found.half_cycles if half.start < 999 < half.end]


def test_drift_is_taken_off(wave, loop):
    t = np.arange(2000.0)
    found = cycles.cut(loop(t, wave("sine", t) + 1.5 * np.sin(2 * np.pi * t / 1500)))
    assert any("drift" in note for note in found.notes)
    lengths = [half.length for half in usable(found)][2:-2]
    assert np.mean(lengths) == pytest.approx(25, rel=0.01)  # analytic
    assert np.std(lengths) < 1.0


def test_offset_without_set_point_is_centred(wave):
    from stickslip.logs import LoopRecord

    t = np.arange(1000.0)
    found = cycles.cut(LoopRecord.from_arrays(t, pv=wave("sine", t, phase=0.3) + 400, op=50 + np.sin(t)))
    lengths = np.array([half.length for half in usable(found)])
    assert lengths == pytest.approx(25, rel=0.01)  # analytic: no short and long halves


def test_undersampled_is_refused(wave, loop):
    t = np.arange(0.0, 4000.0, 7.0)
    refusal = cycles.cut(loop(t, wave("sine", t)))
    assert isinstance(refusal, cycles.Refusal)
    assert refusal.code == "undersampled"
    assert "7.1 samples" in refusal.reason  # analytic: 50 s / 7 s

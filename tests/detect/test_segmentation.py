"""Multi-model segmentation: the known moves of a stem are found, and those who follow are not accused."""

import numpy as np
import pytest
from scipy.signal import lfilter
from stickslip.detect.methods import segmentation
from stickslip.detect.methods.segmentation import Params, detect, segment
from stickslip.logs import LoopRecord


def stenman(n=700, d=4.0, noise=0.02, seed=0):
    """A triangle of OP through Stenman's own valve (it moves to OP when OP is d away) and a lag of 3 samples."""
    rng = np.random.default_rng(seed)
    op = 10 * np.abs((np.arange(n) / 50 + 0.3) % 2 - 1) + 45 + 0.02 * rng.normal(size=n)
    x, stem = op[0], []
    for u in op:
        x = u if abs(u - x) > d else x
        stem.append(x)
    a = np.exp(-1 / 3)
    pv = lfilter([0, 1 - a], [1, -a], np.array(stem) - stem[0]) + noise * rng.normal(size=n)
    return op, pv, np.array(stem)


@pytest.mark.parametrize("seed", range(3))
def test_the_moves_of_a_known_stem(seed):
    """Analytic: the path that made the record; every slip is found within two samples, and little else."""
    op, pv, stem = stenman(seed=seed)
    path = segment(op, pv)
    true = np.flatnonzero(np.abs(np.diff(stem)) > 1.0) + 1
    found = np.flatnonzero(np.abs(np.diff(path.stem)) > 1.0) + 1
    late = true[true > 60]  # the process is learnt first
    near = [np.min(np.abs(found - at)) for at in late]
    assert np.mean(np.array(near) <= 2) > 0.9
    assert path.gain > np.log(700) * path.moved.sum()


def test_size_of_the_slips():
    op, pv, _ = stenman()
    t = np.arange(float(len(op)))
    record = LoopRecord.from_arrays(t, pv=pv, op=op, sp=0 * t, process="self_regulating")
    v = detect(record, Params(per_period=1000))  # as it is: the lag is three samples
    assert v.verdict == "stiction", v.reason
    assert 0.5 * 4.0 < v.amount_percent_op < 1.1 * 4.0  # a slip may be read as two: a lower bound


@pytest.mark.parametrize(("S", "J"), [(0.0, 0.0), (2.0, 0.0), (2.0, 2.0)])
def test_an_outside_sine_accuses_nobody(wave, loop, forced, S, J):
    t = np.arange(1500.0)
    for seed in range(3):
        e = wave("sine", t, 60.0) + 0.05 * np.random.default_rng(seed).normal(size=1500)
        assert detect(loop(t, e)).verdict != "stiction"
        assert detect(forced(n=2000, seed=seed, S=S, J=J)).verdict == "inconclusive"


def test_a_valve_that_follows_is_not_cleared():
    rng = np.random.default_rng(0)
    op = 50 + lfilter([1], [1, -0.95], rng.normal(size=800))
    pv = lfilter([0, 0.3], [1, -0.7], op - 50) + 0.01 * rng.normal(size=800)
    t = np.arange(800.0)
    v = detect(LoopRecord.from_arrays(t, pv=pv, op=op, sp=0 * t))
    assert v.verdict == "inconclusive"


def test_offset_scale_sign_and_action(sticky):
    base = sticky(noise=0.02)
    first = detect(base)
    assert first.verdict == "stiction"
    for gain, offset, op_gain in ((-3.0, 40.0, 1.0), (0.1, 0.0, -1.0), (1e3, -7.0, 0.5)):
        pv, op, sp = gain * base.pv + offset, 50 + op_gain * (base.op - 50), gain * base.sp + offset
        v = detect(LoopRecord.from_arrays(base.t, pv=pv, op=op, sp=sp, process="self_regulating"))
        assert v.verdict == "stiction"
        assert v.index == pytest.approx(first.index, abs=0.01)
        assert v.amount_percent_op == pytest.approx(abs(op_gain) * first.amount_percent_op, rel=0.03)


def test_refusals(sticky, loop):
    t = np.arange(150.0)
    assert detect(loop(t, np.sin(t / 8))).code == "too_few_cycles"
    assert detect(sticky("integrating")).code == "wrong_process_type"
    assert Params().rate_high == 0.5


def test_picture(sticky):
    figure = detect(sticky(noise=0.02)).plot()
    figure.canvas.draw()
    assert len(figure.axes) == 2
    assert segmentation.CARD.experimental

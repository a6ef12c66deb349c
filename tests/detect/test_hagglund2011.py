"""Hagglund's shape index: closed forms, the dead band, and the streaming twin."""

import pickle

import numpy as np
import pytest
from stickslip.detect import stream
from stickslip.detect.methods import hagglund2011
from stickslip.detect.methods.hagglund2011 import Params, detect, measure
from stickslip.logs import LoopRecord

from tests.detect.one_by_one import replay


def continuum(shape, m=4000):
    x = (np.arange(m) + 0.5) / m
    return measure(x, shape(x), 0 * x, 0.0, 1.0).shape_index


def exponential(x, h=25 / 8):
    a = np.tanh(h / 2)
    s = x + np.log1p(a) / h
    return np.where(s < 1, 1 - (1 + a) * np.exp(-h * s), -1 + (1 + a) * np.exp(-h * (s - 1)))


def bent(x, apex):
    return np.minimum(x / apex, (1 - x) / (1 - apex))


def test_values_of_the_continuum():
    assert continuum(lambda x: np.sin(np.pi * x)) == pytest.approx(-1.0, abs=1e-5)  # analytic
    assert continuum(np.ones_like) == pytest.approx(1.0, abs=1e-5)  # analytic
    # Analytic: V_sine = 1/3 - 2 / pi + pi^2 / 32 with the integral of triangle times sine 4 / pi^2, V_square = 1/12
    V_sine, V_square = 1 / 3 - 2 / np.pi + np.pi**2 / 32, 1 / 12
    assert continuum(lambda x: bent(x, 0.5)) == pytest.approx((V_sine - V_square) / (V_sine + V_square), abs=1e-3)
    # golden values of the design notes, section 6
    assert continuum(lambda x: bent(x, 0.9)) == pytest.approx(0.067, abs=0.002)
    assert continuum(exponential) == pytest.approx(-0.598, abs=0.002)


def of(shape, n=4000, period=60.0, noise=0.05, gain=1.0, offset=30.0, dt=1.0, op_gain=1.0, seed=1):
    t = dt * np.arange(n / dt)
    u = (t / period + 0.013) % 1
    y = np.where(u < 0.5, 1, -1) * shape(2 * (u % 0.5)) + noise * np.random.default_rng(seed).normal(size=len(t))
    op = 50 + op_gain * np.sin(2 * np.pi * u)
    return LoopRecord.from_arrays(t, pv=gain * y + offset, op=op, sp=0 * t + offset, process="self_regulating")


@pytest.mark.parametrize("noise", [0.02, 0.2])
def test_words(noise):
    assert detect(of(np.ones_like, noise=noise)).verdict == "stiction"
    sine = detect(of(lambda x: np.sin(np.pi * x), noise=noise))
    assert sine.verdict == "inconclusive" and "not cleared" in sine.reason
    assert detect(of(exponential, noise=noise)).verdict == "inconclusive"  # the blind spot the page names


def test_unit_offset_sign_action_and_sampling_do_not_matter():
    base = detect(of(np.ones_like)).index
    for gain, offset, op_gain in ((-3.0, 40.0, -1.0), (0.1, 0.0, 4.0), (1e3, -7.0, 0.02)):
        other = detect(of(np.ones_like, gain=gain, offset=offset, op_gain=op_gain))
        assert other.index == pytest.approx(base, abs=1e-6)
    assert detect(of(np.ones_like, dt=0.5)).index == pytest.approx(base, abs=0.05)


def test_dead_band_of_a_square_error():
    """Analytic: |e| = 2 for T = 100 s: d = K (T / T_i - 1 / (K K_p)) 2 with K = 0.5, T_i = 10 s, K_p = 2 is 9."""
    known = Params(K=0.5, T_i=10.0, K_p=2.0)
    v = detect(of(np.ones_like, period=200.0, gain=2.0, noise=0.0001), known)
    assert v.amount_percent_op == pytest.approx(9.0, rel=0.02)
    reverse = detect(of(np.ones_like, period=200.0, gain=-2.0, noise=0.0001), Params(K=-0.5, T_i=10.0, K_p=-2.0))
    assert reverse.amount_percent_op == pytest.approx(9.0, rel=0.02)
    assert detect(of(np.ones_like, period=200.0, gain=2.0)).amount_percent_op is None
    with pytest.raises(ValueError, match="give all three"):
        Params(K=0.5)
    short = detect(of(np.ones_like, period=90.0, gain=2.0), known)  # half waves of 45 s, below 5 T_i
    assert short.verdict == "stiction" and short.amount_percent_op is None


def test_refusals():
    assert detect(of(np.ones_like, period=12.0)).code == "undersampled"
    assert detect(of(np.ones_like), Params(half_waves_min=1000)).code == "too_few_cycles"
    base = of(np.ones_like)
    no_sp = LoopRecord.from_arrays(base.t, pv=base.pv, op=base.op, process="self_regulating")
    assert detect(no_sp).code == "signal_missing"


# ---- streaming ---------------------------------------------------------------------------------------------


def awkward(seed):
    """Uneven steps, noise, missing samples, a stretch in manual, a move of the set point, a gap."""
    rng = np.random.default_rng(seed)
    t = np.cumsum(rng.uniform(0.5, 1.5, 6000))
    t[3000:] += 700.0
    u = (t / 61.3) % 1
    sp = np.where(np.arange(6000) < 4000, 30.0, 30.01)
    pv = sp - (np.where(u < 0.5, 1, -1) * exponential(2 * (u % 0.5), 9.0) + 0.2 * rng.normal(size=6000))
    pv[rng.random(6000) < 0.02] = np.nan
    mode = np.where((np.arange(6000) > 1500) & (np.arange(6000) < 1600), 0.0, 1.0)
    return LoopRecord.from_arrays(t, pv=pv, op=50 + np.sin(2 * np.pi * u), sp=sp, mode=mode, process="self_regulating")


@pytest.mark.parametrize("seed", range(4))
def test_stream_finds_the_half_waves_of_the_batch(seed):
    record, p = awkward(seed), Params()
    state = replay(hagglund2011, record, p)
    batch, twin = detect(record, p), hagglund2011.verdict(p, state)
    assert sum(half.fault != "" for half in state.half_waves) >= 2  # the gaps and the set-point move
    if batch.applicable:
        assert twin.verdict == batch.verdict and twin.index == pytest.approx(batch.index, rel=1e-9)
        assert twin.array("I") == pytest.approx(batch.array("I"), rel=1e-9)


def test_memory_is_bounded_and_a_long_half_wave_does_not_count():
    p = Params(block=256, half_waves_max=20)
    e = np.concatenate([np.sin(np.arange(3000) / 5), np.full(2000, 1.0), np.sin(np.arange(3000) / 5)])
    t = np.arange(8000.0)
    state = hagglund2011.init(p)
    for time, value in zip(t, e, strict=True):
        state = hagglund2011.update(p, state, float(time), stream.Sample(30 - value, 50 + value, 30.0))
        assert len(state.buffer) <= p.block + 64 and len(state.half_waves) <= 20
    assert len(state.half_waves) == 20
    few = hagglund2011.init(p)
    for time, value in zip(t[:5100], e[:5100], strict=True):
        few = hagglund2011.update(p, few, float(time), stream.Sample(30 - value, 50 + value, 30.0))
    assert [half.fault for half in few.half_waves].count("long") == 1


def test_states_are_values():
    p, t = Params(), np.arange(900.0)
    state, seen = hagglund2011.init(p), []
    for time in t:
        seen.append((state, len(state.buffer)))
        e = float(np.sign(np.sin(time / 9)))
        state = hagglund2011.update(p, state, float(time), stream.Sample(30 - e, 50 + e, 30.0))
    assert all(len(old.buffer) == n for old, n in seen)
    again = pickle.loads(pickle.dumps(state))
    assert hagglund2011.verdict(p, again).to_dict() == hagglund2011.verdict(p, state).to_dict()
    assert hagglund2011.verdict(p, hagglund2011.init(p)).code == "too_few_cycles"


def test_noise_alone_is_no_oscillation():
    """The streaming form has only its own gate."""
    p, rng = Params(), np.random.default_rng(4)
    for smooth in (0.0, 0.9):
        state, x = hagglund2011.init(p), 0.0
        for k in range(3000):
            x = smooth * x + rng.normal()
            state = hagglund2011.update(p, state, float(k), stream.Sample(30 - x, 50 + x, 30.0))
        assert hagglund2011.verdict(p, state).verdict == "not_applicable"


def test_picture():
    figure = detect(of(np.ones_like)).plot()
    figure.canvas.draw()
    assert [line.get_label() for line in figure.axes[0].lines[-2:]] == ["sine", "square"]

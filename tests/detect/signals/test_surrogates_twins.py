"""Linear twins: the same spectrum to rounding; the cut lets a wave repeat without a jump."""

import numpy as np
import pytest
from stickslip.detect.signals.surrogates import end_matched, phase_randomised


@pytest.mark.parametrize("n", [64, 1000])
def test_same_periodogram(n):
    """Analytic: only phases change, so that the periodogram stays to rounding."""
    x = np.cumsum(np.random.default_rng(0).normal(size=n))
    twins = phase_randomised(x, 5, np.random.default_rng(1))
    assert np.abs(np.fft.rfft(twins)) == pytest.approx(np.tile(np.abs(np.fft.rfft(x)), (5, 1)), abs=1e-9 * n)
    assert twins.mean(axis=1) == pytest.approx(np.full(5, x.mean()))
    assert twins.std(axis=1) == pytest.approx(np.full(5, x.std()))


def test_twins_differ_and_repeat_with_their_seed():
    x = np.random.default_rng(0).normal(size=100)
    one, two = (phase_randomised(x, 2, np.random.default_rng(3)) for _ in range(2))
    assert (one == two).all()
    assert not np.allclose(one[0], one[1]) and not np.allclose(one[0], x)


def test_an_odd_length_is_refused():
    with pytest.raises(ValueError, match="even number"):
        phase_randomised(np.arange(7.0), 1, np.random.default_rng(0))


@pytest.mark.parametrize("kind", ["sine", "triangle", "exponential"])
@pytest.mark.parametrize("period", [20.0, 33.3, 47.1])
def test_the_cut_holds_whole_cycles(wave, kind, period):
    x = wave(kind, np.arange(1000.0), period)
    part = end_matched(x, period)
    assert (part.stop - part.start) % 2 == 0
    cycles = (part.stop - part.start) / period
    assert cycles == pytest.approx(round(cycles), abs=1.1 / period + 0.01)
    assert cycles > 1000 / period - 3.1


def test_a_matched_sine_keeps_its_line(wave):
    """The jump of an unmatched sine leaks; twins of a matched one have the amplitude of a sine all along."""
    x = wave("sine", np.arange(1000.0), 48.0, phase=0.1)
    part = end_matched(x, 48.0)
    for twin in phase_randomised(x[part], 10, np.random.default_rng(0)):
        envelope = np.abs(
            np.fft.ifft(np.fft.fft(twin) * np.r_[1, 2 * np.ones(len(twin) // 2 - 1), 1, np.zeros(len(twin) // 2 - 1)])
        )
        assert envelope == pytest.approx(np.ones(len(twin)), abs=0.05)

import numpy as np
import pytest
from stickslip.detect.methods import algorithm1


def test_thesis_sine():
    t = np.arange(0, 600.05, 0.1)
    result = algorithm1.ratios(t, 0.075 * np.sin(2 * np.pi * t / 50))
    assert result.mean == pytest.approx(1.03, abs=0.0051)  # published: Fig. 6.1a, 1.03 +- 0.00
    assert result.mean == pytest.approx(1.025, abs=0.0005)  # analytic: one interval of 0.1 s on the wrong side
    assert result.std < 0.005  # published


def test_the_ratio_of_a_sine_hangs_on_the_sampling_phase():
    t = np.arange(0, 600.05, 0.1)
    phases = 2 * np.pi * np.linspace(0.0, 0.1, 11) / 50  # within one sample
    found = [algorithm1.ratios(t, np.sin(2 * np.pi * t / 50 + phase)).mean for phase in phases]
    # golden values of the notes, section 6: 1.013 to 1.038
    assert 1.013 <= min(found) < 1.018 and 1.033 < max(found) <= 1.038


def test_thesis_sine_by_hand():
    """Analytic: A1 keeps the interval past the peak, and the crossing interval is lost from A2 or A1."""
    t = np.arange(0, 100.05, 0.1)
    y = np.sin(2 * np.pi * t / 50)
    R = algorithm1.ratios(t, y).R
    w = 2 * np.pi / 50
    area = lambda a, b: (np.cos(w * a) - np.cos(w * b)) / w  # noqa: E731
    assert R[1] == pytest.approx(area(0.1, 12.6) / area(12.6, 24.9), abs=0.01)


def test_break_is_read_in_two_ways():
    y = np.array([1.0, -1, 1, -1, 1, 2, 3, 2, 1, -1, -2, -3, -2, -1, 1, 2, 1])
    t = np.arange(float(len(y)))
    assert len(algorithm1.ratios(t, y).R) > 0
    assert len(algorithm1.ratios(t, y, break_means="stop").R) == 0


def test_held_samples_count_on_neither_side():
    t = np.arange(9.0)
    held = np.array([-1.0, 1, 2, 2, 2, 1, 0.5, -1, -2])
    # analytic: slopes look back. A1: (1->2) 1.5 + (2->2) 2.0; A2: (1->0.5) 0.75; the hold (2->2, 2->1) is lost
    assert algorithm1.ratios(t, held).R.tolist() == pytest.approx([3.5 / 0.75])


def test_stream_is_the_batch():
    rng = np.random.default_rng(0)
    t, y = np.cumsum(rng.uniform(0.5, 1.5, 300)), np.cumsum(rng.normal(size=300))
    y -= y.mean()
    state, found = algorithm1.init(), []
    for ti, yi in zip(t, y, strict=True):
        state, R = algorithm1.update(state, float(ti), float(yi))
        if R is not None:
            found.append(R)
    assert found == algorithm1.ratios(t, y).R.tolist()


def test_why_it_is_no_detector(sticky):
    """A clean sine, coarsely sampled, has a higher R than a sticky loop with noise of 5 % of its wave."""
    t = np.arange(2000.0)
    sine = algorithm1.ratios(t, np.sin(2 * np.pi * t / 50)).mean
    loop = sticky(noise=0.1)
    assert sine > 1.25
    assert algorithm1.ratios(loop.t, loop.sp - loop.pv).mean < sine


def test_wrong_calls_are_refused():
    with pytest.raises(ValueError, match="equal length"):
        algorithm1.ratios([0, 1], [1])
    with pytest.raises(ValueError, match="'next' or 'stop'"):
        algorithm1.ratios([0, 1], [1, 2], break_means="leave")  # type: ignore[arg-type]

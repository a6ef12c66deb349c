"""What the margins and the drawing do by their own means is what numpy does with more checks."""

import numpy as np
import pytest
from stickslip.calibration.drawing import _pick
from stickslip.calibration.margins import _unwrapped


@pytest.mark.parametrize("seed", range(20))
def test_phases_are_unwrapped_as_numpy_does(seed: int) -> None:
    phase = np.cumsum(np.random.default_rng(seed).normal(0.0, 0.2 + 0.1 * seed, 400))
    wrapped = np.angle(np.exp(1j * phase))
    np.testing.assert_allclose(_unwrapped(wrapped.copy()), np.unwrap(wrapped), rtol=0.0, atol=1e-12)


def test_a_word_is_picked_as_numpy_would_pick_it() -> None:
    shares = (("a", 0.35), ("b", 0.25), ("c", 0.4))
    one, other = np.random.default_rng(6), np.random.default_rng(6)
    picked = [_pick(one, shares) for _ in range(2000)]
    assert picked == [shares[int(other.choice(3, p=[0.35, 0.25, 0.4]))][0] for _ in range(2000)]
    assert {word: picked.count(word) / 2000 for word in "abc"} == pytest.approx(dict(shares), abs=0.03)

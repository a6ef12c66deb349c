"""Primitives of trends whose shape is known, and the cycles they are read from."""

import itertools

import numpy as np
import pytest
from stickslip.detect.prepare.prepared import Prepared
from stickslip.detect.prepare.whole_cycles import whole_cycles
from stickslip.detect.signals.interval_halving import primitives
from stickslip.logs import LoopRecord

x = np.linspace(0.0, 1.0, 64, endpoint=False)


def letters(y, noise=0.01):
    return "".join(piece.name for piece in primitives(y, noise))


@pytest.mark.parametrize(
    ("y", "word"),  # analytic: signs of slope and bend
    [
        (0 * x + 3, "A"),
        (2 * x, "C"),
        (-x, "F"),
        (x**2, "B"),
        (1 - (1 - x) ** 2, "D"),
        ((1 - x) ** 2, "E"),
        (-(x**2), "G"),
        (np.sin(2 * np.pi * x), "DGEB"),
        (1 - 4 * np.abs(np.mod(x + 0.25, 1) - 0.5), "CFC"),
    ],
)
def test_letters_of_plain_shapes(y, word):
    """Pieces of fewer than nine samples, where two others meet, are left out."""
    found = primitives(y + 0.03 * np.random.default_rng(0).normal(size=64), 0.03)
    assert "".join(piece.name for piece in found if piece.stop - piece.start >= 9) == word


def test_a_square_is_level_but_at_its_jump():
    found = primitives(np.where(x < 0.5, 1.0, -1.0) + 0.01 * np.random.default_rng(0).normal(size=64), 0.01)
    assert sum(piece.stop - piece.start for piece in found if piece.name == "A") >= 58


def test_pieces_cover_the_signal_once():
    y = np.random.default_rng(1).normal(size=157).cumsum()
    pieces = primitives(y, 0.5)
    assert pieces[0].start == 0 and pieces[-1].stop == 157
    assert all(a.stop == b.start and a.name != b.name for a, b in itertools.pairwise(pieces))


def test_noise_is_a_level():
    """Under the null each fit is refused in 5 % of the cases; a level record stays nearly always one piece."""
    rng = np.random.default_rng(3)
    single = sum(letters(rng.normal(size=64), 1.0) == "A" for _ in range(200))
    assert single >= 180


def test_without_noise_there_is_no_limit():
    with pytest.raises(ValueError, match="noise = 0"):
        primitives(x, 0.0)


def test_cycles_start_at_crossings_upwards_and_average_the_noise_away():
    t = np.arange(6000.0)
    wave = np.sin(2 * np.pi * t / 200 + 1.0)
    pv = 30 + 2 * wave + 0.2 * np.random.default_rng(0).normal(size=6000)
    loop = Prepared(LoopRecord.from_arrays(t, pv=pv, op=50 + wave, sp=0 * t + 30))
    found = whole_cycles(loop, "PV", points=50)
    assert np.median(found.end - found.start) == pytest.approx(200.0, rel=0.01)
    expected = 2 * np.sin(2 * np.pi * (np.arange(50) + 0.5) / 50)
    assert found.noise == pytest.approx(0.1, rel=0.1)  # analytic: 0.2 / sqrt(200 / 50)
    assert np.std(found.y - expected) == pytest.approx(0.1, rel=0.25)
    assert len(whole_cycles(loop, "PV", most=7).y) <= 7

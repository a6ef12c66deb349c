"""Bands of a logged stem, read off its figure: those of stems with and without mass, which shares no code with it."""

import numpy as np
import pytest
from stickslip.blocks import QuasiStaticStem, StickSlip
from stickslip.diagram import drive
from stickslip.gap.likelihood.figure import SHARES, bands

ANY = np.linspace(0.0, 1.0, SHARES).tolist()
SPRING = 52500.0  # [N per travel]


def moved(valve, rows=900, seed=1):
    """Return OP that goes up and down with noise, and the stem's position."""
    t = np.arange(float(rows))
    OP = 0.5 + 0.1 * np.sin(t / 40.0) + 0.003 * np.random.default_rng(seed).standard_normal(rows)
    MV = drive(valve, t[-1], every=1.0, OP=(t, OP)).log["MV"]
    return OP[1:], MV[1:].copy()


@pytest.mark.parametrize(("S", "J"), [(0.07, 0.03), (0.03, 0.015), (0.05, 0.01)])
@pytest.mark.parametrize("heavy", [False, True])
def test_bands_are_those_of_the_stem(S, J, heavy):
    force = {"F_s": SPRING * (S + J) / 2.0, "F_c": SPRING * (S - J) / 2.0, "k": SPRING, "start": 0.5}  # thesis 4.4, 4.5
    OP, MV = moved(StickSlip(**force) if heavy else QuasiStaticStem(S, J, start=0.5))
    assert bands(OP, MV, ANY) == pytest.approx((S, J), rel=0.03, abs=3e-4)


def test_rows_that_are_missing_say_nothing():
    OP, MV = moved(QuasiStaticStem(0.05, 0.02, start=0.5))
    MV[200:400] = np.nan
    assert bands(OP, MV, ANY) == pytest.approx((0.05, 0.02), rel=0.05)


def test_a_deadband_has_a_width_and_no_jump():
    OP, MV = moved(QuasiStaticStem(0.06, 0.0, start=0.5))
    assert bands(OP, MV, [1.0]) == pytest.approx((0.06, 0.0), rel=0.01)


def test_a_stem_that_is_where_it_is_wanted_has_no_bands():
    OP = np.linspace(0.0, 1.0, 50)
    assert bands(OP, OP.copy(), ANY) is None
    assert bands(OP, np.full(50, np.nan), ANY) is None

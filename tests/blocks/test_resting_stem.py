"""The stem that sticks anew under a held OP: against the law of He et al., which is another program, and a play."""

import math

import numpy as np
import pytest
from stickslip.blocks import Deadband, HeValve, QuasiStaticStem, Recorded, RestingStem, StickSlip
from stickslip.diagram import simulate, wire

WIDE = {"low": -math.inf, "high": math.inf}


def walk(seed):
    """Return an OP that is new each second, and moves by about the bands below."""
    rng = np.random.default_rng(seed)
    return Recorded("OP", np.arange(300), np.cumsum(rng.normal(0.0, 0.01, 300)) + 0.5, hold="previous")


def path(valve, seed):
    """Return where a stem stands in the middle of each second."""
    run = simulate(wire([walk(seed), valve]), 300.0, times=np.arange(300) + 0.5)
    assert run.ok
    return run.log["MV"]


@pytest.mark.parametrize("S, J", [(0.06, 0.02), (0.05, 0.05), (0.04, 0.03)])
def test_a_held_op_moves_it_as_he_says(S, J):
    he = HeValve((S + J) / 2.0, (S - J) / 2.0, 1.0, start=0.5, **WIDE)
    np.testing.assert_allclose(path(RestingStem(S, J, start=0.5, **WIDE), 1), path(he, 1), atol=1e-9)


def test_without_a_jump_it_is_a_play():
    np.testing.assert_allclose(
        path(RestingStem(0.05, 0.0, start=0.5, **WIDE), 2), path(Deadband(0.05, start=0.5, **WIDE), 2), atol=1e-6
    )


def test_a_stem_with_mass_rests_between_scans_too():
    heavy = StickSlip(start=0.5)
    resting, sliding = RestingStem(heavy.S, heavy.J, start=0.5), QuasiStaticStem(heavy.S, heavy.J, start=0.5)
    true = path(heavy, 3)
    assert np.max(np.abs(path(resting, 3) - true)) < 1e-3  # of travel: the jumps of the one with mass take a while
    assert np.max(np.abs(path(sliding, 3) - true)) > 5e-3

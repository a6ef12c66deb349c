"""Chen's valve: smooth on ramps, robust to noise, misuse."""

import numpy as np
import pytest
from stickslip.blocks.chen_valve import ChenValve
from stickslip.blocks.he_valve import HeValve
from stickslip.blocks.ports import BlockError

from tests.blocks.test_valves_agree import sampled

PERCENT = {"low": 0.0, "high": 100.0, "start": 50.0}


def test_moves_along_a_ramp_at_every_sample():
    op = np.arange(50.0, 80.0, 0.01)
    mv = sampled(ChenValve(6.0, 2.0, 1.0, **PERCENT), op)
    slip = np.flatnonzero(np.diff(mv))[0]
    np.testing.assert_allclose(mv[slip + 1 :], op[slip + 1 :] - 2.0)  # analytic: OP - f_d
    steps = np.count_nonzero(np.diff(sampled(HeValve.from_bands(6.0, 2.0, 1.0, **PERCENT), op)))
    assert np.count_nonzero(np.diff(mv)) > 100 * steps  # He's stops at every sample instead


def test_held_op_does_not_creep():
    # analytic: rounding must not let the stem follow an OP that stands still, then J frees it
    for level in np.random.default_rng(5).uniform(60.0, 90.0, 50):
        op = [50.0, level, level, level, level + 1.9, level + 2.1]
        mv = sampled(ChenValve(6.0, 2.0, 1.0, **PERCENT), op)
        np.testing.assert_allclose(mv, [50.0, *[level - 2.0] * 4, level + 0.1])


def test_misuse_is_explained():
    with pytest.raises(BlockError, match=r"S = 6.0, but 0 <= S <= 1.0 is needed"):
        ChenValve(6.0, 2.0, 1.0)

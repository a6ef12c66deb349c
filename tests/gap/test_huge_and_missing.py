"""Innovations beyond all squares and signals that are never logged: an answer without a warning of the arithmetic."""

import numpy as np
import pytest
from stickslip.gap.fits.loads import trimmed
from stickslip.gap.null_model.null_model import losses

pytestmark = pytest.mark.filterwarnings("error::RuntimeWarning")


def test_a_huge_innovation_has_no_weight_and_the_others_keep_theirs():
    e = np.array([[0.5], [-1.0], [0.8], [1e200], [np.inf], [np.nan]])
    usual = trimmed(e)[0][:, 0]
    # analytic: Student's weight 1 / (1 + e^2 / (nu s^2)), nu = 4, s = 2 times the median of 0.5, 0.8, 1, 1e200
    s = 2.0 * 0.9
    np.testing.assert_allclose(usual[:3], e[:3, 0] / (1.0 + (e[:3, 0] / s) ** 2 / 4.0), rtol=1e-12)
    assert usual[3:].tolist() == [0.0, 0.0, 0.0]


def test_the_loss_of_a_huge_innovation_is_the_largest():
    found = losses(np.array([0.0, 1.0, 1e200, np.nan]))
    assert found[2] == 1e9 > found[1] > found[0] == found[3] == 0.0

"""Stenman's valve: the definition by hand, misuse."""

import numpy as np
import pytest
from stickslip.blocks.ports import BlockError
from stickslip.blocks.stenman_valve import StenmanValve

from tests.blocks.test_valves_agree import sampled


def test_moves_to_op_or_not_at_all():
    op = [0.5, 0.54, 0.56, 0.52, 0.5, 0.98, 1.1, 0.99, 0.4]
    mv = sampled(StenmanValve(0.05, 1.0, start=0.5), op)
    np.testing.assert_array_equal(mv, [0.5, 0.5, 0.56, 0.56, 0.5, 0.98, 1.0, 1.0, 0.4])  # analytic, by hand


def test_misuse_is_explained():
    with pytest.raises(BlockError, match=r"d = 5.0, but 0 <= d <= 1.0 is needed.*high=100"):
        StenmanValve(5.0, 1.0)
    with pytest.raises(BlockError, match=r"dt = 0.0"):
        StenmanValve(0.05, 0.0)

"""Scrubber: a constant loss."""

import pytest
from stickslip.blocks.ports import BlockError
from stickslip.blocks.scrubber import Scrubber


def test_loss():
    assert Scrubber(2e4).output(0.0, [], [12e5])[0] == 11.8e5  # analytic
    assert Scrubber(0.0).output(0.0, [], [12e5])[0] == 12e5


def test_misuse_is_explained():
    with pytest.raises(BlockError, match=r"dp = -1.0, but a pressure loss is not negative"):
        Scrubber(-1.0)

"""Saturation: cut values, located instants; expected numbers are analytic."""

import numpy as np
import pytest
from stickslip.blocks.periodic import Sine
from stickslip.blocks.ports import BlockError
from stickslip.blocks.saturation import Saturation
from stickslip.diagram import drive


def test_it_cuts_and_tells_when():
    run = drive(Saturation("x", "OP", -0.5, 0.5), 10.0, every=0.1, OP=Sine("OP", 1.0, 10.0))
    sine = np.sin(2 * np.pi * run.log.t / 10.0)
    np.testing.assert_allclose(run.log["x"], np.clip(sine, -0.5, 0.5), atol=1e-12)
    # sin = 1/2 at 1/12, 5/12 of the period, -1/2 at 7/12, 11/12
    assert [e.t for e in run.events] == pytest.approx([10 / 12, 50 / 12, 70 / 12, 110 / 12], abs=1e-9)
    assert [e.after for e in run.events] == ["at high limit", "free", "at low limit", "free"]


def test_misuse_is_refused_with_value_rule_and_remedy():
    with pytest.raises(BlockError, match=r"low = 1.0, but it must be below high = 1.0; exchange or correct"):
        Saturation("y", "u", 1.0, 1.0)

"""Flow resistance: the same root as a valve, both ways."""

import pytest
from stickslip.blocks.control_valve_flow import root
from stickslip.blocks.flow_resistance import FlowResistance
from stickslip.blocks.ports import BlockError


def test_flow_is_signed():
    link = FlowResistance(0.06)
    there = link.output(0.0, [], [22.4e5, 22.1e5])[0]
    assert there == pytest.approx(0.06 * root(0.3e5, 100.0), rel=1e-14)  # analytic
    assert link.output(0.0, [], [22.1e5, 22.4e5])[0] == -there
    assert link.output(0.0, [], [5e5, 5e5])[0] == 0.0


def test_misuse_is_explained():
    with pytest.raises(BlockError, match=r"K = 0.0, but a resistance passes some flow"):
        FlowResistance(0.0)
    with pytest.raises(BlockError, match=r"p_lam"):
        FlowResistance(1.0, p_lam=float("nan"))

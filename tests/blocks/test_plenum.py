"""Plenum: mass balance, filling through a resistance."""

import numpy as np
import pytest
from stickslip.blocks.flow_resistance import FlowResistance
from stickslip.blocks.plenum import Plenum
from stickslip.blocks.ports import BlockError
from stickslip.diagram import drive, simulate, wire


def test_every_flow_counts_with_its_sign():
    vessel = Plenum(0.6, start=20e5, inflows=["a", "b"], outflows=["c", "d"])
    rate = vessel.dynamics(0.0, vessel.x0, [5.0, 3.0, 2.0, 1.5])[0]
    assert rate == pytest.approx((5.0 + 3.0 - 2.0 - 1.5) * 453.43**2 / 0.6, rel=1e-14)  # analytic


def test_constant_surplus_is_a_ramp():
    run = drive(Plenum(2.0, start=10e5), 5.0, every=1.0, m_in=1.0, m_out=0.5)
    np.testing.assert_allclose(run.log["p"], 10e5 + 0.5 * 453.43**2 / 2.0 * run.log.t, rtol=1e-9)  # analytic


def test_emptying_through_a_resistance():
    """m = K sqrt(p - p_0): sqrt(p - p_0) falls in a straight line."""
    K, p_0 = 0.01, 1e5
    diagram = wire(
        [
            Plenum(0.6, start=20e5, inflows=[], outflows=["m"]),
            FlowResistance(K, p_lam=0.0, inputs=["p", "p_0"]),
        ],
        inputs=["p_0"],
    )
    run = simulate(diagram, 0.5, every=0.05, inputs={"p_0": p_0}, rtol=1e-9)
    slope = K * 453.43**2 / 0.6 / 2.0
    np.testing.assert_allclose(np.sqrt(run.log["p"] - p_0), np.sqrt(19e5) - slope * run.log.t, rtol=1e-7)  # analytic


def test_misuse_is_explained():
    with pytest.raises(BlockError, match=r"start = 0.0, but a pressure is positive"):
        Plenum(start=0.0)
    with pytest.raises(BlockError, match=r"a plenum needs at least one flow"):
        Plenum(start=1e5, inflows=[], outflows=[])
    with pytest.raises(BlockError, match=r"inflows = 2, but the flows are wired; make another Plenum"):
        Plenum(start=1e5).with_params(inflows=2)
    with pytest.raises(BlockError, match=r"V = -1.0"):
        Plenum(-1.0, start=1e5)


def test_one_flow_may_be_named_without_a_list():
    vessel = Plenum(start=20e5, inflows="m_in", outflows="m_out")
    assert vessel.input_labels == ["m_in", "m_out"]

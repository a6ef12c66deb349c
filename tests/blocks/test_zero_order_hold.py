"""Zero-order hold: the samples of a known signal, and the discrete loop behind it in closed form."""

import math

import numpy as np
import pytest
from stickslip.blocks.arithmetic import Sum
from stickslip.blocks.first_order import FirstOrder
from stickslip.blocks.periodic import Sine
from stickslip.blocks.ports import BlockError
from stickslip.blocks.sources import Constant
from stickslip.blocks.zero_order_hold import ZeroOrderHold
from stickslip.diagram import drive, simulate, wire


def test_it_takes_samples_and_holds_them():
    run = drive(ZeroOrderHold("y", "u", dt=0.7, offset=0.2, start=9.0), 10.0, every=0.1, u=Sine("u", 1.0, 5.0))
    k = np.floor((run.log.t - 0.2) / 0.7 + 1e-9)
    expected = np.where(k < 0, 9.0, np.sin(2 * np.pi * (0.2 + 0.7 * k) / 5.0))
    np.testing.assert_allclose(run.log["y"], expected, atol=1e-12)


def test_the_sampled_loop_follows_its_recurrence():
    # analytic: PV_(k+1) = a PV_k + (1 - a) K (1 - PV_k), a = exp(-dt/tau)
    e = Sum("e", {"SP": 1.0, "PV": -1.0})
    loop = wire([Constant("SP", 1.0), e, ZeroOrderHold("MV", "e", dt=2.0), FirstOrder(3.0, 5.0)])
    run = simulate(loop, 40.0, every=2.0, rtol=1e-10, atol=1e-12)
    a, PV = math.exp(-2.0 / 5.0), [0.0]
    for _ in range(20):
        PV.append(a * PV[-1] + (1 - a) * 3.0 * (1.0 - PV[-1]))
    np.testing.assert_allclose(run.log["PV"], PV, atol=1e-9)
    assert run.statistics.steps < 20 * 30


def test_python_control_sees_a_wire():
    hold = ZeroOrderHold("y", "u", dt=1.0, unit="bar", name="hold")
    twin = hold.smooth()
    assert float(twin.output(0.0, [], [0.3])[0]) == 0.3
    assert (twin.name, twin.input_labels, twin.output_labels) == ("hold", ["u"], ["y"])


def test_misuse_is_explained():
    with pytest.raises(BlockError, match=r"dt = 0.0, but it must be positive; give the sampling period"):
        ZeroOrderHold("y", "u", dt=0.0)

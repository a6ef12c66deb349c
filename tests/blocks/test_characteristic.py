"""Valve characteristics: their defining properties, the compiled run, linearisation, misuse."""

import math

import control as ct
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from stickslip.blocks.characteristic import Characteristic
from stickslip.blocks.ports import BlockError
from stickslip.blocks.sources import Ramp
from stickslip.diagram import drive


def flow(block, x):
    return np.array([float(block.output(0.0, [], [value])[0]) for value in x])


X = np.linspace(0.0, 1.0, 21)


@given(R=st.floats(0.01, 1000.0))
def test_shifted_law_runs_from_shut_to_full(R):
    y = flow(Characteristic(R), X)
    assert y[0] == 0.0 and y[-1] == pytest.approx(1.0, rel=1e-12)  # analytic
    assert np.all(np.diff(y) > 0.0)
    if R > 1.0001:
        np.testing.assert_allclose(y, (R**X - 1) / (R - 1), rtol=1e-9, atol=1e-12)  # analytic: as printed
        assert np.all(y <= X + 1e-12)
    elif R < 0.999:
        assert np.all(y >= X - 1e-12)  # quick opening


def test_linear_is_a_limit():
    np.testing.assert_array_equal(flow(Characteristic(), X), X)
    np.testing.assert_allclose(flow(Characteristic(1.0 + 1e-9), X), X, atol=1e-9)
    assert flow(Characteristic(), [-0.2])[0] == -0.2  # linear also beyond the stops


def test_classical_law_is_equal_percentage():
    y = flow(Characteristic.classical(50.0), X)
    np.testing.assert_allclose(y[1:] / y[:-1], 50.0 ** (1 / 20))  # analytic: equal steps, equal percentages
    assert y[0] == pytest.approx(0.02)  # analytic: 1/R when shut
    slope = ct.linearize(Characteristic.classical(50.0), [], [0.7]).D[0, 0]
    assert slope == pytest.approx(math.log(50.0) * 50.0**-0.3, rel=1e-4)  # analytic: ln(R) flow


def test_quick_opening_and_leak():
    assert flow(Characteristic.quick_opening(), [0.25, 1.0, -0.1]).tolist() == [0.5, 1.0, 0.0]  # analytic
    for law in (Characteristic(30.0, 0.02), Characteristic.classical(30.0, 0.02), Characteristic.quick_opening(0.02)):
        tight = law.with_params(leak=0.0)
        np.testing.assert_allclose(flow(law, X) - flow(tight, X), 0.02)  # analytic: an offset


@pytest.mark.parametrize(
    "law", [Characteristic(50.0, 0.01), Characteristic.classical(), Characteristic.quick_opening()]
)
def test_compiled_as_interpreted(law):
    run = drive(law, 1.0, every=0.05, MV=Ramp("MV", 1.0))
    np.testing.assert_allclose(run.log["flow"], flow(law, run.log["MV"]), rtol=1e-14)


def test_misuse_is_explained():
    with pytest.raises(BlockError, match=r"no law 'quick-opening'; did you mean 'quick opening'"):
        Characteristic(law="quick-opening")
    with pytest.raises(BlockError, match=r"R = 0.0, but a rangeability is positive"):
        Characteristic(0.0)
    with pytest.raises(BlockError, match=r"take the linear law"):
        Characteristic.classical(1.0)
    with pytest.raises(BlockError, match=r"leak = nan"):
        Characteristic(leak=math.nan)

"""Lookup table with two inputs: SciPy's bilinear interpolation as oracle, compiled sweeps, refusals."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import RegularGridInterpolator
from stickslip.blocks.lookup_2d import Lookup2D
from stickslip.blocks.periodic import Sine
from stickslip.blocks.ports import BlockError
from stickslip.blocks.recorded import Staircase
from stickslip.diagram import simulate, wire

X, Y = np.array([-1.0, 0.0, 0.3, 2.0]), np.array([10.0, 20.0, 50.0])
Z = np.random.default_rng(4).normal(size=(4, 3))


def oracle(a, b):
    grid = RegularGridInterpolator((X, Y), Z)
    return grid(np.column_stack([np.clip(a, X[0], X[-1]), np.clip(b, Y[0], Y[-1])]))


@given(a=st.floats(-2.0, 3.0), b=st.floats(0.0, 60.0))
def test_it_agrees_with_scipy(a, b):
    assert float(Lookup2D("z", "a", "b", X, Y, Z).output(0.0, [], [a, b])[0]) == pytest.approx(oracle([a], [b])[0])


def test_points_are_exact():
    table = Lookup2D("z", "a", "b", X, Y, Z)
    assert [[float(table.output(0.0, [], [a, b])[0]) for b in Y] for a in X] == pytest.approx(Z, abs=1e-14)


def test_compiled_sweeps_and_jumps():
    a, b = Sine("a", 1.8, 7.0, mean=0.5), Staircase("b", [5.0, 15.0, 49.0, 70.0], dwell=5.0)
    run = simulate(wire([a, b, Lookup2D("z", "a", "b", X, Y, Z)]), 20.0, every=0.03)
    np.testing.assert_allclose(run.log["z"], oracle(run.log["a"], run.log["b"]), atol=1e-9)
    assert run.events == () and run.statistics.steps < 300


@pytest.mark.parametrize(
    ("x", "z", "words"),
    [
        (X[::-1], Z, r"x\[0\] = 2.0 is followed by 0.3"),
        (X, Z.T, r"z = \(3, 4\), but one row for each of the 4 x and one column for each of the 3 y"),
        (X, np.full((4, 3), math.nan), "12 values that are no finite numbers"),
    ],
)
def test_misuse_is_explained(x, z, words):
    with pytest.raises(BlockError, match=words):
        Lookup2D("z", "a", "b", x, Y, z)


def test_its_size_stays():
    with pytest.raises(BlockError, match="m = 4, but it is the length of the table; make another Lookup2D"):
        Lookup2D("z", "a", "b", X, Y, Z).with_params(m=4)

"""Lookup table: numpy's interpolation as oracle, exact loops through kinks, few steps."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from stickslip.blocks.first_order import FirstOrder
from stickslip.blocks.lookup_1d import Lookup1D
from stickslip.blocks.periodic import Sine
from stickslip.blocks.ports import BlockError
from stickslip.blocks.recorded import Staircase
from stickslip.blocks.sources import Ramp
from stickslip.diagram import drive, simulate, wire


@st.composite
def tables(draw):
    gaps = draw(st.lists(st.floats(0.05, 10.0), min_size=1, max_size=8))
    x = draw(st.floats(-5.0, 5.0)) + np.cumsum([0.0, *gaps])
    return x, np.array(draw(st.lists(st.floats(-5.0, 5.0), min_size=len(x), max_size=len(x))))


@given(table=tables(), u=st.floats(-10.0, 90.0))
def test_it_agrees_with_numpy(table, u):
    x, y = table
    assert float(Lookup1D("y", "u", x, y).output(0.0, [], [u])[0]) == pytest.approx(np.interp(u, x, y), abs=1e-9)


def test_the_end_lines_may_go_on():
    line = Lookup1D("y", "u", [0.0, 1.0, 2.0], [0.0, 1.0, 3.0], beyond="extend")
    assert [float(line.output(0.0, [], [u])[0]) for u in (-2.0, 1.5, 4.0)] == [-2.0, 2.0, 7.0]  # analytic


@pytest.mark.parametrize("beyond", ["hold", "extend"])
def test_compiled_and_swept_back_and_forth(beyond):
    x, y = np.array([-0.7, -0.2, 0.1, 0.6]), np.array([1.0, -1.0, 2.0, 2.5])
    run = drive(Lookup1D("y", "u", x, y, beyond=beyond), 20.0, every=0.05, u=Sine("u", 1.0, 10.0))
    u = np.sin(2 * np.pi * run.log.t / 10.0)
    expected = np.interp(u, x, y)
    if beyond == "extend":
        expected = np.where(u < x[0], 1.0 - 4.0 * (u + 0.7), np.where(u > x[-1], 2.5 + (u - 0.6), expected))
    np.testing.assert_allclose(run.log["y"], expected, atol=1e-9)
    assert run.events == ()  # kinks are located, but not worth a line in the log


def test_jumps_over_many_points():
    x = np.linspace(0.0, 1.0, 101)
    run = drive(Lookup1D("y", "u", x, x**2), 4.0, every=1.0, u=Staircase("u", [0.5, 0.99, 0.01, 2.0], dwell=1.0))
    assert run.log["y"].tolist() == pytest.approx([0.25, 0.9801, 0.0001, 1.0, 1.0])


def test_kinks_are_located_so_that_the_process_behind_is_exact():
    # analytic: tau dPV/dt = f(t) - PV with f = t until 1, then 1: PV = t - 1 + exp(-t), then 1 - (1 - 1/e) exp(-(t-1))
    loop = wire([Ramp("u", 1.0), Lookup1D("MV", "u", [0.0, 1.0], [0.0, 1.0]), FirstOrder(1.0, 1.0)])
    run = simulate(loop, 6.0, every=0.1, rtol=1e-9, atol=1e-12)
    t = run.log.t
    early, late = t - 1 + np.exp(-t), 1 - (1 - math.exp(-1)) * np.exp(-(np.maximum(t, 1.0) - 1))
    np.testing.assert_allclose(run.log["PV"], np.where(t < 1, early, late), atol=1e-8)
    assert run.statistics.steps < 60 and run.statistics.events == 2


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Lookup1D("y", "u", [0.0, 0.0], [0.0, 1.0]), r"x\[0\] = 0.0 is followed by 0.0.*sort them"),
        (lambda: Lookup1D("y", "u", [0.0], [0.0]), r"x = \[0.0\], but a table has 2 or more points"),
        (lambda: Lookup1D("y", "u", [0.0, 1.0], [0.0]), "y = '1 numbers', but each of the 2 points"),
        (lambda: Lookup1D("y", "u", [0.0, 1.0], [0.0, math.nan]), "needs a finite value"),
        (lambda: Lookup1D("y", "u", [0, 1], [0, 1], beyond="holds"), "did you mean 'hold'"),
        (lambda: Lookup1D("y", "u", [0, 1], [0, 1]).with_params(n=3), "n = 3, but it is the length of the table"),
        (lambda: Lookup1D("y", "u", [0, 1], [0, 1]).with_params(extend=3), "extend = 3.0, but it is 0"),
    ],
)
def test_misuse_is_explained(make, words):
    with pytest.raises(BlockError, match=words):
        make()

"""Chirp: SciPy's as oracle, steps short enough for its highest frequency."""

import math

import numpy as np
import pytest
import scipy.signal
from hypothesis import given
from hypothesis import strategies as st
from stickslip.blocks.chirp import Chirp
from stickslip.blocks.first_order import FirstOrder
from stickslip.blocks.ports import BlockError
from stickslip.diagram import simulate, wire
from stickslip.diagram.reference import simulate_reference

LAWS = {"linear": "linear", "exponential": "logarithmic"}


@pytest.mark.parametrize("sweep", LAWS)
@given(f_start=st.floats(1e-3, 1.0), f_end=st.floats(1e-3, 1.0), share=st.floats(0.0, 0.999))
def test_it_agrees_with_scipy(sweep, f_start, f_end, share):
    block = Chirp("u", 2.0, f_start=f_start, f_end=f_end, duration=100.0, sweep=sweep, mean=1.0, start=5.0)
    expected = 1.0 + 2.0 * scipy.signal.chirp(100.0 * share, f_start, 100.0, f_end, method=LAWS[sweep], phi=-90.0)
    assert float(block.output(5.0 + 100.0 * share, [], [])[0]) == pytest.approx(expected, abs=1e-6)


@pytest.mark.parametrize("sweep", LAWS)
@pytest.mark.parametrize(("f_start", "f_end"), [(1e-4, 2.0), (2.0, 1e-4), (0.5, 0.5)])
def test_no_step_skips_a_period(sweep, f_start, f_end):
    block = Chirp("MV", 1.0, f_start=f_start, f_end=f_end, duration=50.0, sweep=sweep)
    loop = wire([block, FirstOrder(1.0, 2.0)])
    ours = simulate(loop, 60.0, every=0.5)
    theirs = simulate_reference(loop, 60.0, every=0.5, method="DOP853", max_step=0.01, rtol=1e-8)
    assert ours.statistics.steps < 60 * 24 * 3
    np.testing.assert_allclose(ours.log["PV"], theirs.log["PV"], atol=1e-4)
    assert ours.log["MV"][-1] == 0.0


@pytest.mark.parametrize("sweep", LAWS)
@given(f_start=st.floats(1e-3, 10.0), f_end=st.floats(1e-3, 10.0), share=st.floats(0.0, 0.99))
def test_its_longest_step_is_a_24th_of_a_period(sweep, f_start, f_end, share):
    block = Chirp("u", 1.0, f_start=f_start, f_end=f_end, duration=80.0, sweep=sweep)
    out, t = np.array([math.inf, math.inf]), 80.0 * share
    block.kernels.next_time(t, block.x0, block.d0, np.zeros(0), block.p, out)
    assert out[0] == 80.0
    grid = np.linspace(t, min(t + out[1], 80.0), 200)
    frequency = f_start + (f_end - f_start) * grid / 80.0
    if sweep == "exponential":
        frequency = f_start * (f_end / f_start) ** (grid / 80.0)
    assert np.trapezoid(frequency, grid) <= 1.001 / 24.0  # periods passed in one step


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"f_start": 0.0}, "f_start = 0.0, but it must be positive and finite; give Hz"),
        ({"duration": -1.0}, "duration = -1.0, but it must be positive and finite; give seconds"),
        ({"sweep": "linea"}, "did you mean 'linear'"),
        ({"mean": math.inf}, "mean = inf"),
    ],
)
def test_misuse_is_explained(change, words):
    with pytest.raises(BlockError, match=words):
        Chirp("u", 1.0, **({"f_start": 0.1, "f_end": 1.0, "duration": 10.0} | change))

"""The quantiser: nearest multiples, edges located, in a loop too."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from stickslip.blocks import PI, BlockError, FirstOrder, IdealValve, Quantiser, Sine, Step
from stickslip.diagram import drive, simulate, wire


@given(st.floats(0.01, 10.0), st.floats(-50.0, 50.0))
def test_it_gives_the_nearest_multiple(step, value):
    y = drive(Quantiser("y", "u", step), 1.0, every=1.0, u=value).log["y"]
    assert np.abs(y - value).max() <= step * (0.5 + 1e-9)  # nothing was crossed before
    np.testing.assert_allclose(y / step, np.round(y / step), atol=1e-9)


def test_edges_are_located():
    run = simulate(wire([Sine("u", 1.0, 100.0), Quantiser("y", "u", 0.25)]), 100.0, every=0.1)
    share = run.log["u"] / 0.25 + 0.5
    clear = np.abs(share - np.round(share)) > 0.011
    np.testing.assert_allclose(run.log["y"][clear], 0.25 * np.floor(share[clear]), atol=1e-9)


def test_a_loop_that_sees_whole_steps_rests_within_one():
    loop = wire(
        [
            Step("SP", after=0.52),
            PI(0.4, 10.0),
            IdealValve(),
            FirstOrder(3.0, 10.0, outputs="y"),
            Quantiser("PV", "y", 0.05),
        ]
    )
    run = simulate(loop, 600.0, every=1.0)
    assert run.ok and np.abs(run.log["y"][200:] - 0.52).max() < 0.05
    assert set(np.round(run.log["PV"][200:] / 0.05)) <= {10.0, 11.0}


def test_a_step_of_nothing_is_refused():
    with pytest.raises(BlockError, match=r"step = 0\.0, but it must be positive .* leave the quantiser out"):
        Quantiser("y", "u", 0.0)

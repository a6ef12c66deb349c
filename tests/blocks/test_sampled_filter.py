"""Sampled filter of first order: exact for held inputs, its twin, refusals."""

import numpy as np
import pytest
from stickslip.blocks.first_order import FirstOrder
from stickslip.blocks.ports import BlockError
from stickslip.blocks.recorded import Staircase
from stickslip.blocks.sampled_filter import SampledFilter
from stickslip.diagram import drive


def stairs(values, dt):
    return Staircase("u", list(values), dwell=dt)


def test_it_is_exact_for_a_held_input():
    u = np.random.default_rng(3).normal(size=40)
    sampled = drive(SampledFilter("y", "u", tau=3.0, dt=0.5), 19.5, every=0.5, u=stairs(u, 0.5)).log["y"]
    lag = FirstOrder(1.0, 3.0, inputs="u", outputs="y")
    exact = drive(lag, 20.0, every=0.5, u=stairs(u, 0.5), rtol=1e-10, atol=1e-12).log["y"]
    np.testing.assert_allclose(sampled, exact[1:], atol=1e-9)  # one scan ahead of the lag


def test_no_filter():
    u = [0.3, -1.0, 2.0]
    assert drive(SampledFilter("y", "u", tau=0.0, dt=1.0), 2.0, every=1.0, u=stairs(u, 1.0)).log["y"].tolist() == u
    assert float(SampledFilter("y", "u", tau=0.0, dt=1.0).smooth().output(0.0, [], [0.4])[0]) == 0.4


def test_a_settled_start_stays():
    run = drive(SampledFilter("y", "u", 3.0, 1.0, start=0.7), 20.0, every=0.5, u=0.7)
    np.testing.assert_allclose(run.log["y"], 0.7, rtol=1e-12)


def test_python_control_sees_the_lag():
    lag = SampledFilter("y", "u", 3.0, 1.0, start=0.7, unit="bar", name="filter").smooth()
    assert isinstance(lag, FirstOrder) and lag.params["tau"] == 3.0 and lag.x0.tolist() == [0.7]
    assert (lag.name, lag.input_labels, lag.output_labels, lag.units["PV"]) == ("filter", ["u"], ["y"], "bar")


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: SampledFilter("y", "u", -1.0, 1.0), "tau = -1.0, but it must be finite and not negative"),
        (lambda: SampledFilter("y", "u", 1.0, 0.0), "dt = 0.0, but it must be positive"),
    ],
)
def test_misuse_is_explained(make, words):
    with pytest.raises(BlockError, match=words):
        make()

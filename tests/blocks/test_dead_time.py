"""Dead time: exact in the engine, Pade for python-control."""

import math

import control as ct
import numpy as np
import pytest
from stickslip.blocks.dead_time import ORDER, DeadTime, pade
from stickslip.blocks.periodic import Sine, Square
from stickslip.blocks.ports import BlockError
from stickslip.diagram import drive

LABELS = {"inputs": "u", "outputs": "y"}


@pytest.mark.parametrize("theta", [0.0, 0.3, 1.7, 13.0])
def test_engine_delays_a_sine_and_a_square_wave_exactly(theta):
    for source in (Sine("u", 1.0, 5.0), Square("u", 1.0, 5.0)):
        run = drive(DeadTime(theta, **LABELS, start=-2.0), 20.0, every=0.13, u=source)
        expected = [float(source.output(t - theta, [], [])[0]) if t >= theta else -2.0 for t in run.log.t]
        edge = np.abs((run.log.t - theta) % 2.5) < 1e-9  # at a jump either side is right
        # analytic; the ring interpolates a sine between its own steps to fourth order
        np.testing.assert_allclose(run.log["y"][~edge], np.array(expected)[~edge], atol=2e-6)


def test_pade_is_that_of_python_control():
    top, bottom = ct.pade(1.0, ORDER, ORDER - 1)  # independent: python-control
    A, C = pade()
    np.testing.assert_allclose(C, np.array(top) / bottom[0], rtol=1e-12)
    np.testing.assert_allclose(A[0], -np.array(bottom[1:]) / bottom[0], rtol=1e-12)


def test_linear_view_has_the_stated_accuracy():
    theta = 4.0
    view = ct.linearize(DeadTime(theta, **LABELS), np.zeros(ORDER), [0.0])
    for w in np.array([0.1, 1.0, 3.0, 5.0]) / theta:
        response = complex(view(1j * w))
        exact = np.exp(-1j * w * theta)  # analytic
        assert abs(abs(response) - 1.0) < 0.01
        assert abs(np.angle(response / exact, deg=True)) < 0.4
    assert ct.dcgain(view) == pytest.approx(1.0, rel=1e-6)


def test_python_control_starts_at_rest():
    block = DeadTime(2.0, start=0.7, **LABELS)
    x0 = block.seen_start()
    assert float(block.output(0.0, x0, [0.7])[0]) == pytest.approx(0.7, rel=1e-12)  # analytic: a state of rest
    np.testing.assert_allclose(block.dynamics(0.0, x0, [0.7]), 0.0, atol=1e-12)


def test_dead_time_comes_and_goes_with_its_parameter():
    block = DeadTime(0.0, **LABELS)
    assert block.nstates == 0 and block.with_params(theta=2.0).nstates == ORDER
    assert block.with_params(theta=2.0).with_params(theta=0.0).nstates == 0
    with pytest.raises(BlockError, match=r"theta = 2.0 changes the number of states.*with_params\(theta=2.0\)"):
        ct.input_output_response(block, [0.0, 1.0], [0.0, 0.0], params={"theta": 2.0})


def test_misuse_is_explained():
    with pytest.raises(BlockError, match=r"theta = -1.0, but a dead time is finite and not negative"):
        DeadTime(-1.0)
    with pytest.raises(BlockError, match=r"theta_start = inf"):
        DeadTime(1.0, start=math.inf)

"""Lead-lag: step, ramp and frequency responses in closed form, python-control's transfer function as twin."""

import math

import control as ct
import numpy as np
import pytest
from stickslip.blocks.lead_lag import LeadLag
from stickslip.blocks.periodic import Sine
from stickslip.blocks.ports import BlockError
from stickslip.diagram import drive

SHARP = {"rtol": 1e-9, "atol": 1e-11}


@pytest.mark.parametrize("T_lead", [-4.0, 0.0, 1.0, 3.0, 12.0])
def test_step_response(T_lead):
    run = drive(LeadLag("y", "u", T_lead, 3.0, K=2.0), 15.0, every=0.5, u=1.5, **SHARP)
    expected = 3.0 * (1 + (T_lead / 3.0 - 1) * np.exp(-run.log.t / 3.0))  # analytic
    np.testing.assert_allclose(run.log["y"], expected, atol=1e-7)
    assert run.statistics.steps < 60


def test_sine_response():
    T_1, T_2, w = 8.0, 2.0, 2 * math.pi / 10.0
    run = drive(LeadLag("y", "u", T_1, T_2), 60.0, every=0.1, u=Sine("u", 1.0, 10.0), **SHARP)
    late = run.log.t > 40.0
    G = (1j * w * T_1 + 1) / (1j * w * T_2 + 1)  # analytic
    expected = abs(G) * np.sin(w * run.log.t[late] + np.angle(G))
    np.testing.assert_allclose(run.log["y"][late], expected, atol=1e-6)


def test_it_is_its_transfer_function():
    seen = ct.tf(ct.linearize(LeadLag("y", "u", 8.0, 2.0, K=3.0), [0.0], [0.0]))
    for w in (0.01, 0.5, 20.0):
        assert seen(1j * w) == pytest.approx(3.0 * (8j * w + 1) / (2j * w + 1), rel=1e-6)


def test_a_settled_start_stays():
    run = drive(LeadLag("y", "u", 5.0, 2.0, K=2.0, start=0.7), 10.0, every=1.0, u=0.7)
    np.testing.assert_allclose(run.log["y"], 1.4, rtol=1e-14)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: LeadLag("y", "u", 1.0, 0.0), "T_lag = 0.0, but it must be positive and finite; give seconds"),
        (lambda: LeadLag("y", "u", math.inf, 1.0), "T_lead = inf"),
        (lambda: LeadLag("y", "u", 1.0, 1.0, K=math.nan), "K = nan"),
    ],
)
def test_misuse_is_explained(make, words):
    with pytest.raises(BlockError, match=words):
        make()

"""Flare: shut below its limit, PI above, no windup."""

import numpy as np
import pytest
from stickslip.blocks.flare import Flare
from stickslip.blocks.sources import Step
from stickslip.diagram import drive


def test_pi_above_the_limit():
    run = drive(Flare(), 2.0, every=0.5, SP=40e5, PV=41e5)
    np.testing.assert_allclose(run.log["OP"], 0.01 * 1e5 * (1.0 + run.log.t / 0.8), rtol=1e-9)  # analytic


def test_shut_below_and_does_not_wind_up():
    run = drive(Flare(), 20.0, every=0.5, SP=40e5, PV=Step("PV", 40.5e5, 30e5, at=10.0))
    t, flow = run.log.t, run.log["OP"]
    assert np.all(flow[t < 10.0] == 0.0)
    late = t >= 10.0
    np.testing.assert_allclose(
        flow[late], 500.0 * (1.0 + (t[late] - 10.0) / 0.8), rtol=1e-9
    )  # analytic, z = 0 till then


def test_ports_have_units():
    assert Flare().units == {"SP": "Pa", "PV": "Pa", "OP": "mol/s"}


def test_misuse_is_explained():
    with pytest.raises(ValueError, match=r"K_p = -1.0"):
        Flare(-1.0)

"""The best linear process behind an input: known processes are found, and closed-loop noise does not mislead."""

import math
from typing import get_args

import numpy as np
import pytest
from stickslip.detect.stem.linear_models import Linear, bank, fit, near_by


def excited(n=1000, seed=0):
    """A square-like wave of 50 samples with a random length each half."""
    rng = np.random.default_rng(seed)
    return np.concatenate([np.full(rng.integers(20, 31), (-1.0) ** i) for i in range(n // 20)])[:n]


def behind(u, tau, delay, gain=3.0, tau_2=0.0):
    """First-order lags of a held input, by their own recursion."""
    y, z, out = 0.0, 0.0, []
    late = np.concatenate([np.full(delay, u[0]), u[: len(u) - delay]])
    for k in range(len(u)):
        out.append(gain * (z if tau_2 else y))
        y += (late[k] - y) * -math.expm1(-1 / tau)
        if tau_2:
            z += (y - z) * -math.expm1(-1 / tau_2)
    return np.array(out)


@pytest.mark.parametrize("model", get_args(Linear))
@pytest.mark.parametrize(("tau", "delay"), [(5.0, 3), (20.0, 0), (1.0, 8)])
def test_a_known_process_is_found(model, tau, delay):
    u = excited()
    y = behind(u, tau, delay) + 0.05 * np.random.default_rng(1).normal(size=1000)
    tried = bank(50.0, model, 1.0, 25)
    found = fit(u[None], y, 50.0, model, tried)
    found = fit(u[None], y, 50.0, model, near_by(tried, found.processes[0]))
    process = found.processes[0]
    assert found.quality[0] > 93
    assert process.tau_1 + process.tau_2 + process.delay == pytest.approx(tau + delay, rel=0.12, abs=0.6)
    assert process.gain == pytest.approx(3.0, rel=0.06)
    assert 100 * (1 - np.std(found.y - found.simulated) / np.std(found.y)) == pytest.approx(found.quality[0], abs=0.1)


def test_quality_is_that_of_a_simulation():
    """Analytic: white noise of 20 % of the wave leaves 1 - sqrt(0.04 / 1.04) of it, whatever the fit minimises."""
    u = excited(8000)
    y = behind(u, 6.0, 2)
    y = y + 0.2 * np.std(y) * np.random.default_rng(2).normal(size=len(y))
    for model in ("oe1", "oe2", "armax"):
        found = fit(u[None], y, 50.0, model, bank(50.0, model, 1.0, 40))
        assert found.quality[0] == pytest.approx(100 * (1 - math.sqrt(0.04 / 1.04)), abs=1.0)


def test_a_slow_disturbance_needs_an_extended_model():
    u = excited()
    drift = np.cumsum(np.random.default_rng(3).normal(size=1000)) * 0.3
    y = behind(u, 6.0, 2) + drift
    quality = {m: fit(u[None], y, 50.0, m, bank(50.0, m, 1.0, 25)).quality[0] for m in ("oe1", "eoe", "earmax")}
    assert quality["eoe"] > quality["oe1"] + 20
    assert quality["earmax"] > quality["oe1"] + 20


def test_an_integrator_is_found():
    u = excited() - 0.2
    y = 0.05 * np.concatenate([[0.0], np.cumsum(u)[:-1]])
    found = fit(u[None], y, 50.0, "eoe", bank(50.0, "eoe", 1.0, integrating=True))
    assert found.quality[0] > 98
    assert found.processes[0].gain == pytest.approx(0.05, rel=0.03)


def test_the_wrong_sign_of_gain_tells_nothing():
    u = excited()
    assert fit(u[None], -behind(u, 50.0, 0), 50.0, "oe1", bank(50.0, "oe1", 0.0)).quality[0] > 90
    white = np.random.default_rng(0).normal(size=1000)
    assert fit(white[None], -white, 50.0, "oe1", bank(50.0, "oe1", 1.0)).quality[0] < 15


def test_output_error_shrugs_off_what_misleads_arx():
    """A loop moved through its set point, white noise on PV: ARX takes noise for process (tau far too short).

    The process is 1 / (10 s + 1); ARX by least squares on the same record shows that the trap is there.
    """
    rng = np.random.default_rng(4)
    pv, integral, rows = 0.0, 0.0, []
    for k in range(4000):
        seen = pv + 0.3 * rng.normal()
        e = math.copysign(1.0, math.sin(2 * math.pi * k / 60)) - seen
        integral += 0.05 * e
        u = 0.5 * e + integral
        rows.append((u, seen))
        pv += (u - pv) * -math.expm1(-1 / 10)
    u, y = np.array(rows).T
    found = fit(u[None], y, 60.0, "oe1", bank(60.0, "oe1", 1.0, 40)).processes[0]
    assert found.tau_1 + found.delay == pytest.approx(10, rel=0.2)
    assert found.gain == pytest.approx(1.0, rel=0.1)
    arx = np.linalg.lstsq(np.stack([y[:-1], u[:-1]], axis=1), y[1:], rcond=None)[0]
    assert -1.0 / math.log(arx[0]) < 5.0


def test_unknown_models_are_refused():
    with pytest.raises(ValueError, match="oe1, oe2, armax, eoe, earmax"):
        bank(50.0, "arx", 1.0)

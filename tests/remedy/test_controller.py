"""The controller read off OP, SP and PV: beside the laws that made the logs."""

import math

import numpy as np
import pytest
from scipy.signal import lfilter
from stickslip.blocks import PID, FirstOrder, Noise, SampledPI, SampledSensor, Step, Sum
from stickslip.diagram import drive, simulate, wire
from stickslip.remedy.controller import controller_of, limits_of

FREE = (-math.inf, math.inf)


def logged(controller, sensor=None, duration=3000.0):
    """A loop with noise, logged at the scan."""
    return simulate(
        wire([
            Step("SP", 0.0, 1.0, at=500.0), controller, FirstOrder(2.0, 20.0, 2.0, inputs="OP", outputs="y"),
            Noise("d", 0.3, 1.0, correlation_time=40.0, seed=4), Sum("true", {"y": 1.0, "d": 1.0}),
            SampledSensor(1.0, sd=0.02, seed=5, inputs="true", outputs="PV"),
        ]), duration, every=1.0,
    ).log  # fmt: skip


@pytest.mark.parametrize("integral", ["previous", "present"])
@pytest.mark.parametrize("action", ["reverse", "direct"])
def test_a_scanned_controller_is_read_to_the_digit(integral, action):
    e = np.random.default_rng(2).normal(size=400).cumsum() * 0.1
    t = np.arange(400.0)
    law = SampledPI(0.7, 12.0, dt=1.0, low=-1e9, high=1e9, integral=integral, action=action)
    op = drive(law, 399.0, every=1.0, SP=0.0, PV=(t, -e)).log["OP"]
    found = controller_of(op, -e, np.zeros(400), 1.0, FREE)
    # analytic: with the present error in its integral the law is the same with K_p (1 + dt/T_i) and T_i + dt
    late = 1.0 if integral == "present" else 0.0
    assert found.form == "PI"
    assert found.K_p == pytest.approx((0.7 if action == "reverse" else -0.7) * (1.0 + late / 12.0), rel=1e-6)
    assert found.T_i == pytest.approx(12.0 + late, rel=1e-6)
    if integral == "present":
        assert found.present == pytest.approx((0.7 if action == "reverse" else -0.7, 12.0), rel=1e-6)


def test_rounded_to_a_tenth_it_is_read_within_its_interval():
    log = logged(SampledPI(0.6, 25.0, dt=1.0, low=-1e9, high=1e9))
    op, pv = (np.round(log[key], 2) for key in ("OP", "PV"))
    found = controller_of(op, pv, log["SP"], 1.0, FREE)
    assert found.K_p == pytest.approx(0.6, rel=0.02)
    assert found.T_i == pytest.approx(25.0, rel=0.05)
    assert found.explained > 0.9


def test_without_a_set_point_its_level_is_one_more_unknown():
    log = logged(SampledPI(0.6, 25.0, dt=1.0, low=-1e9, high=1e9), duration=450.0)
    found = controller_of(log["OP"], log["PV"] + 7.0, None, 1.0, FREE)
    assert (found.K_p, found.T_i) == (pytest.approx(0.6, rel=1e-6), pytest.approx(25.0, rel=1e-6))


def test_a_derivative_is_seen():
    found = [controller_of(*(log[key] for key in ("OP", "PV", "SP")), 1.0, FREE) for log in (
        logged(PID(0.6, 25.0, 4.0, N=8.0, low=-1e9, high=1e9)), logged(SampledPI(0.6, 25.0, dt=1.0, low=-1e9, high=1e9))
    )]  # fmt: skip
    assert found[0].T_d > 1.0 and found[1].T_d == 0.0


@pytest.mark.parametrize("digits", [2, 9])
def test_a_filter_of_pv_is_seen(digits):
    rng, n, a = np.random.default_rng(7), 1500, math.exp(-1.0 / 6.0)
    pv = 0.1 * rng.normal(size=n).cumsum() + 0.2 * rng.normal(size=n)
    smooth = pv.copy()
    for k in range(1, n):
        smooth[k] = a * smooth[k - 1] + (1.0 - a) * pv[k]
    op = drive(SampledPI(0.7, 12.0, dt=1.0, low=-1e9, high=1e9), n - 1.0, every=1.0, SP=0.0, PV=(np.arange(n), smooth))
    found = controller_of(np.round(op.log["OP"], digits), pv, np.zeros(n), 1.0, FREE)
    assert (found.K_p, found.T_i) == (pytest.approx(0.7, rel=0.03), pytest.approx(12.0, rel=0.03))
    assert found.T_f == pytest.approx(6.0, rel=0.05) and found.explained > 0.99
    plain = controller_of(np.round(op.log["OP"], digits), smooth, np.zeros(n), 1.0, FREE)
    assert plain.T_f == 0.0


def test_rows_at_a_limit_say_nothing():
    op = np.concatenate([np.linspace(0.0, 9.0, 50), np.full(20, 10.0), np.linspace(9.0, 2.0, 50)])
    assert limits_of(op, (0.0, 100.0)) == (0.0, 10.0)
    assert limits_of(op[:40], (0.0, 100.0)) == (0.0, 100.0)


def test_what_follows_nothing_is_told_so():
    rng = np.random.default_rng(3)
    found = controller_of(rng.normal(size=500).cumsum(), rng.normal(size=500).cumsum(), np.zeros(500), 1.0, FREE)
    assert found.explained < 0.1


def test_a_law_that_proportional_action_tells_whole_has_no_integral_time():
    e = np.random.default_rng(7).normal(size=300)
    found = controller_of(0.5 * e, -e, np.zeros(300), 1.0, FREE)
    assert found.form == "P"
    assert found.spread("T_i")[1] == math.inf  # it is not known to end


def test_a_derivative_behind_its_own_filter_is_read_as_it_was_set():
    # analytic: K_p (1 + 1/(T_i s) + T_d s/(T_f s + 1)), each scan, as most control systems have it
    K_p, T_i, T_d, dt, a, rng = 3.2, 70.0, 20.0, 5.0, 4.0 / 9.0, np.random.default_rng(3)  # T_f is 4 s
    pv = 0.02 * rng.normal(size=1500).cumsum() + 0.04 * rng.normal(size=1500)
    slope = np.diff(lfilter([1.0 - a], [1.0, -a], pv - pv[0]), prepend=0.0) / dt
    op = 50.0 - K_p * (pv - pv[0] + dt / T_i * np.cumsum(pv - pv[0]) + T_d * slope)
    found = controller_of(op, pv, np.full(1500, pv[0]), dt, FREE)
    assert found.form == "PID" and found.explained > 0.99999
    assert found.present == (pytest.approx(K_p, rel=0.01), pytest.approx(T_i, rel=0.01))
    assert found.T_f == pytest.approx(-dt / math.log(a), rel=0.02)

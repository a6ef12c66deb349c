"""Sensors: lag, bias, span, drift, limits, noise, quantisation; expected numbers are analytic unless labelled."""

import math

import control as ct
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import brentq
from stickslip.blocks.periodic import Sine
from stickslip.blocks.ports import BlockError
from stickslip.blocks.sensor import SampledSensor, Sensor
from stickslip.blocks.sources import Constant, Ramp
from stickslip.diagram import drive, simulate, wire


def drive_at(block, times, rtol=1e-6, atol=1e-9, **inputs):
    """Drive one block alone and return its run, logged at the given times."""
    diagram = wire([block], inputs=block.input_labels)
    return simulate(diagram, float(np.max(times)), times=times, inputs=inputs, rtol=rtol, atol=atol)


def read(sensor, PV):
    return float(sensor.output(0.0, sensor.d0 if sensor.sampled else sensor.x0, [PV])[0])


def test_lag_answers_a_step_with_an_exponential():
    run = drive(Sensor(tau=4.0, start=1.0), 20.0, every=1.0, PV=3.0)
    np.testing.assert_allclose(run.log["PV_m"], 3.0 - 2.0 * np.exp(-run.log.t / 4.0), atol=2e-6)


def test_lag_follows_a_ramp_tau_seconds_late():
    run = drive_at(Sensor(tau=2.0), [40.0], PV=Ramp("PV", 0.5))
    assert run.log["PV_m"][0] == pytest.approx(0.5 * (40.0 - 2.0), rel=1e-6)


def test_span_bias_and_drift_add_up():
    run = drive(Sensor(factor=1.1, bias=-0.2, drift=0.01), 10.0, every=10.0, PV=2.0)
    assert run.log["PV_m"].tolist() == pytest.approx([2.0, 2.1])


def test_started_settled_it_stays_there():
    run = drive(Sensor(tau=5.0, factor=1.1, bias=0.3, start=2.0), 10.0, every=1.0, PV=2.0)
    np.testing.assert_allclose(run.log["PV_m"], 2.5, rtol=1e-12)


@pytest.mark.parametrize("tau", [0.0, 0.5])
def test_limits_are_met_and_left_at_located_instants(tau):
    run = drive(Sensor(tau, low=-0.5, high=0.5), 10.0, every=0.1, PV=Sine("PV", 1.0, 10.0))
    assert np.max(run.log["PV_m"]) == 0.5
    assert np.min(run.log["PV_m"]) == -0.5
    wt = 2 * np.pi / 10.0 * tau

    def beyond(t):  # analytic: a lag from rest behind sin(w t)
        transient = wt * np.exp(-t / tau) if tau > 0 else 0.0
        angle = 2 * np.pi * t / 10.0
        return abs((np.sin(angle) - wt * np.cos(angle) + transient) / (1 + wt**2)) - 0.5

    t = np.linspace(0.0, 10.0, 1001)
    changes = np.flatnonzero(np.diff(np.sign(beyond(t))))
    assert [e.t for e in run.events] == pytest.approx([brentq(beyond, t[i], t[i + 1]) for i in changes], abs=2e-5)
    assert [e.after for e in run.events] == ["at high limit", "free", "at low limit", "free"]


def test_python_control_sees_the_lag():
    t = np.linspace(0.0, 20.0, 201)
    response = ct.input_output_response(Sensor(tau=4.0), t, np.ones_like(t), solve_ivp_kwargs={"rtol": 1e-8})
    np.testing.assert_allclose(np.ravel(response.outputs), 1.0 - np.exp(-t / 4.0), atol=1e-6)


def test_a_lagged_sensor_breaks_algebraic_loops_and_keeps_its_lag():
    assert Sensor().kernels.feeds
    assert not Sensor(tau=1.0).kernels.feeds
    with pytest.raises(BlockError, match=r"tau = 0.0.*built with a lag"):
        Sensor(tau=1.0).with_params(tau=0.0)
    late = Sensor().with_params(tau=4.0)
    run = drive_at(late, [4.0], PV=1.0)
    assert run.log["PV_m"][0] == pytest.approx(1.0 - math.exp(-1.0), abs=1e-5)


@pytest.mark.parametrize("tau", [0.2, 1.0, 6.0, 300.0])
def test_a_sampled_lag_trails_a_straight_line_by_tau_at_every_sample(tau):
    run = drive_at(SampledSensor(1.0, tau=tau, start=2.0, factor=1.2), np.arange(60.0), PV=Ramp("PV", 0.5, before=2.0))
    t = run.log.t  # analytic: of dx/dt = (1.2 (2 + t / 2) - x) / tau from rest
    np.testing.assert_allclose(run.log["PV_m"], 2.4 + 0.6 * (t - tau * (1.0 - np.exp(-t / tau))), atol=1e-11)


def test_a_sampled_lag_has_the_phase_of_the_continuous_one_and_is_not_half_a_scan_early():
    w, tau = 2 * np.pi / 40.0, 6.0
    t = 100.0 * tau + np.arange(40.0)
    seen = drive_at(SampledSensor(1.0, tau=tau), t, PV=Sine("PV", 1.0, 40.0)).log["PV_m"]
    pole = 1.0 / (1.0 + 1j * w * tau)  # analytic
    np.testing.assert_allclose(seen, np.imag(pole * np.exp(1j * w * t)), atol=(w * 1.0) ** 2 / 12.0)


def test_a_sampled_lag_forgets_a_start_elsewhere_with_its_time_constant():
    seen = drive(SampledSensor(0.5, tau=4.0), 20.0, every=0.5, PV=3.0).log["PV_m"]
    np.testing.assert_allclose((3.0 - seen[1:]) / (3.0 - seen[:-1]), math.exp(-0.5 / 4.0), rtol=1e-9)  # analytic
    assert 0.0 < seen[0] < 3.0 * (1.0 - math.exp(-0.5 / 4.0))  # PV has been on its way for one period, not there


def test_sampled_sensor_holds_between_samples():
    run = drive_at(SampledSensor(1.0), [1.0, 1.9, 2.0, 2.9], PV=Ramp("PV", 1.0))
    assert run.log["PV_m"].tolist() == [1.0, 1.0, 2.0, 2.0]


@given(PV=st.floats(-100.0, 100.0), step=st.floats(1e-3, 10.0))
def test_quantised_values_are_multiples_at_most_half_a_step_away(PV, step):
    value = read(SampledSensor(1.0, step=step), PV)
    assert abs(value - PV) <= step / 2 * (1 + 1e-9) + 1e-12
    assert value / step == pytest.approx(round(value / step), abs=1e-6)


@given(PV=st.floats(-1e6, 1e6), low=st.floats(-10.0, 0.0), width=st.floats(0.1, 10.0), step=st.floats(0.0, 3.0))
def test_readings_stay_within_the_limits(PV, low, width, step):
    high = low + width
    assert low <= read(Sensor(low=low, high=high), PV) <= high
    assert low <= read(SampledSensor(1.0, low=low, high=high, sd=0.5, step=step), PV) <= high


def test_noise_has_the_given_statistics():
    n = 20_000
    sensor = SampledSensor(0.5, sd=0.2, correlation_time=1.0, seed=5)
    y = drive_at(sensor, np.arange(n) * 0.5, PV=3.0).log["PV_m"] - 3.0
    effective = n * 0.5 / 2.0  # N dt / (2 T_c) independent values
    assert np.mean(y) == pytest.approx(0.0, abs=4 * 0.2 / math.sqrt(effective))
    assert np.std(y) == pytest.approx(0.2, rel=4 / math.sqrt(effective))
    r = np.mean(y[1:] * y[:-1]) / np.var(y)
    assert r == pytest.approx(math.exp(-0.5), abs=4 / math.sqrt(effective))


def test_two_sensors_with_different_seeds_are_independent_and_seeds_repeat():
    n = 5000
    sensors = [SampledSensor(1.0, sd=1.0, seed=s, name=f"s{s}", outputs=f"y{s}") for s in (1, 2)]
    twin = SampledSensor(1.0, sd=1.0, name="s3", outputs="y3").reseeded(1)
    log = simulate(wire([Constant("PV", 0.0), *sensors, twin]), float(n), times=np.arange(n)).log
    assert abs(np.corrcoef(log["y1"], log["y2"])[0, 1]) < 4 / math.sqrt(n)
    np.testing.assert_array_equal(log["y1"], log["y3"])


def test_fast_sampling_approaches_the_continuous_sensor():
    inputs = {"PV": Sine("PV", 1.0, 20.0)}
    law = {"tau": 3.0, "factor": 1.2, "bias": 0.1, "low": -0.8, "high": 0.9}
    times = np.arange(1, 40) * 1.0
    exact = drive_at(Sensor(**law), times, rtol=1e-9, **inputs).log["PV_m"]
    errors = [
        np.max(np.abs(drive_at(SampledSensor(dt, **law), times, **inputs).log["PV_m"] - exact))
        for dt in (1.0, 0.5, 0.25)
    ]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.15)
    assert np.log2(errors[1] / errors[2]) == pytest.approx(2.0, abs=0.15)


def test_smooth_twin_has_the_same_settings():
    sensor = SampledSensor(0.5, sd=1.0, step=0.1, tau=2.0, bias=0.3, factor=0.9, low=-5.0, high=9.0, drift=1e-3,
                           start=4.0, name="LT", inputs="L", outputs="L_m", units={"PV": "m"})  # fmt: skip
    twin = sensor.smooth()
    assert isinstance(twin, Sensor)
    assert (twin.name, twin.input_labels, twin.output_labels) == ("LT", ["L"], ["L_m"])
    assert (twin.units, twin.spans) == (sensor.units, {"PV_m": (-5.0, 9.0)})
    for key in ("tau", "bias", "factor", "low", "high", "drift"):
        assert twin.params[key] == sensor.params[key]
    assert twin.x0.tolist() == pytest.approx([0.9 * 4.0 + 0.3])


@given(PV=st.floats(-10.0, 10.0))
def test_reading_never_changes_the_sensor(PV):
    sensor = SampledSensor(1.0, sd=0.3, tau=2.0, step=0.01)
    memory, u = sensor.d0.copy(), np.array([PV])
    after = sensor.dynamics(0.0, memory, u)
    sensor.output(0.0, memory, u)
    np.testing.assert_array_equal(memory, sensor.d0)
    assert u.tolist() == [PV]
    assert np.any(after != memory)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Sensor(tau=-1.0), ["sensor: tau = -1.0", "not negative"]),
        (lambda: Sensor(low=2.0, high=1.0), ["low = 2.0", "below high = 1.0"]),
        (lambda: Sensor(bias=math.nan), ["bias = nan", "finite"]),
        (lambda: SampledSensor(0.0), ["dt = 0.0", "positive"]),
        (lambda: SampledSensor(1.0, sd=-0.1), ["sd = -0.1", "negative"]),
        (lambda: SampledSensor(1.0, step=-0.1), ["step = -0.1", "0 for none"]),
        (lambda: SampledSensor(1.0, inputs={"P": "L"}), ["no input 'P'", "did you mean 'PV'"]),
    ],
)
def test_misuse_is_refused_with_value_rule_and_remedy(refuses, make, words):
    refuses(make, words)

"""What digits tell: levels that the log has rounded again, scans of a coarse OP, limits; and the marks of noise."""

import math

import numpy as np
import pytest
from stickslip.blocks import Equations, FirstOrder, IdealValve, Noise, SampledPI, SampledSensor, Saturation, Square, Sum
from stickslip.cases.models import ideal_flow
from stickslip.diagram import ensemble, simulate, wire
from stickslip.gap import diagnose
from stickslip.gap.diagnosis import held_against
from stickslip.gap.effects import effect
from stickslip.gap.fits.digits import straightened
from stickslip.gap.fits.scans import read_off
from stickslip.gap.insertion.straightness import lined, sloping
from stickslip.gap.records.record import spacing
from stickslip.logs import Log
from stickslip.logs.dirt import swinging_door

from benchmarks.gap.generator import record


def made(setting, effects=(), severity="typical", seed=30, hours=0.5, **more):
    """Return a log of the benchmark's own program."""
    signals = record(setting, effects, severity, seed, hours=hours, **more).signals
    return Log(signals["time"], {s: signals[s] for s in ("SP", "PV", "OP")})


@pytest.mark.parametrize("step", [0.0217, 0.05237])
def test_levels_are_found_under_the_rounding_of_the_log(step):
    levels = step * np.random.default_rng(1).integers(round(1.0 / step), round(1.9 / step), 5000)
    assert spacing(np.round(levels, 3)) == pytest.approx(step, rel=1e-3)


@pytest.mark.parametrize("period", [1.8, 6.7])
def test_scans_are_read_off_though_a_coarse_output_does_not_show_all(period):
    t = np.arange(2000.0)
    held = np.random.default_rng(2).integers(0, 6, 2000)[(t // period).astype(int)]
    assert np.mean(np.diff(np.random.default_rng(2).integers(0, 6, 2000)) == 0) > 0.1  # scans that do not show
    assert read_off(t, held.astype(float))[0][0] == pytest.approx(period, rel=1e-6)


def test_a_coarse_sensor_is_told_from_a_coarse_log():
    one = [effect("quantisation"), effect("sensor_bias")]
    (cause,) = diagnose(ideal_flow(), made("ideal", ("quantisation",), "gross"), catalogue=one, limits=False).causes
    assert cause.effect == "quantisation"
    plain = made("ideal")
    step = cause.parameters["step"].value
    historian = Log(plain.t, {"SP": plain["SP"], "OP": plain["OP"], "PV": np.round(plain["PV"] / step) * step})
    assert all(
        c.effect != "quantisation" for c in diagnose(ideal_flow(), historian, catalogue=one, limits=False).causes
    )


def test_a_coarse_sensor_of_a_slow_level_is_told_from_a_coarse_log():
    # steps six times as large as the noise are no noise: runs with such a sensor say what its fit may leave
    def rate(L, MV, q_in):
        return (q_in - 0.0149 * MV / 100.0 * math.sqrt(max(L + 0.3, 0.0))) / (math.pi * (0.3 + 0.35 * L) ** 2)

    blocks = [
        SampledPI(60.0, 400.0, dt=2.0, low=0.0, high=100.0, action="direct", start_op=50.0, name="LC"), IdealValve(),
        Noise("q_in", sd=0.0008, dt=10.0, correlation_time=1200.0, mean=0.01, name="feed"),
        Equations("vessel", der=rate, states={"L": 1.5}, inputs=["MV", "q_in"], outputs="L"),
        SampledSensor(2.0, sd=0.004, start=1.5, name="LT", inputs="L", outputs="PV"),
    ]  # fmt: skip
    model, one = wire(blocks, inputs=["SP"]), [effect("quantisation"), effect("sensor_bias")]
    coarse = effect("quantisation").insert(model, "LT", step=0.025)
    seen, fine = (simulate(d, 9000.0, every=5.0, inputs={"SP": 1.5}).log for d in (coarse, model))
    digits = {s: np.array([float(f"{v:.6g}") for v in seen[s]]) for s in ("SP", "PV", "OP")}
    (cause,) = diagnose(model, Log(seen.t, digits), catalogue=one, limits=False).causes
    assert (cause.effect, cause.parameters["step"].value) == ("quantisation", 0.025)
    historian = Log(fine.t, {"SP": fine["SP"], "OP": fine["OP"], "PV": np.round(fine["PV"] / 0.025) * 0.025})
    report = diagnose(model, historian, catalogue=one, limits=False)
    assert all(c.effect != "quantisation" for c in report.causes), "the controller has seen all digits"


def test_a_coarse_log_that_was_compressed_is_told():
    compressed, plain = made("coarse", ("compression",), "gross", hours=1.0), made("coarse", hours=1.0)
    assert lined(compressed["PV"], 1e-3) > sloping(compressed["PV"], 1e-3) > sloping(plain["PV"], 1e-3) + 0.05
    one = [effect("compression"), effect("sensor_bias")]
    (cause,) = diagnose(ideal_flow(), compressed, catalogue=one, limits=False).causes
    assert cause.effect == "compression"
    assert not diagnose(ideal_flow(), plain, catalogue=one, limits=False).gap


def heater():
    """Return a loop whose measurement has a tag of its own, and whose OP comes from a limit behind the controller."""
    return wire(
        [
            SampledPI(2.0, 60.0, dt=4.0, low=-20.0, high=120.0, start_op=50.0, inputs=["SP", "TI"], outputs="asked"),
            Saturation("OP", "asked", 0.0, 100.0),
            IdealValve(spans={"OP": (0.0, 100.0), "MV": (0.0, 100.0)}),
            Noise("load", sd=3.0, dt=4.0, correlation_time=200.0, name="fuel"),
            Sum("heat", {"MV": 1.0, "load": 1.0}),
            FirstOrder(0.4, 60.0, start=20.0, inputs="heat", outputs="T"),
            SampledSensor(4.0, sd=0.1, start=20.0, inputs="T", outputs="TI"),
        ],
        inputs=["SP"],
    )


def test_a_compression_has_its_size_whatever_the_tag_is_called():
    """The size was the whole range of a tag that is not called PV."""
    run = simulate(wire([Square("SP", 4.0, 2000.0, mean=20.0), *heater().blocks]), 12000.0, every=8.0)
    assert run.ok
    log = Log(run.log.t, {"SP": run.log["SP"], "OP": run.log["OP"].round(2), "TI": run.log["TI"].round(2)})
    (cause,) = diagnose(
        heater(), swinging_door(log, 0.5, ["TI"]), catalogue=[effect("compression")], limits=False
    ).causes
    assert cause.effect == "compression"
    assert cause.parameters["deviation"].value == pytest.approx(0.5, rel=0.3)


def test_what_a_valve_takes_is_no_measurement_that_a_historian_straightens():
    """An OP behind a selector was compressed at .95, for the controller was calm."""
    run = simulate(wire([Square("SP", 4.0, 2000.0, mean=20.0), *heater().blocks]), 8000.0, every=8.0)
    assert run.ok
    log = swinging_door(Log(run.log.t, {"SP": run.log["SP"], "OP": run.log["OP"], "TI": run.log["TI"]}), 2.0, ["OP"])
    assert sloping(log["OP"], 0.0) > 0.5
    assert straightened(held_against(heater(), log), 0) == ""


@pytest.mark.parametrize(("outside", "severity"), [
    ("", "gross"), ("multiplicative_noise", "gross"), ("bursting_noise", "gross"),
])  # fmt: skip
def test_noise_that_grows_with_the_signal_or_comes_in_bursts_is_not_more_noise_of_a_sensor(outside, severity):
    log = made("ideal", () if outside else ("sensor_noise",), severity, hours=2.0, outside=outside)
    report = diagnose(ideal_flow(), log, catalogue=[effect("sensor_noise"), effect("sensor_drift")], limits=False)
    assert report.gap and (report.causes[0].effect == "sensor_noise") is not bool(outside)


def test_a_limit_at_which_the_record_begins_is_found():
    t = np.arange(1801.0)
    SP = np.select([t < 300, t < 900, t < 1200], [1.8, 1.3, 1.75], 1.2)
    limited = effect("controller_limits").insert(ideal_flow(rest=1.8), "controller", high=55.0)
    many = ensemble(
        limited, 1800.0, times=t, inputs=Log(t, {"SP": SP}), seeds=[3], signals=["OP", "PV"], progress=False
    )
    log = Log(t, {"SP": SP, **{s: many.values[s][0].round(6) for s in ("OP", "PV")}})
    assert (log["OP"][:50] == 0.55).all()
    (cause,) = diagnose(ideal_flow(), log, catalogue=[effect("controller_limits")], limits=False).causes
    assert cause.effect == "controller_limits" and cause.parameters["high"].value == pytest.approx(55.0, abs=1e-3)


def test_the_trough_of_a_limit_that_no_signal_shows_is_found():
    log = made("coarse", ("valve_saturation",), "gross", seed=10, hours=2.0)
    (cause,) = diagnose(ideal_flow(), log, catalogue=[effect("valve_saturation")], limits=False).causes
    # the benchmark's own value; PV, rounded to 0.001 with noise of 0.004 and a gain of 3, tells it to about 0.02 %
    true = record("coarse", ("valve_saturation",), "gross", 10).effects["valve_saturation"]["high"]
    assert cause.parameters["high"].value == pytest.approx(true, abs=0.05)

"""The README's own valve, known from OP and PV: friction of other laws, in logs with noise and without."""

import numpy as np
import pytest
from stickslip.blocks import PI, FirstOrder, IdealValve, QuasiStaticStem, SampledSensor, Square, StickSlip, StribeckStem
from stickslip.diagram import simulate, wire
from stickslip.gap.diagnosis import diagnose, held_against
from stickslip.gap.effects import effect
from stickslip.gap.null_model.null_model import FORETOLD, MECHANICAL
from stickslip.logs import Log

F_S, F_C, SPRING = 2250.0, 1250.0, 52500.0  # [N], [N], [N/travel]: StickSlip's own
S, J = 100.0 * (F_S + F_C) / SPRING, 100.0 * (F_S - F_C) / SPRING  # analytic [% OP]: 6.67 and 1.90
ONES = [effect(name) for name in ("stiction", "deadband", "process_gain", "process_time_constant", "sensor_lag")]
STEMS = {
    "StickSlip": lambda: StickSlip(F_S, F_C, start=0.5),
    "StribeckStem": lambda: StribeckStem(F_S, F_C, start=0.5),
    "QuasiStaticStem": lambda: QuasiStaticStem(S / 100.0, J / 100.0, start=0.5),
}


def loop(*valve, noise=0.0):
    return wire(
        [
            Square("SP", 0.15, 600.0, mean=1.5),
            PI(K_p=0.4, T_i=10.0, start_op=0.5),
            *valve,
            FirstOrder(K=3.0, tau=10.0, start=1.5, inputs="MV", outputs="y"),
            SampledSensor(1.0, sd=noise, start=1.5, seed=1, inputs="y", outputs="PV"),
        ]
    )


def log_of(*valve, noise=0.0, signals=(), duration=2400.0):
    run = simulate(loop(*valve, noise=noise), duration, every=1.0)
    return Log(run.log.t, {s: np.asarray(run.log[s]) for s in ("SP", "OP", "PV", *signals)})


def told(log, noise=0.0):
    """Name, place and values of the first cause."""
    cause = diagnose(loop(IdealValve(), noise=noise), log, catalogue=ONES).causes[0]
    return cause.effect, cause.place, {key: one.value for key, one in cause.parameters.items()}


@pytest.mark.parametrize("stem", STEMS)
def test_a_log_without_noise_names_the_stem(stem):
    # Stribeck's stem shows its J more seldom
    log = log_of(STEMS[stem](), duration=3600.0 if stem == "StribeckStem" else 2400.0)
    name, place, values = told(log)
    assert (name, place) == ("stiction", "valve")
    assert values["S"] == pytest.approx(S, rel=0.05) and values["J"] == pytest.approx(J, rel=0.1)


def test_a_rounded_log_without_noise_is_compressed_by_no_historian():
    # PV is straight within its rounding wherever it moves slowly: it was a compression at .95
    log = log_of(StickSlip(F_S, F_C, start=0.5))
    known = [*ONES, effect("compression")]
    rounded = Log(log.t, {s: np.round(log[s], 4) for s in log.names})
    (cause,) = diagnose(loop(IdealValve()), rounded, catalogue=known, limits=False).causes
    assert (cause.effect, cause.place) == ("stiction", "valve")
    assert cause.parameters["S"].value == pytest.approx(S, rel=0.05)


def test_a_log_with_noise_names_it_too():
    name, place, values = told(log_of(StickSlip(F_S, F_C, start=0.5), noise=0.004), 0.004)
    assert (name, place) == ("stiction", "valve")
    assert values["S"] == pytest.approx(S, rel=0.05) and values["J"] == pytest.approx(J, rel=0.1)


def test_a_logged_stem_is_no_play_as_wide_as_its_breakaway():
    name, place, values = told(log_of(StickSlip(F_S, F_C, start=0.5), signals=["MV"]))
    assert (name, place) == ("stiction", "valve")
    assert values["S"] == pytest.approx(S, rel=0.05) and values["J"] == pytest.approx(J, rel=0.1)


def test_a_log_of_the_model_itself_without_noise_has_no_gap():
    report = diagnose(loop(IdealValve()), log_of(IdealValve()), catalogue=ONES)
    assert not report.gap and not report.causes


@pytest.mark.parametrize("signals", [("SP", "OP", "PV"), ("SP", "OP", "PV", "MV")])
def test_nor_has_that_of_a_continuous_loop(signals):
    # an integrator that steps elsewhere errs by 3e-5 of OP behind each switch of SP: it was an unknown gap
    model = wire([Square("SP", 0.05, 600.0, mean=0.5), PI(0.4, 10.0), IdealValve(), FirstOrder(3.0, 10.0)])
    log = simulate(model, 1800.0, every=1.0).log
    report = diagnose(model, Log(log.t, {s: log[s] for s in signals}), catalogue=ONES)
    assert not report.gap and not report.causes
    other = model.with_params({"process.K": 3.02})
    assert diagnose(other, Log(log.t, {s: log[s] for s in signals}), catalogue=ONES, limits=False).gap


def test_only_what_a_valve_drives_is_judged_by_laws_of_friction():
    log = log_of(IdealValve(), signals=["MV"])
    null_model = held_against(loop(IdealValve()), log).null_model
    stem, driven = MECHANICAL * np.ptp(log["MV"]), FORETOLD * np.ptp(log["PV"])
    assert null_model.L.diagonal()[1:] == pytest.approx(
        [stem, driven], rel=0.42
    )  # to the nearest power of two: sqrt(2)
    assert null_model.L[0, 0] < 1e-6 * np.ptp(log["OP"])  # a controller is known to the last digit


def test_a_model_with_little_noise_is_judged_by_that():
    log = log_of(IdealValve(), noise=0.0002)
    null_model = held_against(loop(IdealValve(), noise=0.0002), log).null_model
    assert null_model.L[1, 1] == pytest.approx(
        0.0002, rel=0.05
    )  # analytic: the model's own noise, not what friction blurs

"""What digits tell: levels that the log has rounded again, scans of a coarse OP, limits; and the marks of noise."""

import numpy as np
import pytest
from stickslip.cases.models import ideal_flow
from stickslip.diagram import ensemble
from stickslip.gap.diagnosis import prepared
from stickslip.gap.effects import effect
from stickslip.gap.explanations.candidates import candidates, ranked, way
from stickslip.gap.fits.adequacy import adequate, stands
from stickslip.gap.fits.noise import is_noise
from stickslip.gap.fits.scans import read_off
from stickslip.gap.fits.texture import fitted_compression, in_loop
from stickslip.gap.insertion.straightness import lined, sloping
from stickslip.gap.records.record import spacing
from stickslip.logs import Log

from benchmarks.gap.generator import record


def read(setting, effects=(), severity="typical", seed=30, hours=0.5, **more):
    """Return what a record of the benchmark's own program poses."""
    signals = record(setting, effects, severity, seed, hours=hours, **more).signals
    return prepared(ideal_flow(), Log(signals["time"], {s: signals[s] for s in ("SP", "PV", "OP")}))


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


@pytest.mark.parametrize("setting", ["ideal", "coarse"])
def test_a_coarse_sensor_is_told_from_a_coarse_log(setting):
    problem = read(setting, ("quantisation",), "gross")
    assert problem.record.lattices == ("PV",)
    values = problem.record.log["PV"]
    rounded = Log(problem.record.log.t, {**{s: problem.record.log[s] for s in ("SP", "OP")}, "PV": values})
    plain = read(setting)
    step = problem.record.lattice("PV")
    log = plain.record.log
    historian = Log(log.t, {"SP": log["SP"], "OP": log["OP"], "PV": np.round(log["PV"] / step) * step})
    assert prepared(ideal_flow(), rounded).record.lattices == ("PV",)
    assert prepared(ideal_flow(), historian).record.lattices == () == in_loop(plain, 1)


def test_a_coarse_log_that_was_compressed_is_told():
    problem = read("coarse", ("compression",), "gross", hours=1.0)
    plain = read("coarse", hours=1.0)
    PV = problem.record.log["PV"]
    assert lined(PV, 1e-3) > sloping(PV, 1e-3) > sloping(plain.record.log["PV"], 1e-3) + 0.05
    found = fitted_compression(problem, effect("compression"), "historian")
    assert found is not None and found[1]
    assert fitted_compression(plain, effect("compression"), "historian") is None


def test_noise_that_grows_with_the_signal_is_not_more_noise_of_a_sensor():
    def found(problem):
        (candidate,) = candidates(problem, problem.quiet, [effect("sensor_noise")])
        return way(candidate)(candidate)

    constant = found(read("ideal", ("sensor_noise",), hours=2.0))
    growing = found(read("ideal", hours=2.0, outside="multiplicative_noise"))
    slow = found(read("ideal", ("sensor_drift",)))
    assert is_noise(constant) and adequate(constant.candidate.problem, constant)
    assert not is_noise(growing) and not adequate(growing.candidate.problem, growing)
    assert not is_noise(slow)


@pytest.mark.parametrize("severity", ["just visible", "gross"])
def test_a_little_noise_is_told_from_noise_that_grows_with_the_level_by_which_is_likelier(severity):
    # of two laws of the same size the level of a little noise shows 2 to 4 standard deviations; no fixed limit tells
    def found(problem):
        (candidate,) = candidates(problem, problem.quiet, [effect("sensor_noise")])
        return way(candidate)(candidate)

    assert is_noise(found(read("ideal", ("sensor_noise",), severity, hours=2.0)))
    assert not is_noise(found(read("ideal", (), severity, hours=2.0, outside="multiplicative_noise")))
    assert not is_noise(found(read("ideal", (), severity, hours=2.0, outside="bursting_noise")))


def test_a_limit_at_which_the_record_begins_is_found():
    t = np.arange(1801.0)
    SP = np.select([t < 300, t < 900, t < 1200], [1.8, 1.3, 1.75], 1.2)
    limited = effect("controller_limits").insert(ideal_flow(rest=1.8), "controller", high=55.0)
    many = ensemble(
        limited, 1800.0, times=t, inputs=Log(t, {"SP": SP}), seeds=[3], signals=["OP", "PV"], progress=False
    )
    log = Log(t, {"SP": SP, **{s: many.values[s][0].round(6) for s in ("OP", "PV")}})
    assert (log["OP"][:50] == 0.55).all()
    problem = prepared(ideal_flow(), log)
    best = ranked(candidates(problem, problem.quiet, [effect("controller_limits")]), progress=False)[0]
    assert best.values["high"] == pytest.approx(55.0, abs=1e-3) and stands(problem, best) and adequate(problem, best)


def test_the_trough_of_a_limit_that_no_signal_shows_is_found():
    problem = read("coarse", ("valve_saturation",), "gross", seed=10, hours=2.0)
    (candidate,) = candidates(problem, problem.quiet, [effect("valve_saturation")])
    found = way(candidate)(candidate)
    # the benchmark's own value; PV, rounded to 0.001 with noise of 0.004 and a gain of 3, tells it to about 0.02 %
    true = record("coarse", ("valve_saturation",), "gross", 10).effects["valve_saturation"]["high"]
    assert found.values["high"] == pytest.approx(true, abs=0.05)

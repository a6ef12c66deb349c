"""Loops in sampled time against the engine, which shares no code with them."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from stickslip.calibration import LoopSpec
from stickslip.calibration.drawing import one
from stickslip.calibration.excitation import Excitation
from stickslip.calibration.loops import parameters
from stickslip.calibration.sampled import CONTROLLERS, LEAVES, VALVES, run
from stickslip.calibration.simulation import QUIET, by_engine, driver, in_scans
from stickslip.diagram import drive

SCANS = 400
PROCESSES = ("one_lag", "two_lags", "integrating")


def column(spec: LoopSpec, **more: float) -> dict[str, float]:
    """Return the parameters of a loop as both simulators get them, a scan of a sixteenth of its natural period."""
    own = in_scans(spec, spec.natural / 16.0)
    return {**parameters(own, own.valve, True), **driver(own, 15.0, SCANS), **QUIET, **more}


def both(specs: list[LoopSpec], structure: tuple[str, str, str], **more: float) -> tuple[dict, dict]:
    """Return the signals of both, at the middle of each scan."""
    columns, seeds = [column(spec, **more) for spec in specs], [spec.seed for spec in specs]
    times = np.arange(SCANS - 1) + 0.5
    return run(structure, SCANS, columns, seeds, times), dict(by_engine(structure, SCANS, columns, seeds, times, 1))


def drawn(group: str, structure: tuple[str, str, str], count: int, **more: object) -> list[LoopSpec]:
    """Return loops of a group with the process and controller asked for, wherever the draw has them."""
    found: list[LoopSpec] = []
    k = 0
    while len(found) < count:
        spec = one(group, (9, k))
        k += 1
        if (spec.process, spec.controller) == structure[1:]:
            found.append(replace(spec, valve=structure[0], driver_wander=0.0, driver_swell=0.0, **more))  # type: ignore[arg-type]
    return found


@pytest.mark.parametrize("valve", [valve for valve in VALVES if valve != "creeping"])
def test_a_sine_through_a_sticky_valve_is_what_the_engine_gives(valve: str) -> None:
    structure = (valve, "two_lags", "pi")
    specs = drawn("excited", structure, 3, driver="sine", driver_on="load", S=3.0, J=1.5)
    specs = [replace(spec, driver_time=5.0 * spec.natural) for spec in specs]
    fast, slow = both(specs, structure)
    assert np.ptp(slow["MV"], axis=1).min() > 1.0
    for name in ("OP", "MV", "PV_m"):
        apart = np.median(np.abs(fast[name] - slow[name]), axis=1) / np.ptp(slow[name], axis=1)
        assert apart.max() < (0.02 if valve == "stick_slip" else 1e-4), name


@pytest.mark.parametrize("controller", CONTROLLERS)
@pytest.mark.parametrize("process", PROCESSES)
def test_every_process_and_controller_is_what_the_engine_gives(process: str, controller: str) -> None:
    structure = ("chen", process, controller)
    specs = drawn("external_square", structure, 2)
    fast, slow = both(specs, structure)
    # the engine's continuous PID moves OP within a scan, where it is logged here, that of sampled time does not; each
    # turn of the square wave kicks its derivative
    for name, loose in (("OP", 0.25), ("PV_m", 0.15)):
        limit = loose if controller == "pid_weighted" else 1e-3
        apart = np.sqrt(np.mean((fast[name] - slow[name]) ** 2, axis=1)) / np.std(slow[name], axis=1)
        assert apart.max() < limit, name


def test_a_second_wave_is_what_the_engine_gives() -> None:
    structure = ("chen", "two_lags", "pi")
    specs = drawn("external_sine", structure, 2, driver_second=0.4, driver_second_size=0.8)
    fast, slow = both(specs, structure)
    alone = both([replace(spec, driver_second=0.0) for spec in specs], structure)[0]
    for name in ("OP", "PV_m"):
        spread = np.std(slow[name], axis=1)
        assert (np.sqrt(np.mean((fast[name] - slow[name]) ** 2, axis=1)) / spread).max() < 1e-3, name
        assert (np.std(fast[name] - alone[name], axis=1) / spread).min() > 0.05, name


def test_waves_differ_in_size_as_asked() -> None:
    """Analytic: ln of the size has the standard deviation asked for, and over a period it forgets all but 1/e."""
    structure, period = ("chen", "one_lag", "pi"), 20.0
    own = column(drawn("external_sine", structure, 1)[0])
    own |= {"load.amplitude": 2.0, "load.period": period, "load.second_size": 0.0, "controller.K_p": 1e-9}
    own |= {"process.K": 1.0, "process.tau": 1e-3, "process.theta": 0.0, "load.swell": 0.3}
    times = np.arange(40_000.0)
    by_run = run(structure, 40_000, [own], [1], times)["PV_m"][0][1:]
    by_block = drive(Excitation("d", 1.0, amplitude=2.0, period=period, swell=0.3, seed=5), 4e4, every=1.0).log["d"]
    for y in (by_run, np.asarray(by_block)[:-2]):
        top = np.log(np.abs(y[int(period / 4) :: int(period / 2)]) / 2.0)  # where the sine is 1 or -1
        assert top.std() == pytest.approx(0.3, rel=0.1)
        assert np.corrcoef(top[:-2], top[2:])[0, 1] == pytest.approx(np.exp(-1.0), abs=0.08)


def test_noise_and_walk_have_their_sizes() -> None:
    structure = ("chen", "one_lag", "pi")
    spec = drawn("external_sine", structure, 1)[0]
    own = column(spec) | {"sensor.sd": 0.7, "sensor.correlation_time": 5.0, "load.amplitude": 0.0}
    own |= {"controller.K_p": 1e-9}
    times = np.arange(20_000.0)
    noise = run(structure, 20_000, [own] * 2, [1, 2], times)["PV_m"]
    assert noise.std(axis=1) == pytest.approx([0.7, 0.7], rel=0.06)
    assert np.corrcoef(noise[0, :-5], noise[0, 5:])[0, 1] == pytest.approx(np.exp(-1.0), abs=0.06)  # analytic
    assert abs(np.corrcoef(noise)[0, 1]) < 0.1  # seeds differ
    again = run(structure, 20_000, [own], [1], times)["PV_m"][0]
    assert np.array_equal(again, noise[0])
    gain = abs(own["process.K"])
    walk = run(structure, 2000, [own | {"sensor.sd": 0.0, "load.walk": 0.1}] * 200, range(200), np.array([1999.0]))
    # analytic: a walk of 0.1 a scan is 0.1 sqrt(2000) = 4.5 wide after 2,000 scans; the lag takes little of it
    assert walk["PV_m"].std() / gain == pytest.approx(4.5, rel=0.2)


def test_periods_of_a_wave_differ_by_as_much_as_is_asked() -> None:
    structure = ("chen", "one_lag", "pi")
    own = column(drawn("external_sine", structure, 1)[0]) | {"load.amplitude": 0.0, "controller.K_p": 1e-9}
    own |= {"SP.shape": 1.0, "SP.amplitude": 1.0, "SP.period": 40.0, "SP.wander": 0.05}
    for simulated, scans, off in ((run, 80_000, 0.08), (partial(by_engine, workers=1), 12_000, 0.15)):
        sp = simulated(structure, scans, [own], [3], np.arange(scans - 1) + 0.5)["SP"][0]
        periods = np.diff(np.flatnonzero((sp[1:] > 0.0) & (sp[:-1] < 0.0)))
        # analytic: a phase that walks by 5 % a period, and edges that are seen at whole scans of 2.5 % of a period
        spread = np.hypot(0.05, 0.025 / np.sqrt(6.0))
        assert periods.std() / periods.mean() == pytest.approx(spread, rel=off)
        assert periods.mean() == pytest.approx(40.0, rel=0.05)


def creeping(load: dict[str, float], scans: int = SCANS, **valve: float) -> dict[str, np.ndarray]:
    """Return OP and MV of a creeping valve of S = 4, J = 2 whose OP follows the set point alone."""
    spec = drawn("excited", ("creeping", "one_lag", "pi"), 1, S=4.0, J=2.0)[0]
    own = column(spec) | {f"SP.{key}": value for key, value in load.items()} | {"F.w_MV": 0.0, "load.amplitude": 0.0}
    own |= {"load.sd": 0.0, "load.move": 0.0, "controller.K_p": 1.0, "controller.T_i": 1e12, "controller.action": 1.0}
    own |= {f"valve.{key}": value for key, value in ({"give": 0.0, "uneven": 0.0, "lag": 0.0} | valve).items()}
    both = run(("creeping", "one_lag", "pi"), scans, [own], [3], np.arange(scans - 1) + 0.5)
    chen = run(("chen", "one_lag", "pi"), scans, [own], [3], np.arange(scans - 1) + 0.5)
    return {"OP": both["OP"][0], "MV": both["MV"][0], "chen": chen["MV"][0]}


SINE = {"shape": 0.0, "amplitude": 6.0, "period": 97.0}


def test_a_creeping_valve_that_does_not_give_is_that_of_chen() -> None:
    signals = creeping(SINE)
    assert (
        np.ptp(signals["MV"]) > 5.0 and np.abs(signals["MV"] - signals["chen"]).max() < 1e-12
    )  # analytic: the same balance


def test_a_creeping_valve_gives_as_dahl_says_until_it_breaks_away() -> None:
    give, force = 0.1, 3.0  # force to break away (S + J)/2
    signals = creeping({"slope": 0.02}, give=give)
    stuck = np.arange(len(signals["OP"])) < np.argmax(np.diff(signals["MV"]) > 1.0)
    held = signals["OP"] - signals["MV"]
    # analytic: MV = -give ln(1 - F/F_max) with F_max = force / LEAVES, on a load that only grows
    expected = -give * np.log(1.0 - held[stuck] * LEAVES / force)
    assert signals["MV"][stuck] == pytest.approx(expected, abs=0.01 * give)
    assert held[stuck].max() == pytest.approx(force, abs=0.03)
    assert np.diff(signals["MV"]).max() == pytest.approx(2.0, abs=0.05)  # it slips by J


def test_the_jumps_of_a_creeping_valve_differ_as_asked() -> None:
    signals = creeping(SINE, scans=30_000, uneven=0.2)
    jumps = np.abs(np.diff(signals["MV"]))
    slips = jumps[jumps > 0.7]
    assert len(slips) > 400
    assert np.std(np.log(slips)) == pytest.approx(0.2, abs=0.04)  # what OP moves within a scan is small
    assert np.median(slips) == pytest.approx(2.0, rel=0.15)

"""Foreign plants keep their own balances, share nothing with the house, and do what their data sheets say."""

import ast
import importlib
import re
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from stickslip.gap.effects import CATALOGUE

from benchmarks.foreign import instruments
from benchmarks.foreign import record as records
from benchmarks.foreign.historian import filtered, late, swinging_door
from benchmarks.foreign.parts import PI, Feed, Sensor, Valve
from benchmarks.foreign.record import NAMES, UNSEEN, plant, record
from benchmarks.foreign.trial import Run

ALL = (*NAMES, *UNSEEN)
FOLDER = Path(records.__file__).parent
TOLD_BY_THE_HOUSE = ("answer", "command", "scoring", "trial")  # they ask and score; no plant knows of them


def _ph_ions(ph: float, buffer: float) -> float:
    h, k = 10.0**-ph, 10.0**-6.35
    return buffer * k / (k + h) + 1e-14 / h - h


def _neutral(ph: float) -> float:
    op = 0.5
    for _ in range(60):  # the buffer is thinned by the base
        flow = 2.4 * op
        ions = _ph_ions(ph, 6.0 * 0.005 / (6.0 + flow))
        op = 6.0 * (ions + 0.02) / (0.1 - ions) / 2.4
    return op


def _split(temperature: float) -> float:
    needs = 0.5 * (temperature - 25.0) - 20.0
    return 0.5 + needs / 180.0 if needs > 0.0 else 0.5 + needs / (2.4 * (temperature - 15.0))


def _exotherm(kelvin: float) -> float:
    k = np.exp(8000.0 * (1.0 / 350.0 - 1.0 / kelvin))
    return (340.0 - kelvin + 50.0 * k / (1.0 + k)) / (0.6 * (kelvin - 290.0))


def _sagging(flow: float, full: float, empty: float) -> float:
    return flow / (full * np.sqrt(1.0 - (flow / empty) ** 2))


def _header(bar: float) -> float:
    condenses = 0.03 * (100.0 * bar**0.25 - 60.0)  # the wall is a third of the way from steam to water
    return condenses / (5.0 * np.sqrt(1.0 - max(bar / 6.0 - 1.0, 0.0) ** 2))


def _dryer(moisture: float) -> float:
    return (40.0 + 50.0 * ((40.0 / moisture) ** (1.0 / 3.0) - 1.0) - 25.0) / 130.0


def _pack(bar: float) -> float:
    return (20.0 / np.sqrt(3600.0 - bar**2 - 400.0)) ** 0.5  # 12 kg/s are 0.6 x 20


def _quench(celsius: float) -> float:
    gone = min((celsius - 60.0) / 200.0, 1.0)
    return 1.0 - (400.0 - celsius) / (450.0 * (1.0 - (1.0 - gone) ** 1.5))


# analytic: OP at rest by the data sheet, from (SP, OP) tags; shares of full OP
REST = {
    "heat_exchanger": ("SP", "OP", 0.01, lambda y: (y - 20.0) / 80.0),
    "gas_pressure": ("SP", "OP", 1.0, lambda y: 3.0 / (0.6 * y)),
    "pump_flow": ("SP", "OP", 0.01, lambda y: 1.0 + np.log(y / 20.0 / np.sqrt(45.0 - 0.002 * y * y)) / np.log(40.0)),
    "neutralisation": ("SP", "OP", 1.0, _neutral),
    "sqrt_tank": ("SP", "OP", 0.01, lambda y: 0.5 * np.sqrt(y)),
    "split_range": ("SP", "OP", 0.01, _split),
    "ratio_feedforward": ("SP", "OP", 1.0, lambda y: _sagging(y, 60.0, 90.0)),
    "cascade": ("SP_T", "OP", 1.0, lambda y: _sagging((y - 25.0) / 7.0, 10.0, 14.0)),
    "recycle": ("SP", "OP", 0.01, lambda y: (y - 11.0) / 8.0),
    "cone": ("SP", "OP", 0.01, lambda y: 2.0 / (3.0 * np.sqrt(y))),
    "batch_ramp": ("SP", "OP", 1.0, lambda y: (y - 20.0) / 6000.0 * 900.0 / (140.0 - y)),
    "exotherm": ("SP", "OP", 0.01, _exotherm),
    "drum_level": ("SP", "OP", 1.0, lambda y: 0.5 + 0.0 * y),
    "steam_header": ("SP", "OP", 0.01, _header),
    "belt_dryer": ("SP", "OP", 1.0, _dryer),
    "pipeline_pack": ("SP", "OP", 1.0, _pack),
    "quench": ("SP", "OP", 0.01, _quench),
}


def quiet(name: str, **changed: object) -> dict[str, np.ndarray]:
    """Return a record without noise and load, measured ones neither, and with other numbers of the plant."""
    of = plant(name)
    of = replace(of, loads=tuple(one._replace(sd=0.0) for one in of.loads), **changed)
    return records.signals_of(of, {}, seed=1, chance=1, noise_factor=0.0, load_factor=0.0)


def _longer(name: str) -> dict[str, object]:
    """Return hours and set points of a plant three times as long: where the rest comes late."""
    of = plant(name)
    return {"hours": 3.0 * of.hours, "set_points": tuple(one._replace(dwell=3.0 * one.dwell) for one in of.set_points)}


@pytest.mark.parametrize("name", REST)
def test_at_rest_op_is_what_the_balance_asks(name):
    sp, op, unit, needs = REST[name]
    log = quiet(name, **_longer(name)) if name == "belt_dryer" else quiet(name)
    moves = np.flatnonzero(np.diff(log[sp]) != 0.0)
    rests = moves[np.insert(np.diff(moves) > 5, 0, True)]  # the last rows before a move; a ramp moves at every row
    if name == "batch_ramp":
        rests = rests[:1]  # a hold of 25 min; later ones are reached by ramps that leave an error
    level = log[sp][rests]
    off = np.abs(unit * log[op][rests] - np.array([needs(y) for y in level]))
    # what the slow ones, with T_i of 250 and 500 s, have left of a move
    assert off.max() < {"exotherm": 3e-3, "drum_level": 2e-3}.get(name, 1e-4)
    assert len(rests) >= (1 if name == "batch_ramp" else 5)


def test_two_by_two_rests_where_both_gains_meet():
    log = quiet("two_by_two")
    before = np.flatnonzero(np.diff(log["SP1"]) + np.diff(log["SP2"]) != 0.0)[2]
    u = np.linalg.solve([[20.0, -12.0], [9.0, -18.0]], [log["SP1"][before] - 50.0, log["SP2"][before] - 90.0])
    # analytic
    assert log["OP1"][before] / 100.0 == pytest.approx(0.5 + u[0], abs=0.02)
    assert log["OP2"][before] / 100.0 == pytest.approx(0.5 + u[1], abs=0.02)


@pytest.mark.parametrize("name", ["pump_flow", "neutralisation", "recycle", "exotherm", *UNSEEN])
def test_half_the_step_gives_the_same_record(name):
    whole, half = quiet(name), quiet(name, dt=plant(name).dt / 2.0)
    sd = plant(name).parameters.sensor.sd
    # a set point moves within a step: rows of that instant may part by a scan
    parted = np.abs(whole["PV"] - half["PV"])
    assert np.median(parted) < 0.02 * sd and np.quantile(parted, 0.95) < 0.5 * sd


def test_no_plant_imports_the_house():
    for file in FOLDER.glob("*.py"):
        if file.stem in TOLD_BY_THE_HOUSE:
            continue
        for node in ast.walk(ast.parse(file.read_text())):
            names = [one.name for one in node.names] if isinstance(node, ast.Import) else []
            names += [node.module] if isinstance(node, ast.ImportFrom) and node.module else []
            for name in names:
                root = name.split(".")[0]
                outside = root in ("numpy", "numba") or root in sys.stdlib_module_names
                assert outside or name.startswith("benchmarks.foreign"), f"{file.name} imports {name}"


@pytest.mark.parametrize("name", ALL)
def test_a_data_sheet_says_what_the_plant_does(name):
    of, sheet = plant(name), importlib.import_module(f"benchmarks.foreign.{name}").__doc__
    assert float(re.search(r"a row\s+every ([\d.]+)\s+s", sheet)[1]) == of.row
    number, unit = re.search(r"s for ([\d.]+)\s+(h|min)", sheet).groups()
    assert float(number) / (60.0 if unit == "min" else 1.0) == pytest.approx(of.hours)
    log = sheet[sheet.index("\nLog") : sheet.index("\nSet points")]
    for tag in of.tags:
        assert re.search(rf"\b{tag}\b", log), f"{tag} is not in the sheet"
    blocks = re.sub(r"\s+", " ", sheet[sheet.index("\nBlocks") : sheet.index("\nController")])
    for what in (*of.effects.values(), *of.outside.values()):
        assert what.place == "historian" or re.search(rf"\b{what.place}\b", blocks), f"{what.place} is not in the sheet"
    for load in of.loads:
        assert f"{load.sd:g}" in sheet or f"{load.sd}" in sheet


def test_effects_have_names_of_the_catalogue_and_the_others_have_not():
    known = {one.name for one in CATALOGUE}
    for name in ALL:
        of = plant(name)
        assert set(of.effects) <= known and not set(of.outside) & known
        assert len(of.effects) >= 6 and len(of.outside) >= 2


def test_neutral_effects_leave_every_parameter_as_it_is():
    for name in ALL:
        of = plant(name)
        for effect, what in of.effects.items():
            if what.log or effect in ("valve_rate_limit", "valve_saturation", "controller_limits", "scan_time"):
                continue  # their neutral value is no number of theirs
            assert of.with_settings({k: v for k, v in what.of(0.0).items() if not k.endswith((".period", ".at"))}) == (
                of.parameters), (name, effect)  # fmt: skip


@pytest.mark.parametrize("name", UNSEEN)
def test_an_effect_of_no_size_leaves_the_record_as_it_is_and_a_seed_repeats_it(name):
    of, without = plant(name), record(name, seed=4).signals
    limits = ("valve_rate_limit", "valve_saturation", "controller_limits", "scan_time")  # no number is neutral
    for effect in ("none", *of.effects, *of.outside):
        if effect not in limits:
            signals = record(name, effect, 0.0, seed=4).signals
            assert all(np.array_equal(signals[tag], without[tag]) for tag in without), effect
    assert not np.array_equal(record(name, seed=5).signals["PV"], without["PV"])


@pytest.mark.parametrize("name", UNSEEN)
def test_every_effect_of_an_unseen_plant_shows(name):
    of = plant(name)
    assert 8 <= len(of.effects) <= 11 and len(of.outside) == 3 and {"stiction", "deadband"} <= set(of.effects)
    for effect in (*of.effects, *of.outside):
        run = Run(name, "effect", effect, 6, 0.7, 1.0, 1.0)  # the smallest that is drawn
        assert run.change(run.made()) > 0.3, effect


def test_the_same_seed_has_the_same_set_points_and_an_effect_shows():
    without, with_it = record("sqrt_tank", seed=3), record("sqrt_tank", "valve_leak", 1.0, seed=3)
    assert (without.signals["SP"] == with_it.signals["SP"]).all()
    assert with_it.truth.place == "valve" and with_it.truth.values == {"valve.leak": 0.05} and not with_it.truth.outside
    # analytic: at rest the leak of 5 % is taken off OP
    assert np.median(without.signals["OP"] - with_it.signals["OP"]) == pytest.approx(5.0, abs=0.3)
    assert (record("sqrt_tank", seed=3).signals["PV"] == without.signals["PV"]).all()


def test_a_name_that_is_none_is_refused():
    with pytest.raises(ValueError, match="no foreign plant 'pump'"):
        record("pump")
    with pytest.raises(ValueError, match="cone has no effect 'rust'"):
        record("cone", "rust")


def test_a_stem_sticks_by_s_and_jumps_by_j():
    valve, x = Valve(S=0.05, J=0.02), instruments.stem_at(0.5)
    out = np.array([instruments.stem(valve, x, op, 0.0, 0.01) for op in 0.5 + 1e-4 * np.arange(1000)])
    moving = int(np.flatnonzero(out != 0.5)[0])
    assert moving * 1e-4 == pytest.approx(0.035, abs=2e-4)  # analytic: (S + J)/2
    assert out[moving] - 0.5 == pytest.approx(0.02, abs=2e-4)  # analytic: the jump J
    assert out[-1] == pytest.approx(0.5999 - 0.015, abs=1e-6)  # analytic: (S - J)/2 behind
    back = np.array([instruments.stem(valve, x, op, 0.0, 0.01) for op in 0.5999 - 1e-4 * np.arange(1, 700)])
    stood = int(np.flatnonzero(back != out[-1])[0])
    assert stood * 1e-4 == pytest.approx(0.05, abs=2e-4)  # analytic: after a turn it stands for S
    play, x = Valve(S=0.04), instruments.stem_at(0.5)
    assert instruments.stem(play, x, 0.6, 0.0, 0.01) == pytest.approx(0.58)  # analytic: half the play behind


def test_a_controller_moves_as_the_incremental_form_does():
    c, rng = PI(K=-0.2, T_i=7.0, scan=2.0), np.random.default_rng(1)
    state, op, was = instruments.pi_at(0.5), 0.5, 0.0
    for e in rng.normal(0.0, 1.5, 200):
        out = instruments.pi(c, state, e, 0.0, 0.0, 1.0)
        op = min(max(op - 0.2 * (e - was + 2.0 / 7.0 * e), 0.0), 1.0)  # analytic: OP moves by K (de + h/T_i e)
        was = e
        assert out == pytest.approx(op, abs=1e-12)


def test_a_sensor_shows_its_errors_and_a_plan_its_shape():
    m = instruments.sensor_at(2.0)
    s = Sensor(bias=0.3, span=1.1, drift=3.6, step=0.5)
    assert instruments.read(s, m, 0.0, 1.0, 100.0) == 2.5  # analytic: 2.2 + 0.3 + 0.1 = 2.6, in steps of 0.5
    slug = [instruments.planned(Feed(slug=2.0, period=10.0), t) for t in (0.0, 4.0, 8.0, 9.0, 10.0)]
    assert slug == pytest.approx([-1.0, 0.0, 1.0, 0.0, -1.0])  # analytic


def test_the_historian_stays_within_its_deviation():
    t, y = np.arange(500.0), np.cumsum(np.random.default_rng(2).normal(size=500))
    kept = swinging_door(t, y, 0.7)
    assert np.abs(kept - y).max() <= 0.7 + 1e-9  # analytic: the door's promise
    assert np.abs(np.diff(kept, 2)).astype(bool).mean() < 0.95
    assert late(t, y, 3.0)[10] == y[7]
    assert filtered(t, (t > 0.0) * 1.0, 5.0)[5] == pytest.approx(1.0 - np.exp(-1.0))  # analytic: its time constant
    assert (filtered(t, y, 0.0) == y).all()


def test_a_load_has_the_stated_size_and_memory():
    x = records.walk(np.random.default_rng(5), 200_000, 20.0)
    assert np.std(x) == pytest.approx(1.0, abs=0.05)  # analytic
    assert np.corrcoef(x[:-20], x[20:])[0, 1] == pytest.approx(np.exp(-1.0), abs=0.05)  # analytic

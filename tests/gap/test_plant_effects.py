"""Effects of the plant: where they may be, what they do by its equations, and that the plant runs with them."""

import numpy as np
import pytest
from stickslip.blocks import FlowResistance, IdealValve
from stickslip.diagram import simulate, wire
from stickslip.gap.effects import CATALOGUE, effect
from stickslip.gap.effects.horizontal_separator import cylinder
from stickslip.gap.insertion.effect import EffectError
from stickslip.plant import kicked, production_plant

PLANT = production_plant()
TYPICAL = {
    "horizontal_separator": ("S1", {"share": 1.0}),
    "boil_off_rate": ("S1", {"factor": 0.7}),
    "vapour_pressure": ("S2", {"factor": 1.05}),
    "real_gas": ("S1", {"factor": 0.92}),
    "gas_temperature": ("S1", {"factor": 0.97}),
    "compressor_fouling": ("C2", {"factor": 0.96}),
    "compressor_map_shift": ("C3", {"factor": 0.95}),
    "recycle_leak": ("VRVC2_body", {"flow": 3.0}),
    "shaft_friction": ("shaft", {"coefficient": 0.5}),
    "line_friction": ("C2_pipe", {"factor": 1.3}),
}
PLACES = {
    **dict.fromkeys(
        ("horizontal_separator", "boil_off_rate", "vapour_pressure", "real_gas", "gas_temperature"), ("S1", "S2")
    ),
    "compressor_fouling": ("C3", "C2"),
    "compressor_map_shift": ("C3", "C2"),
    "recycle_leak": ("VRVC3_body", "VRVC2_body"),
    "shaft_friction": ("shaft",),
    "line_friction": ("C3_pipe", "C2_pipe"),
}


def run(plant, duration=60.0):
    # kicked: at rest S1 is half full, where a lying cylinder shows what an upright one does
    done = simulate(kicked(plant), duration, every=1.0, method="stiff", rtol=1e-7, atol=1e-9)
    assert done.ok, done.hint
    return done.log


@pytest.fixture(scope="module")
def base():
    return run(PLANT)


@pytest.mark.parametrize("name", TYPICAL)
def test_the_plant_runs_with_it_and_feels_it(name, base):
    place, values = TYPICAL[name]
    one = effect(name)
    assert one.places(PLANT) == PLACES[name] and one.insert(PLANT, place) is PLANT
    log = run(one.insert(PLANT, place, **values))
    moved = max(
        np.abs(log[s] / base[s] - 1.0).max() for s in ("p_1", "p_2", "p_in2", "p_out2", "w", "V_1", "V_2", "tau_d")
    )
    assert moved > 1e-4
    with pytest.raises(EffectError):
        one.insert(PLANT, place, **dict.fromkeys(values, -1.0))


def test_nothing_of_the_plant_is_in_a_flow_loop():
    from stickslip.cases.models import ideal_flow

    assert all(effect(name).places(ideal_flow()) == () for name in TYPICAL)


def test_a_gas_that_is_not_ideal_is_one_of_another_temperature():
    one, other = (run(effect(n).insert(PLANT, "S1", factor=0.95)) for n in ("real_gas", "gas_temperature"))
    np.testing.assert_allclose(one["p_1"], other["p_1"], rtol=1e-10)


def test_a_lying_cylinder():
    level, filled = cylinder()
    half = level < 0.49
    # analytic: the segment of a circle of diameter 1 has the area (a - sin a)/8, a = 2 arccos(1 - 2 h)
    a = 2.0 * np.arccos(1.0 - 2.0 * level)
    np.testing.assert_allclose(filled, (a - np.sin(a)) / 8.0 / (np.pi / 4.0), atol=1e-12)
    assert (level[half] > filled[half])[1:].all() and filled[-1] == pytest.approx(1.0)
    log = run(effect("horizontal_separator").insert(PLANT, "S1", share=1.0))
    full = PLANT["S1"].params["V_sep"]
    want = full * np.interp(log["V_1:S1"] / full, filled, level)
    np.testing.assert_allclose(log["V_1"], want, rtol=1e-9)


def test_a_leak_a_line_and_bearings_by_their_equations():
    leaking = run(effect("recycle_leak").insert(PLANT, "VRVC2_body", flow=3.0))
    body = PLANT["VRVC2_body"].params["C_v"]
    drop = leaking["p_out2"] - leaking["p_in2"]
    np.testing.assert_allclose(leaking["m_rv2"], body * (leaking["MV_VRVC2"] + 0.03) * np.sqrt(drop), rtol=1e-3)
    pipe = wire([FlowResistance(2.0, name="pipe")], inputs=["p_up", "p_down"])
    rough = effect("line_friction").insert(pipe, "pipe", factor=4.0)
    assert rough["pipe"].params["K"] == 1.0  # four times the loss at the same flow
    rubbing = run(effect("shaft_friction").insert(PLANT, "shaft", coefficient=0.5), 400.0)
    taken = rubbing["tau_d"] - rubbing["tau_2"] - rubbing["tau_3"]
    rate = np.gradient(rubbing["w"], rubbing.t) * PLANT["shaft"].params["J"]
    np.testing.assert_allclose((taken - rate)[20:-1], 0.5 * rubbing["w"][20:-1], rtol=0.02)  # what the bearings take


def test_loops_of_the_plant_have_their_places():
    free = PLANT.replace("VPCS1", IdealValve())
    assert "VPCS1" in effect("stiction").places(free) and "PCS12" not in effect("stiction").places(free)
    assert {"LCS11", "PCS11", "SC001"} <= set(effect("controller_gain").places(free))
    assert effect("slug").places(free) == ("F_in", "Z_I", "p_C1", "m_C4", "p_atm")
    assert effect("slug").bounds(free, "F_in")["amplitude"] == pytest.approx((3.8, 3800.0))  # of 7600 mol/s


SIZES = {
    "stiction": {"S": 3.0, "J": 1.0}, "deadband": {"width": 2.0}, "valve_leak": {"flow": 2.0},
    "valve_saturation": {"high": 70.0}, "valve_rate_limit": {"rate": 2.0}, "positioner_lag": {"tau": 2.0},
    "valve_characteristic": {"rangeability": 3.0}, "valve_gain": {"factor": 1.1}, "dead_time": {"theta": 1.0},
    "controller_gain": {"factor": 1.3}, "controller_integral_time": {"factor": 1.3},
    "controller_limits": {"high": 90.0}, "controller_filter": {"tau": 1.0}, "scan_time": {"period": 1.0},
}  # fmt: skip


@pytest.mark.parametrize("name", SIZES)
def test_effects_of_loops_run_in_the_plant(name):
    one = effect(name)
    place = "PCS11" if name.startswith("controller") or name == "scan_time" else "VPCS1"
    place = "scrubber_1" if name == "dead_time" else place
    first = {"OP_VPCS1": float(PLANT["VPCS1"].d0[1]), "MV_VPCS1": float(PLANT["VPCS1"].d0[1])}
    changed = one.started(one.insert(PLANT, place, **SIZES[name]), place, first)
    done = simulate(changed, 30.0, every=1.0, method="stiff")
    assert done.ok and np.isfinite(done.log["p_1"]).all()


def test_every_effect_of_the_contract_is_in_the_catalogue():
    assert {*TYPICAL} <= {one.name for one in CATALOGUE}

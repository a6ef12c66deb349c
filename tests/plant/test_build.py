"""The wired plant: it rests, its parts stand alone, its balances close, stems of both kinds agree."""

from dataclasses import replace

import control as ct
import numpy as np
import pytest
from stickslip.blocks.he_valve import HeValve
from stickslip.blocks.kano_valve import KanoValve
from stickslip.blocks.ports import BlockError
from stickslip.blocks.quasi_static_stem import QuasiStaticStem
from stickslip.blocks.sampled_pi import SampledPI
from stickslip.blocks.sources import Constant, Step
from stickslip.blocks.tabulated_map import TabulatedMap
from stickslip.diagram import WiringError, simulate, wire
from stickslip.plant import SET_B, SETS, kicked, parts, production_plant, steady_state
from stickslip.plant.balances import contents, with_balances
from stickslip.plant.build import compressor_2, separator_1, turbine_and_shaft
from stickslip.plant.parts import VALVES
from stickslip.study import production_subject

READINGS = ("p_1", "V_1", "z_1", "p_2", "V_2", "p_in2", "p_out2", "p_in3", "p_out3", "m_2", "m_3", "w", "tau_d")


@pytest.mark.parametrize("name", SETS)
@pytest.mark.parametrize("F_s", ["none", "normal", "high"])
@pytest.mark.parametrize("method", ["auto", "stiff"])
def test_rests_whatever_the_stiction(name, F_s, method):
    run = simulate(production_plant(name, F_s=F_s), 2000.0, every=20.0, method=method)
    assert run.ok
    for signal in (*READINGS, "OP_VLCS1", "OP_VPCS1", "OP_VLCS2", "OP_VPCS2"):
        values = run.log[signal]
        np.testing.assert_allclose(values, values[0], rtol=1e-6)  # the promise; measured below 1e-12
    assert not any(event.block.startswith("V") for event in run.events)


def test_rests_at_any_feasible_feed():
    for F_in, Z_I in ((8000.0, 0.25), (7300.0, 0.35), (8200.0, 0.38)):
        run = simulate(production_plant("B", F_in=F_in, Z_I=Z_I), 500.0, every=10.0, method="stiff")
        assert run.ok
        for signal in READINGS:
            np.testing.assert_allclose(run.log[signal], run.log[signal][0], rtol=1e-6)


@pytest.mark.parametrize("case", [1, 2])
def test_balances_close_to_rounding(case):
    """Linear invariants survive every step of the method; energy closes to its tolerance."""
    plant = production_plant("B", F_s="high", case=case)
    if case == 1:
        plant = kicked(plant)
    run = simulate(with_balances(plant), 400.0, every=10.0, method="stiff")
    assert run.ok and np.ptp(run.log["p_1"]) > 1e4
    held, balances = contents(run.final), run.final["balances"].x0
    assert np.abs(balances - contents(plant))[:4].min() > 0.1  # something did cross the boundaries
    np.testing.assert_allclose(held[:4], balances[:4], rtol=1e-11)  # measured 2e-13
    assert held[4] == pytest.approx(balances[4], rel=1e-6)  # quadratic in the speed


def test_stuck_valves_leave_the_stem_where_it_is():
    run = simulate(kicked(production_plant("B", F_s=1e6)), 60.0, every=1.0, method="stiff")
    assert np.ptp(run.log["MV_VPCS1"]) == 0.0 and np.ptp(run.log["MV_VLCS1"]) == 0.0
    assert np.ptp(run.log["OP_VPCS1"]) > 1e-3


@pytest.mark.parametrize("F_s", ["normal", "high"])
def test_stem_laws_hold_in_the_plant(F_s):
    """Notes, section 5: |OP - x| <= f_s; sliding means |OP - x| = f_c; a slip is J and what OP moved meanwhile."""
    run = simulate(kicked(production_plant("B", F_s=F_s)), 500.0, every=0.1, method="stiff")
    F = {"normal": 1750.0, "high": 2250.0}[F_s]
    f_s, f_c, J = F / 52500.0, 1250.0 / 52500.0, (F - 1250.0) / 52500.0
    for valve in ("VPCS1", "VLCS1"):
        OP, MV = run.log[f"OP_{valve}"], run.log[f"MV_{valve}"]
        assert np.abs(OP - MV).max() <= f_s + 1e-9
        moved = np.abs(np.diff(MV))
        slips = moved[moved > 0.5 * J]
        assert len(slips) > 2
        assert slips.min() > J - 0.002 and np.median(slips) < J + 0.002
        slid = (moved > 0.0) & (moved < 0.5 * J)
        if slid.any():
            np.testing.assert_allclose(np.abs(OP - MV)[1:][slid], f_c, atol=1e-6)


def test_full_stem_agrees_with_the_quasi_static_one():
    """The full stem lags by 12 ms and lands where OP has meanwhile gone; both slip in the same order."""
    feed = [Step("F_in", 8150.0, 8000.0, at=1.0, unit="mol/s"), Constant("Z_I", 0.37)]
    runs = [
        simulate(production_plant("B", F_s="high", stem=stem, feed=feed), 40.0, every=0.05, method="stiff")
        for stem in ("quasi_static", "full")
    ]
    slips = [[(e.block, e.after, e.t) for e in run.events if e.before == "stuck"] for run in runs]
    assert len(slips[0]) == 3 and [s[:2] for s in slips[0]] == [s[:2] for s in slips[1]]
    assert slips[0][0][2] == pytest.approx(slips[1][0][2], abs=1e-3)  # before the first slip nothing differs
    np.testing.assert_allclose([s[2] for s in slips[0]], [s[2] for s in slips[1]], atol=0.6)
    before = (runs[0].log.t < slips[0][1][2]) & (abs(runs[0].log.t - slips[0][0][2]) > 0.1)
    a, b = (run.log["MV_VPCS1"][before] for run in runs)
    assert np.abs(a - b).max() < 1e-3  # OP moved 6e-4 while the stem was on its way


def test_full_stems_start_at_rest_too():
    run = simulate(production_plant("B", stem="full"), 100.0, every=10.0, method="stiff")
    np.testing.assert_allclose(run.log["p_1"], 30e5, rtol=1e-9)


def test_any_valve_may_stick():
    plant = production_plant("B", sticky=("VPCS2", "VRVC2"), F_s={"VPCS2": "high", "VRVC2": 1800.0})
    assert isinstance(plant["VPCS2"], QuasiStaticStem) and plant["VRVC2"].f_s == pytest.approx(1800.0 / 52500.0)
    assert not isinstance(plant["VPCS1"], QuasiStaticStem)


def test_separator_alone_holds_its_pressure_after_a_step_of_feed():
    loop = separator_1("B", F_s="none").without("F_in")
    run = simulate(loop, 400.0, every=1.0, inputs={"F_in": Step("F_in", 8100.0, 8000.0, at=10.0)}, method="stiff")
    late = run.log.t > 200.0
    assert np.abs(run.log["p_1"][late] - 30e5).max() < 0.3e5
    assert run.log["F_L1"][-1] > run.log["F_L1"][0]


def test_compressor_alone_rests_and_takes_more_gas():
    station = compressor_2("B")
    rest = 0.016 * 2283.7189819065397
    still = simulate(station, 20.0, every=1.0, inputs={"m_G1": rest}, method="stiff")
    np.testing.assert_allclose(still.log["p_out2"], 75e5, rtol=1e-8)
    more = simulate(station, 60.0, every=1.0, inputs={"m_G1": 1.1 * rest}, method="stiff")
    assert more.log["m_2"][-1] == pytest.approx(more.log["m_out2"][-1], rel=1e-6)
    assert more.log["m_2"][-1] == pytest.approx(47.05088519 + 0.1 * rest, rel=1e-6)  # analytic: gas in is gas out


def test_shaft_alone_keeps_its_speed_under_load():
    load = {"OP_VPCS2": 0.9, "tau_3": 1350.35}
    run = simulate(
        turbine_and_shaft("B"), 60.0, every=0.5, inputs={**load, "tau_2": Step("tau_2", 15000.0, 14284.7, at=5.0)}
    )
    assert run.log["w"][-1] == pytest.approx(994.838, abs=2e-3)
    assert run.log["tau_d"][-1] == pytest.approx(16350.35, rel=2e-3)  # analytic: the sum of the loads
    assert run.log["w"].min() < 994.838 - 5e-3


def test_wide_open_gas_valve_raises_the_speed():
    load = {"tau_2": 14284.7, "tau_3": 1350.35}
    run = simulate(turbine_and_shaft("B"), 100.0, every=1.0, inputs={**load, "OP_VPCS2": 0.95})
    assert run.log["w_SP"][-1] == pytest.approx(994.838 + 3.0 * 0.05 * (1 + 100.0 / 600.0), rel=1e-6)  # analytic


def test_python_control_sees_the_plant_at_rest():
    plant = production_plant("B", sticky=())
    rates = plant.dynamics(0.0, plant.x0, [])
    scale = np.maximum(np.abs(plant.x0), 1.0)
    # analytic: nothing moves. Anti-windup holds flare and anti-surge integrals.
    np.testing.assert_allclose(rates / scale, 0.0, atol=1e-7)
    assert len(plant.x0) == 23


def test_linearised_with_ideal_valves_it_is_stable():
    plant = production_plant("A", sticky=())
    poles = np.linalg.eigvals(ct.linearize(plant, plant.x0, []).A)
    fast = np.sort(poles.real)[:9]
    # Published: notes 4, found with another program.
    np.testing.assert_allclose(fast, [-2000, -810, -480, -140, -88, -31, -13, -3.6, -2.3], rtol=0.03)
    assert np.sum(np.abs(poles) < 1e-9) == 2  # the integrals of the two shut flares
    assert np.max(poles.real[np.abs(poles) >= 1e-9]) == pytest.approx(-5e-4, abs=1e-4)


def test_compressor_with_a_map_of_ones_own():
    flow = np.linspace(0.6, 1.2, 13)
    curves = {n: (n * flow, n**2 * (1.2 - 0.8 * (flow - 0.6) ** 1.7)) for n in (0.9, 1.0, 1.1)}
    eta = {n: (n * flow, 0.8 - 0.3 * (flow - 0.9) ** 2) for n in (0.9, 1.0, 1.1)}
    own = TabulatedMap.from_curves(curves, eta, speed=1.0, flow=1.0, head_at=1.0)
    set_ = SET_B.changed(C2=replace(SET_B.C2, map=own))
    run = simulate(production_plant(set_), 300.0, every=10.0, method="stiff")
    for signal in READINGS:
        np.testing.assert_allclose(run.log[signal], run.log[signal][0], rtol=1e-6)
    kick = simulate(kicked(production_plant(set_)), 300.0, every=1.0, method="stiff")
    assert kick.ok and np.ptp(kick.log["p_out2"]) > 0.1e5


def test_units_are_checked_by_the_wiring():
    blocks = list(production_plant("B").blocks)
    i = next(i for i, block in enumerate(blocks) if block.name == "m_G1")
    del blocks[i]
    wrong = [
        b if b.name != "C2_inlet" else b.relabelled(b.name, ["F_G1", *b.input_labels[1:]], ["p_in2"]) for b in blocks
    ]
    with pytest.raises(WiringError, match=r"'F_G1' has mismatched units"):
        wire(wrong)


def test_misuse_is_explained():
    with pytest.raises(WiringError, match=r"no valve 'VPC1' can stick; did you mean 'VPCS1'"):
        production_plant(sticky=("VPC1",))
    with pytest.raises(WiringError, match=r"no stiction is called 'hihg'; did you mean 'high'"):
        production_plant(F_s="hihg")
    with pytest.raises(WiringError, match=r"no parameter set 'D'"):
        production_plant("D")
    with pytest.raises(WiringError, match=r"case = 3"):
        production_plant(case=3)
    with pytest.raises(WiringError, match=r"no stem is called 'fulll'"):
        production_plant(stem="fulll")
    with pytest.raises(WiringError, match=r"valve 'VPCS1' is sticky, but F_s has no value for it"):
        production_plant(F_s={"VLCS1": "high"})
    with pytest.raises(WiringError, match=r"F_s gives 'VPCS2' 'high', but sticky does not name it"):
        production_plant(F_s={"VLCS1": "high", "VPCS1": "high", "VPCS2": "high"})
    for F_s in (1000.0, float("nan"), float("inf")):
        with pytest.raises(WiringError, match=r"VLCS1: F_s = .* at least the Coulomb friction, F_c = 1250 N"):
            production_plant(F_s=F_s)
    with pytest.raises(BlockError, match=r"feed: F_in = '8000', but it must be a single number"):
        production_plant(F_in="8000")
    with pytest.raises(BlockError, match=r"B\*: D = nan, but it must be positive and finite"):
        SET_B.changed(D=float("nan"))
    with pytest.raises(BlockError, match=r"B: S1.C_v_oil = 0.0, but it must be positive"):
        replace(SET_B, S1=replace(SET_B.S1, C_v_oil=0.0))
    with pytest.raises(WiringError, match=r"no parameter set 'None'"):
        production_plant(None)
    with pytest.raises(WiringError, match=r"'S1.N_metG' is to start at nan"):
        kicked(production_plant(), gas=float("nan"))
    with pytest.raises(BlockError, match=r"no parameter 'F_s', for its stem has no mass; give the bands S = "):
        production_plant().with_params({"VPCS1.F_s": 2000.0})
    with pytest.raises(BlockError, match=r"block 'S1' has no state 'N_met_gas'"):
        production_plant().starting_at({"S1.N_met_gas": 1.0})
    assert production_plant(SET_B.changed(D=7e5)).name == "production_plant"


@pytest.mark.parametrize("number", [0, 1, 4])
def test_parts_that_the_plant_has_not_are_refused(number):
    rest = steady_state(SET_B)
    with pytest.raises(WiringError, match=rf"compressor: number = {number}, but the plant has compressors 2 and 3"):
        parts.compressor(SET_B, rest, number, {})
    with pytest.raises(WiringError, match=r"separator: number = 3, but the plant has separators 1 and 2; give one"):
        parts.separator(SET_B, rest, 3, {})


def test_the_plant_and_the_cases_have_the_same_parameters():
    from stickslip.cases.production import SET

    assert production_plant().params == production_plant(SET).params
    for build in (separator_1, compressor_2, turbine_and_shaft):
        assert build().params == build(SET).params
    assert production_subject().quantities == production_subject(SET).quantities


@pytest.mark.parametrize("controller", ["LCS11", "PCS11", "LCS21", "PCS12"])
def test_a_controller_is_taken_out_with_the_set_point_that_only_it_reads(controller):
    plant = production_plant("B", sticky=())
    without = plant.without(controller)
    gone = {block.name for block in plant.blocks} - {block.name for block in without.blocks}
    assert gone == {controller, f"SP_{controller}"}
    rest = dict(zip(plant[controller].output_labels, [float(plant[controller].x0[-1])], strict=True))
    assert set(without.open_inputs) == set(rest)
    run = simulate(without, 20.0, every=5.0, method="stiff", inputs=rest)
    np.testing.assert_allclose(run.log["p_1"], 30e5, rtol=1e-9)  # analytic: OP stays where it rested


def test_one_valve_may_be_named_without_a_list():
    plant = production_plant(sticky="VPCS2")
    assert [name for name in VALVES if "stuck" in plant[name].modes] == ["VPCS2"]


@pytest.mark.parametrize(
    "change",
    [
        lambda plant: plant.without("PCS12", "SP_PCS12"),
        lambda plant: plant.replace("PCS11", SampledPI(8.8e-7, 8.0, dt=1.0, action="direct", start_op=0.0944)),
        lambda plant: plant.replace("VPCS1", KanoValve(S=0.06, J=0.02, dt=0.5, start=0.0944)),
        lambda plant: plant.replace("VPCS1", HeValve(f_s=0.04, f_d=0.02, dt=0.5, start=0.0944)),
    ],
    ids=["no safety controller", "sampled PI", "Kano", "He"],
)
def test_balances_close_in_a_rewired_plant(change):
    plant = change(with_balances(kicked(production_plant("B"))))
    run = simulate(plant, 300.0, every=100.0, method="stiff", inputs=dict.fromkeys(plant.open_inputs, 0.0) or None)
    assert run.ok
    assert (
        np.abs(contents(run.final) / run.final["balances"].x0 - 1.0)[:4].max() < 1e-11
    )  # analytic: what comes stays or goes

"""Gas valve body: the standard's equation, choking, both directions, and an independent library."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from stickslip.blocks.control_valve_flow import ControlValveFlow
from stickslip.blocks.gas_valve_flow import GasValveFlow
from stickslip.blocks.ports import BlockError
from stickslip.blocks.sizing import size_gas_valve
from stickslip.blocks.sources import Ramp, Step
from stickslip.diagram import drive, simulate
from stickslip.plant import production_plant, steady_state
from stickslip.plant.parameters import SET_B

MOST = 1.3067 / 1.4 * 0.7  # drop ratio at choking of the default gas


def flow(body, p_up, p_down, MV=1.0):
    return float(body.output(0.0, [], [p_up, p_down, MV])[0])


def by_hand(Kv, p_up, p_down, W=0.016, T=302.95, gamma=1.3067, x_T=0.7):
    """Flow [kg/s] by w = N6 Kv Y sqrt(x p_1 rho_1), with N6 = 3.16 for kg/h, kPa, kg/m3."""
    most = gamma / 1.4 * x_T
    x = min((p_up - p_down) / p_up, most)
    rho = p_up * W / (8.314462618 * T)
    return 3.16 * Kv * (1.0 - x / (3.0 * most)) * math.sqrt(x * p_up / 1e3 * rho) / 3600.0


@pytest.mark.parametrize("p_down", [29e5, 22.1e5, 12e5, 2e5])
def test_equation_of_the_standard(p_down):
    body = GasValveFlow(100.0, unit="kg/s")
    assert flow(body, 29.9e5, p_down) == pytest.approx(by_hand(100.0, 29.9e5, p_down), rel=5e-4)  # N6 is rounded
    moles = GasValveFlow(100.0)
    assert 0.016 * flow(moles, 29.9e5, p_down) == pytest.approx(flow(body, 29.9e5, p_down), rel=1e-12)


@settings(max_examples=60)
@given(
    p_up=st.floats(2e5, 2e7), share=st.floats(0.01, 0.99), T=st.floats(250.0, 500.0), W=st.floats(0.002, 0.1),
    gamma=st.floats(1.05, 1.67), x_T=st.floats(0.2, 0.9), Z=st.floats(0.5, 1.2),
)  # fmt: skip
def test_agrees_with_the_library_everywhere(p_up, share, T, W, gamma, x_T, Z):
    """Sizing for the flow that the block passes gives back its Kv, but for the rounded constant N9 = 24.6."""
    body = GasValveFlow(100.0, W=W, T=T, gamma=gamma, x_T=x_T, Z=Z, unit="kg/s", p_lam=1e-3)
    p_down = p_up * (1.0 - share)
    duty = size_gas_valve(flow(body, p_up, p_down), p_up, p_down, molar_mass=W, T=T, gamma=gamma, x_T=x_T, Z=Z)
    assert duty.Kv == pytest.approx(100.0, rel=2e-3)
    limit = gamma / 1.4 * x_T
    assert duty.choked == (share >= limit) or share == pytest.approx(limit, rel=1e-12)  # at the edge rounding decides


def test_small_drops_are_the_incompressible_law():
    gas = GasValveFlow(3620.0)
    liquid = ControlValveFlow(gas.incompressible(29.9e5))
    for drop, tolerance in ((1e3, 3e-4), (1e4, 3e-3)):  # Y = 1 - drop/(3 MOST p_up)
        expected = flow(liquid, 29.9e5, 29.9e5 - drop)
        assert flow(gas, 29.9e5, 29.9e5 - drop) == pytest.approx(expected, rel=tolerance)
        assert flow(gas, 29.9e5, 29.9e5 - drop) < expected


def test_choked_flow_forgets_the_pressure_behind():
    body = GasValveFlow(10.0)
    at = 20e5 * (1.0 - MOST)
    assert flow(body, 20e5, at - 1e4) == flow(body, 20e5, 0.0) == pytest.approx(flow(body, 20e5, at), rel=1e-9)
    assert flow(body, 40e5, 0.0) == pytest.approx(2.0 * flow(body, 20e5, 0.0), rel=1e-8)  # analytic: grows with p_up
    h = 10.0  # slope fades out before choking: no kink
    before = (flow(body, 20e5, at + h) - flow(body, 20e5, at + 2 * h)) / h
    assert abs(before) < 1e-6 * flow(body, 20e5, at) / 20e5 * 100


@given(st.floats(1e5, 1e8), st.floats(1e5, 1e8), st.floats(0.0, 1.0))
def test_both_directions_alike(a, b, MV):
    body = GasValveFlow(10.0)
    assert flow(body, a, b, MV) == -flow(body, b, a, MV)
    assert flow(GasValveFlow(10.0, check_valve=True), a, b, MV) == max(0.0, flow(body, a, b, MV))


def test_choking_is_located_and_logged():
    body = GasValveFlow(10.0)
    run = drive(body, 10.0, every=0.5, p_up=20e5, p_down=Ramp("p_down", -2e5, before=20e5), MV=0.5)
    [event] = run.events
    assert (event.before, event.after) == ("flowing", "choked")
    assert event.t == pytest.approx(20e5 * MOST / 2e5, rel=1e-9)  # analytic
    assert np.all(np.diff(run.log["F"]) >= 0.0) and run.log["F"][-1] == run.log["F"][-3]


def test_check_valve_shuts_and_opens_and_chokes():
    body = GasValveFlow(10.0, check_valve=True)
    run = drive(
        body, 12.0, every=0.5, p_up=Ramp("p_up", 2e5, before=1e5), p_down=Step("p_down", 1e5, 9e5, at=8.0), MV=1
    )
    assert [event.after for event in run.events] == ["shut", "flowing", "choked"]
    assert [event.t for event in run.events] == pytest.approx([0.0, 4.0, 8.0], abs=1e-6)  # analytic, but for the band
    assert np.all(run.log["F"][run.log.t < 4.0] == 0.0) and run.log["F"][-1] > 0.0


def test_choked_flow_backwards_is_shut_by_a_jump():
    body = GasValveFlow(10.0, check_valve=True)
    run = drive(body, 2.0, every=0.5, p_up=20e5, p_down=Step("p_down", 30e5, 1e5, at=1.0), MV=1.0)
    assert [event.after for event in run.events] == ["choked", "flowing", "shut"]
    assert run.log["F"][-1] == 0.0


def test_a_valve_for_a_duty():
    body = GasValveFlow.passing(2283.7, 29.9e5, 22.1e5, 0.0944, T=302.95, unit="mol/s")
    assert flow(body, 29.9e5, 22.1e5, 0.0944) == pytest.approx(2283.7, rel=1e-12)
    kilos = GasValveFlow.passing(36.5, 29.9e5, 22.1e5, unit="kg/s")
    assert flow(kilos, 29.9e5, 22.1e5) == pytest.approx(36.5, rel=1e-12) and kilos.units["F"] == "kg/s"


def test_the_plant_rests_and_cycles_with_gas_valves_too():
    plant, rest = production_plant("B"), steady_state(SET_B)
    body = GasValveFlow.passing(
        rest.S1.F_G, rest.S1.p - SET_B.dp_scrubber, rest.C2.p_in, rest.VPCS1, gamma=SET_B.fluids.gamma,
        check_valve=True, name="VPCS1_body", inputs=["p_gas1", "p_in2", "MV_VPCS1"], outputs="F_G1",
    )  # fmt: skip
    run = simulate(plant.replace("VPCS1_body", body), 500.0, every=10.0, method="stiff")
    assert run.ok
    np.testing.assert_allclose(run.log["p_1"], 30e5, rtol=1e-9)  # analytic: same flow at rest


def test_misuse_is_explained():
    with pytest.raises(BlockError, match=r"Kv = 0.0, but it must be positive and finite"):
        GasValveFlow(0.0)
    with pytest.raises(BlockError, match=r"gamma = 1.0, but a heat capacity ratio exceeds 1"):
        GasValveFlow(1.0, gamma=1.0)
    with pytest.raises(BlockError, match=r"x_T = 1.2"):
        GasValveFlow(1.0).with_params(x_T=1.2)
    with pytest.raises(BlockError, match=r"unit = 'm3/h'.*give one of them"):
        GasValveFlow(1.0, unit="m3/h")
    with pytest.raises(BlockError, match=r"molar = 0.0, but unit and flap are wired"):
        GasValveFlow(1.0).with_params(molar=0.0)
    with pytest.raises(BlockError, match=r"MV = 0.0, but a valve is sized open"):
        GasValveFlow.passing(1.0, 2e5, 1e5, 0.0)
    for p_up, p_down in ((np.inf, 1e5), (1e5, -1e5), (np.nan, 1e5)):
        with pytest.raises(BlockError, match=r"but it must lie between 0 and p_up = .*; give absolute pressures in Pa"):
            GasValveFlow.passing(1.0, p_up, p_down)
    with pytest.raises(BlockError, match=r"W = 16.0, but it is in kg/mol; divide g/mol by 1000"):
        GasValveFlow(100.0, W=16.0)
    with pytest.raises(BlockError, match=r"p_down = 200000.0, but it must lie between 0 and p_up"):
        GasValveFlow.passing(1.0, 2e5, 2e5)

"""Random plants integrate or say why not; absurd requests end with a status and a reason, never with NaN in an OK log.

``python -m benchmarks.robustness`` runs 500 of them.
"""

from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest
from stickslip.blocks.sources import Constant, Ramp, Step
from stickslip.cases.random_plants import draw, feasible, run, varied
from stickslip.diagram import simulate
from stickslip.engine.status import Status
from stickslip.plant import SET_B, InfeasibleFeed, kicked, production_plant, steady_state

COUNT = 40


@pytest.fixture(scope="module")
def drawn():
    return list(feasible(COUNT))


def test_random_plants_integrate(drawn):
    built = [pair for pair in drawn if not isinstance(pair[1], str)]
    with ThreadPoolExecutor(2) as pool:
        outcomes = list(pool.map(lambda pair: run(*pair), built))
    failed = [f"{o.status}: {o.reason}" for o in outcomes if not o.integrated]
    assert len(built) == COUNT and len(failed) <= 0.05 * COUNT, failed
    assert all(o.reason for o in outcomes if not o.integrated)
    assert max(o.highest["V_1"] - o.lowest["V_1"] for o in outcomes) > 5.0  # they do move


def test_refused_ones_are_refused_with_numbers(drawn):
    refused = [text for _, text in drawn if isinstance(text, str)]
    assert len(refused) > COUNT / 4
    assert all(any(sign.isdigit() for sign in text) and len(text) > 40 for text in refused)


def test_every_number_is_varied_and_repeatable():
    first, again, other = draw(7), draw(7), draw(8)
    assert first == again and first.plant != other.plant
    moved = varied(SET_B, np.random.default_rng(3))
    pairs = [(moved.C2.map.H, SET_B.C2.map.H), (moved.S2.T_i_level, SET_B.S2.T_i_level), (moved.D, SET_B.D)]
    assert all(a != b and 0.8 <= a / b <= 1.2 for a, b in pairs)


def swing(to, within=60.0):
    """Return a feed that goes to the share ``to`` within some seconds."""
    slope = (to - 1.0) * 8000.0 / within
    return [Ramp("F_in", slope, start=10.0, end=10.0 + within, before=8000.0, unit="mol/s"), Constant("Z_I", 0.37)]


def ended(plant, duration, method):
    """Return the run and what the separators say at its end."""
    result = simulate(plant, duration, every=1.0, method=method)
    reached = int(np.isfinite(result.log["p_1"]).sum())
    assert result.status is Status.MODEL_ENDED and result.hint
    for signal in ("p_1", "p_2", "V_1", "V_2", "z_1", "p_in2", "p_in3", "w"):  # physical up to the end
        values = result.log[signal]
        assert np.isfinite(values[:reached]).all() and np.isnan(values[reached:]).all()
        assert values[:reached].min() > 0.0, signal
    return reached - 1.0, [result.final[name].trouble() for name in ("S1", "S2")]


def test_states_off_the_slow_path_do_not_chatter():
    """An event found on a long stiff step, while a flap hangs between open and shut: draw 498 of seed 7 stopped so."""
    result = simulate(draw(498, seed=7).build(), 470.0, every=1.0, method="stiff")
    assert result.ok, result.hint
    assert len([event for event in result.events if event.t > 467.0]) < 500


def test_a_flap_that_shuts_every_few_steps_does_not_hide_that_the_plant_is_stiff():
    result = simulate(production_plant("E", F_in=1.0), 2000.0, every=10.0, method="auto")
    assert result.ok and result.statistics.steps < 1000  # explicit steps to the end would be 770 000


@pytest.mark.parametrize("method", ["stiff", "auto"])
def test_twice_the_feed_fills_the_separator(method):
    t, troubles = ended(production_plant("B", feed=swing(2.0)), 1000.0, method)
    assert 100.0 < t < 200.0 and troubles == ["S1 is full: 81.9 of 81.9 m3 are liquid", ""]


@pytest.mark.parametrize("method", ["stiff", "auto"])
def test_no_feed_with_a_stem_that_cannot_shut_runs_it_dry(method):
    """OP at 0 leaves the sticky stem at F_c/k."""
    t, troubles = ended(production_plant("B", feed=swing(0.0)), 5000.0, method)
    assert t > 2000.0 and troubles[0].startswith("S1 has run dry: ") and troubles[1] == ""


def test_no_feed_with_an_ideal_valve_stops_the_flow_and_rests():
    result = simulate(production_plant("B", sticky=(), feed=swing(0.0)), 5000.0, every=5.0, method="stiff")
    assert result.ok
    assert result.log["F_L1"][-1] == 0.0 and result.log["V_1"].min() > 30.0


def test_valves_stuck_for_good():
    t, troubles = ended(production_plant("B", F_s=1e9, feed=swing(1.5)), 1000.0, "stiff")
    assert t > 100.0 and troubles[0].startswith("S1 is full")
    t, troubles = ended(production_plant("B", F_s=1e9, feed=swing(0.3)), 1000.0, "stiff")
    assert t > 100.0 and troubles[0].startswith("S1 has run dry")


def test_level_set_point_above_the_vessel():
    t, troubles = ended(production_plant("B").with_params({"SP_LCS21.value": 120.0}), 1000.0, "stiff")
    assert t > 30.0 and troubles == ["", "S2 is full: 100.1 of 100.1 m3 are liquid"]


def test_negative_feed_takes_the_methane_first():
    _, troubles = ended(production_plant("B", feed=swing(-1.0)), 1000.0, "stiff")
    assert troubles[0].startswith("S1 has no dissolved methane left")


def test_a_start_that_does_not_fit_in_is_refused_at_once():
    result = simulate(kicked(production_plant("B"), gas=1.0, liquid=2.1), 10.0, every=1.0)
    assert not result.ok and result.final["S1"].trouble() == "S1 is full: 86 of 81.9 m3 are liquid"


@pytest.mark.parametrize(
    ("block", "value"), [("SP_PCS11", 10e5), ("SP_PCS11", 80e5), ("p_C1", 200e5), ("p_C1", 1e5), ("SP_VPCS2", 5.0)]
)
def test_far_set_points_saturate_and_run_on(block, value):
    plant = production_plant("B").with_params({f"{block}.value": value})
    result = simulate(plant, 1000.0, every=1.0, method="stiff")
    assert result.ok
    assert all(np.isfinite(values).all() for values in result.log.signals.values())
    assert result.log["p_in2"].min() > 1e5 and result.log["p_1"].max() < 45e5  # the flare holds 40 bar


def test_gas_that_stops_coming_dissolves_again():
    feed = [Constant("F_in", 8000.0, unit="mol/s"), Step("Z_I", 0.01, 0.37, at=10.0)]
    t, troubles = ended(production_plant("B", feed=feed), 1000.0, "stiff")
    assert t > 60.0 and troubles[0].startswith("S1 is full")


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"OP_VPCS2": 1.05}, r"OP_VPCS2 = 1.05, but its travel ends at 0 and 1"),
        ({"S1": replace(SET_B.S1, p_safe=29e5)}, r"S1: p_SP = 30 bar lies above p_safe = 29 bar"),
        ({"S1": replace(SET_B.S1, p_SP=11e5)}, r"S1: p_SP = 11 bar does not lie above p_SP of S2, 12 bar"),
        ({"S2": replace(SET_B.S2, V_SP=120.0)}, r"S2: the level set point V_SP = 120 m3 does not lie .* 100.1 m3"),
        ({"fluids": replace(SET_B.fluids, c_01=390.0)}, r"heat capacity ratio of 0\.9667, but it exceeds 1"),
        (
            {"C2": replace(SET_B.C2, m_d=40.0)},
            r"C2 would have to lift .* from 22.1 to 75 bar, at a corrected flow of 1.58 .* head of -4",
        ),
    ],
)
def test_contradictions_are_refused_with_numbers(changes, says):
    with pytest.raises(InfeasibleFeed, match=says):
        steady_state(SET_B.changed(**changes))
    with pytest.raises(InfeasibleFeed, match=says):
        production_plant(SET_B.changed(**changes))

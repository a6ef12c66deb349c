"""Three loops wired differently: what theory foretells of them, and the page that shows them."""

import inspect
import os
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from stickslip.blocks import Step, TabulatedMap
from stickslip.cases import find, names
from stickslip.cases.topologies import cascade_flow, own_map, split_range
from stickslip.cases.topologies.map_plane import map_plane
from stickslip.detect import diagnose
from stickslip.diagram import simulate
from stickslip.plant import SET_B, production_plant, steady_state

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "topologies.md").read_text()
DATA = Path(os.environ.get("STICKSLIP_DATA", ROOT.parent / "shared" / "data")) / "compressor"
S, J, STEM = 3500.0 / 52500.0, 1000.0 / 52500.0, 1250.0 / 52500.0  # analytic: (F_s +- F_c)/k and F_c/k, high stiction


def numbers(name):
    return {number.quantity: number for number in find(name).numbers()}


@pytest.mark.parametrize("name", ["cascade_flow", "split_range", "own_map", "plant_own_map"])
def test_registered_and_runs(name):
    case = find(name)
    assert name in names()
    run = case.run()
    assert run.ok and set(case.signals) <= set(run.log.names)
    assert run.plot(case.signals).axes


# --- cascade -------------------------------------------------------------------------------------------------


def test_cascade_takes_the_cycle_out_of_the_level():
    found = numbers("cascade_flow")
    for quantity, tolerance in (
        ("level swing, direct", 0.02),
        ("level swing, cascade", 0.05),  # the lag of the flow rounds the triangle
        ("flow swing, direct", 0.07),  # OP moves on while the stem slips
        ("flow swing, cascade", 0.05),
    ):
        number = found[quantity]
        assert number.reproduced == pytest.approx(number.analytic, rel=tolerance), quantity
    assert found["level swing, direct"].analytic == pytest.approx(100 * S / 4.0)  # analytic
    assert found["level swing, cascade"].analytic == pytest.approx(100 * S / (0.5 * (4.0 + 200.0 / 3.0)))
    assert found["slips, cascade"].reproduced > 5 * found["slips, direct"].reproduced


def test_cascade_without_stiction_rests():
    loops = cascade_flow.both().in_mode("ideal")
    log = simulate(loops, 7200.0, every=10.0).log
    for loop in ("direct", "cascade"):
        assert log[f"{loop}/L"][-1] == pytest.approx(0.5, abs=1e-5)  # analytic: integral action
        assert log[f"{loop}/F"][-1] == pytest.approx(0.55, abs=1e-5)  # analytic: what flows in flows out


@pytest.mark.parametrize(("K_F", "T_v"), [(0.25, 200.0), (0.25, 400.0), (0.35, 400.0)])
def test_level_swing_follows_gain_and_hold_up(K_F, T_v):
    loops = cascade_flow.both().with_params({"cascade/FC.K_p": K_F, "cascade/vessel.T": T_v})
    log = simulate(loops, 7200.0, every=1.0).log
    swing = float(np.ptp(log["cascade/L"][log.t > 4800.0]))
    assert swing == pytest.approx(S / (K_F * (4.0 + T_v / 3.0)), rel=0.05)  # analytic


# --- split range ---------------------------------------------------------------------------------------------


def test_split_map_and_the_valve_out_of_range():
    log = find("split_range").run().log
    np.testing.assert_allclose(log["OP_vent"], np.clip(2 * log["OP"] - 1, 0, 1), atol=1e-9)  # analytic: the map
    np.testing.assert_allclose(log["OP_inert"], np.clip(1 - 2 * log["OP"], 0, 1), atol=1e-9)
    assert np.minimum(log["OP_vent"], log["OP_inert"]).max() == 0.0
    filling = log["m_pump"] > 0.0
    settled = log.t % 1800.0 > 600.0
    assert np.ptp(log["MV_inert"][filling & settled]) == 0.0  # shut, and it stays so
    assert np.ptp(log["MV_vent"][~filling & settled]) < 1e-6
    assert log["MV_vent"][~filling & settled].mean() == pytest.approx(STEM, abs=1e-6)  # analytic: no seat force
    flows = {"m_vent": filling, "m_inert": ~filling}
    cycling, calm = (np.ptp(log[m][part & (log.t % 1800.0 > 1200.0)]) for m, part in flows.items())
    assert cycling > 10 * calm


def test_split_range_numbers():
    found = numbers("split_range")
    assert found["OP_vent between slips"].reproduced == pytest.approx(100 * S, rel=0.02)
    lost = 3600 * 1e-3 * (30.0**STEM - 1) / 29 * np.sqrt(2e5 - 1.013e5)  # analytic
    assert found["inert gas lost through it"].analytic == pytest.approx(lost, rel=1e-12)
    assert found["inert gas lost through it"].reproduced == pytest.approx(lost, rel=0.01)


def test_a_free_vent_shuts_and_calms():
    loop = split_range.split_range().in_mode({"vent": "ideal"})
    log = simulate(loop, 7200.0, every=1.0).log
    late = log.t % 1800.0 > 1500.0
    assert np.abs(log["p"][late] / 2e5 - 1.0).max() < 2e-3
    assert log["m_vent"][late & (log["m_pump"] < 0.0)].max() < 1e-9


# --- own map -------------------------------------------------------------------------------------------------


def test_surge_without_and_rest_with_anti_surge_control():
    found = numbers("own_map")
    assert found["least flow over surge flow, with"].reproduced > 1.0
    assert found["least flow, without"].reproduced < -5.0  # reverse flow
    for quantity in ("flow at rest over surge flow, with", "recycle valve at rest, with"):
        assert found[quantity].reproduced == pytest.approx(found[quantity].analytic, rel=1e-4)
    pressure = found["discharge pressure at rest, with"]
    assert pressure.reproduced == pytest.approx(pressure.analytic, rel=1e-5)


def test_curves_go_through_the_points_of_the_table():
    shape = own_map.own_map()
    for rpm, (V, h) in own_map.HEAD.items():
        n = rpm / 10000.0
        back = [shape.psi(v / 7500.0 / n, n) * n**2 * shape.point[2] for v in V]
        np.testing.assert_allclose(back, h, rtol=3e-3)


def test_plant_rests_on_the_users_map():
    found = numbers("plant_own_map")
    assert found["drift from rest in 2000 s"].reproduced < 1e-9
    assert found["power"].reproduced == pytest.approx(found["power"].analytic, rel=1e-9)


def test_plant_on_another_map_rests_at_other_feeds_too():
    own = own_map.plant_with_own_map()
    for F_in, Z_I in ((7600.0, 0.36), (8000.0, 0.25)):
        log = simulate(production_plant(own, F_in=F_in, Z_I=Z_I), 200.0, every=10.0, method="stiff").log
        for signal in ("p_1", "p_out2", "q_2", "q_3", "w"):
            np.testing.assert_allclose(log[signal], log[signal][0], rtol=1e-8)
    assert steady_state(own, Z_I=0.25).C2.recycle > 0.0  # analytic: below margin times surge the valve is open


@pytest.mark.skipif(not DATA.is_dir(), reason=f"the compressor curves are not at {DATA}: NOT TESTED")
def test_plant_on_a_real_machines_curves():
    """From two CSV files to the plant at rest: the map in one line, sized to C2's duty in another."""
    shape = TabulatedMap.read(DATA / "head.csv", DATA / "efficiency.csv", speed=9831.0, flow=22500.0)
    own = own_map.plant_with_own_map(shape)
    rest = steady_state(own)
    assert (rest.C2.q, rest.w) == pytest.approx((1.0, SET_B.w_d), rel=1e-9)  # analytic: sized to its duty
    assert 1.0 / shape.surge() > SET_B.margin  # the recycle valve is shut there
    log = simulate(production_plant(own, F_s="high"), 2000.0, every=20.0, method="stiff").log
    for signal in ("p_1", "p_out2", "q_2", "w"):
        np.testing.assert_allclose(log[signal], log[signal][0], rtol=1e-6)
    tighter = replace(own, margin=1.1)
    assert steady_state(tighter).C2.recycle == 0.0


def test_picture_of_the_map():
    run = simulate(own_map.both(), 30.0, every=0.01, method="stiff")
    ax = map_plane(run).axes[0]
    bare = next(line for line in ax.lines if line.get_label() == "without anti-surge control")
    guarded = next(line for line in ax.lines if line.get_label() == "with anti-surge control")
    assert bare.get_xdata().min() < 0.0 < 5300.0 < guarded.get_xdata().min()  # surge at 5300 m3/h, from the table


# --- the page ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "builder", [cascade_flow.direct_loop, cascade_flow.cascade_loop, split_range.split_range, own_map.station]
)
def test_page_shows_the_code_that_runs(builder):
    source = re.sub(r'    """.*?"""\n', "", inspect.getsource(builder), count=1, flags=re.S).rstrip()
    assert source in PAGE
    assert len(source.splitlines()) < 60


def test_what_the_detector_says_of_the_cascade():
    """The words of docs/topologies.md, and why none of them is 'stiction'."""
    log = find("cascade_flow").run().log
    inner = diagnose(log.loop(sp="cascade/SP_F", pv="cascade/F", op="cascade/OP"))
    assert inner.methods[0].verdict == "not_applicable" and "SP moves" in inner.methods[0].reason
    outer = log.loop(sp="SP_L", pv="cascade/L", op="cascade/SP_F")
    assert diagnose(replace(outer, process="integrating")).methods[0].verdict == "not_applicable"
    alone = cascade_flow.cascade_loop().part(["FC", "valve", "pipe"])
    run = simulate(alone, 7200.0, every=1.0, inputs={"SP_F": Step("SP_F", 0.508, 0.5, at=10.0)})
    said = diagnose(run.log.loop(sp="SP_F", pv="F", op="OP"))
    assert said.methods[0].verdict == "inconclusive" and "flat-topped" in said.methods[0].reason

"""The real records: skipped where they are not; what is pinned are snapshots of fits, not labels."""

import numpy as np
import pytest
from stickslip.blocks import FirstOrder, Sensor
from stickslip.diagram import wire
from stickslip.gap.effects import effect
from stickslip.logs import Log

from benchmarks.gap import real
from benchmarks.gap.free_run import FreeModel
from benchmarks.gap.static_map import static_map
from benchmarks.gap.thesis import indices, loop, scored


def needs(name):
    if not (real.DATA / f"{name}.csv").exists():
        pytest.skip(f"no real data: {real.DATA / name}.csv is not there; set STICKSLIP_DATA")


def test_the_tanks_are_as_far_off_as_their_model_says():
    needs("cascaded_tanks/estimation")
    model, start = real.tanks()
    assert abs(model.fitted(start).rms - 0.603) < 0.005  # snapshot
    over = model.with_effect(effect("tank_overflow"), "tank_1")
    fit = over.fitted({**start, "tank_overflow at tank_1.level": 10.0, "tank_overflow at tank_1.share": 0.5})
    assert fit.rms < 0.51 and not fit.at_bound  # snapshot 0.495


def test_the_level_stations_gain_grows():
    needs("labvolt/training_set")
    d = real.table("labvolt/training_set")
    found = static_map(d["time"], d["input"], d["output"])
    assert found.rms < 0.65 * found.linear_rms and found.gains[-1] > 2.0 * found.gains[0] > 0.0  # snapshot


def test_a_gain_explains_the_thesiss_figures_and_the_printed_loop_does_not():
    R, _ = indices(loop(2250.0, 0.4), {})[0]
    assert (
        abs(R - 13.9) < 0.2
    )  # published design figure of the printed loop: 13.65 analytic, lag of the algorithm added
    best = min(scored(effect("process_gain"), "process"), key=lambda one: one.distance)
    assert best.distance < 2.0 and 2.4 < best.values["factor"] < 3.1
    np.testing.assert_allclose(best.R["6.1(b)"][0], 3.71, rtol=0.05)  # published


def fitted_delay(coloured):
    """Fit a dead time to a lag that is driven by a known OP, its PV in white noise or in a load that lasts."""
    rng = np.random.default_rng(4)
    t, op = np.arange(600.0), np.repeat(rng.uniform(-1.0, 1.0, 30), 20)
    late, y, w = np.concatenate([np.zeros(6), op[:-6]]), [0.0], [0.0]
    for u in late[:-1]:
        y.append(y[-1] + (1.0 - np.exp(-0.2)) * (u - y[-1]))
        w.append(0.95 * w[-1] + 0.05 * rng.normal())
    noise = np.array(w) if coloured else 0.02 * rng.normal(size=len(t))
    process = FirstOrder(1.0, 5.0, inputs="OP", outputs="y")
    diagram = wire([process, Sensor(inputs="y", outputs="PV")], inputs=["OP"])
    log = Log(t, {"OP": op, "PV": np.array(y) + noise})
    model = FreeModel(diagram, log, ("PV",), {"process.K": (0.2, 5.0), "process.tau": (1.0, 20.0)})
    plain = model.fitted({"process.K": 1.0, "process.tau": 5.0})
    late_model = model.with_effect(effect("dead_time"), "process")
    return [plain, late_model.fitted({**plain.values, "dead_time at process.theta": 5.0})]


def test_a_dead_time_is_named_only_where_it_leaves_noise():
    alone, disturbed = fitted_delay(False), fitted_delay(True)
    assert real.said(alone, [0.3, 0.1]).startswith("dead_time")
    assert abs(alone[1].values["dead_time at process.theta"] - 6.0) < 0.1 and alone[1].leaves_noise
    assert "not noise" in real.said(disturbed, [0.3, 0.1]) and disturbed[1].memory > 0.5
    assert real.said(alone, [0.3, 0.29]).startswith("nothing named")

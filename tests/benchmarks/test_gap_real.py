"""The real records: skipped where they are not; what is pinned are snapshots of fits, not labels."""

import numpy as np
import pytest

from benchmarks.gap import real
from benchmarks.gap.thesis import indices, loop, scored
from gap.effects import effect
from gap.static_map import static_map


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

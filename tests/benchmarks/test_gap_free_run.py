"""Effects found by free runs: a tank that runs over, made by another integrator, is named; blocks are left out."""

import numpy as np
import pytest
from stickslip.blocks import Tank
from stickslip.diagram import wire
from stickslip.gap.effects import effect
from stickslip.logs import Log

from benchmarks.gap.free_run import FreeModel, explained, folds, left_out


@pytest.fixture(scope="module")
def log():
    """Return the log of one tank of area 30, outlet 1, rim at 8, by Euler's method in steps of 0.05 s."""
    rng = np.random.default_rng(2)
    u = np.repeat(rng.uniform(1.2, 4.2, 20), 20)
    h, y = 4.0, []
    for value in u:
        y.append(h)
        for _ in range(80):
            h = min(h + 0.05 * (value - np.sqrt(h)) / 30.0, 8.0)
    return Log(4.0 * np.arange(len(u)), {"u": u, "h": np.array(y) + 0.02 * rng.normal(size=len(u))})


def test_a_rim_is_named_and_the_rest_is_found(log):
    tank = Tank(20.0, 1.3, start=4.0, name="tank", inputs="u", outputs=["h", "q"], spans={"h": (0.0, 10.0)})
    model = FreeModel(wire([tank], inputs=["u"]), log, ("h",), {"tank.A": (10.0, 60.0), "tank.k": (0.5, 2.0)})
    catalogue = [effect(name) for name in ("tank_overflow", "process_gain", "dead_time")]
    (plain, _), (fit, tried), *_ = explained(model, {"tank.A": 20.0, "tank.k": 1.3}, catalogue, most=1)
    assert fit.model.effects[0].name == "tank_overflow at tank" and fit.rms < 0.03 < 0.2 < plain.rms
    assert abs(fit.values["tank_overflow at tank.level"] - 8.0) < 0.02
    assert abs(fit.values["tank.A"] - 30.0) < 0.3 and abs(fit.values["tank.k"] - 1.0) < 0.01
    assert [one.cost for one in tried] == sorted(one.cost for one in tried)
    error, each = left_out(fit, folds(log, "h", 8, 2))
    assert error < 0.03 and len(each) == 2


def test_a_parameter_at_its_bound_is_told(log):
    tank = Tank(20.0, 1.3, start=4.0, name="tank", inputs="u", outputs=["h", "q"])
    model = FreeModel(wire([tank], inputs=["u"]), log, ("h",), {"tank.A": (10.0, 15.0), "tank.k": (0.5, 2.0)})
    assert model.fitted({"tank.A": 12.0, "tank.k": 1.3}).at_bound == ("tank.A",)


def test_every_row_is_left_out_once(log):
    sets = folds(log, "h", 9, 3)
    assert (np.sum(sets, axis=0) == 1).all() and all(log["h"][rows].max() > 7.5 for rows in sets)

"""The tank that empties through a hole: Torricelli's law, its rim, what it refuses."""

import numpy as np
import pytest
from stickslip.blocks import PI, BlockError, IdealValve, Overflow, Step, Tank
from stickslip.diagram import drive, simulate, wire


def test_it_empties_as_torricelli_says():
    log = drive(Tank(A=2.0, k=0.5, start=4.0), 10.0, every=1.0, rtol=1e-9, q_in=0.0).log
    np.testing.assert_allclose(log["h"], (2.0 - 0.5 * log.t / 4.0) ** 2, atol=1e-7)  # analytic
    np.testing.assert_allclose(log["q_out"], 0.5 * np.sqrt(log["h"]), atol=1e-9)


def test_nothing_is_lost_at_the_rim():
    flow = ([0.0, 10.0, 20.0], [0.0, 4.0, 0.0])
    tank = wire([Tank(A=2.0, k=0.5, top=3.0), Overflow(top=3.0)], inputs=["q_in"])
    run = simulate(tank, 20.0, every=0.01, rtol=1e-8, inputs={"q_in": flow})
    log = run.log
    assert log["h"].max() == pytest.approx(3.0, abs=1e-12) and log["q_over"].max() > 1.0
    net = np.interp(log.t, *flow) - log["q_out"] - log["q_over"]
    held = 2.0 * log["h"][-1]
    assert np.trapezoid(net, log.t) == pytest.approx(held, abs=2e-3)  # balance
    assert [event.after for event in run.events] == ["running over", "filling"]


def level_loop(SP, top, start):
    tank = Tank(A=20.0, k=0.5, top=top, start=start, inputs="MV")
    over = Overflow(top, inputs=["MV", "q_out", "h"])
    return wire([Step("SP", SP), PI(2.0, 60.0, inputs=["SP", "h"], outputs="OP"), IdealValve(), tank, over])


def test_a_level_loop_with_a_continuous_controller_settles_at_the_set_point():
    log = simulate(level_loop(0.5, top=0.8, start=0.3), 3000.0, every=10.0, rtol=1e-8).log
    assert log["h"][-1] == pytest.approx(0.5, abs=1e-5)
    assert log["MV"][-1] == pytest.approx(0.5 * np.sqrt(0.5), abs=1e-5)  # analytic: inflow = outflow


def test_a_level_loop_runs_over_while_its_set_point_lies_above_the_rim():
    log = simulate(level_loop(0.9, top=0.64, start=0.0), 600.0, every=1.0, rtol=1e-8).log
    assert log["h"][-1] == 0.64 and log["MV"][-1] == 1.0
    assert log["q_over"][-1] == pytest.approx(1.0 - 0.5 * 0.8, rel=1e-12)  # analytic: MV - k sqrt(top)


@pytest.mark.parametrize("bad", [{"A": 0.0}, {"k": -1.0}, {"top": 0.0}])
def test_what_no_tank_is(bad):
    with pytest.raises(BlockError, match=f"{next(iter(bad))} = "):
        Tank(**bad)


def test_a_rim_below_the_bottom_is_none():
    with pytest.raises(BlockError, match=r"overflow: top = 0.0.*give the tank's"):
        Overflow(top=0.0)

"""The tank that empties through a hole: Torricelli's law, its rim, what it refuses."""

import numpy as np
import pytest

from blocks import BlockError, Tank
from diagram import drive


def test_it_empties_as_torricelli_says():
    log = drive(Tank(A=2.0, k=0.5, start=4.0), 10.0, every=1.0, rtol=1e-9, q_in=0.0).log
    np.testing.assert_allclose(log["h"], (2.0 - 0.5 * log.t / 4.0) ** 2, atol=1e-7)  # analytic
    np.testing.assert_allclose(log["q_out"], 0.5 * np.sqrt(log["h"]), atol=1e-9)


def test_nothing_is_lost_at_the_rim():
    flow = ([0.0, 10.0, 20.0], [0.0, 4.0, 0.0])
    run = drive(Tank(A=2.0, k=0.5, top=3.0), 20.0, every=0.01, rtol=1e-8, q_in=flow)
    log = run.log
    assert log["h"].max() == pytest.approx(3.0, abs=1e-12) and log["q_over"].max() > 1.0
    net = np.interp(log.t, *flow) - log["q_out"] - log["q_over"]
    held = 2.0 * log["h"][-1]
    assert np.trapezoid(net, log.t) == pytest.approx(held, abs=2e-3)  # balance
    assert [event.after for event in run.events] == ["running over", "filling"]


@pytest.mark.parametrize("bad", [{"A": 0.0}, {"k": -1.0}, {"top": 0.0}])
def test_what_no_tank_is(bad):
    with pytest.raises(BlockError, match=f"{next(iter(bad))} = "):
        Tank(**bad)

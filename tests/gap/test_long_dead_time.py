"""Dead times of many scans, which a filter keeps as a few values each."""

import numpy as np
import pytest
from stickslip.blocks import Equations, FirstOrder, Noise, SampledPI, SampledSensor, Sum
from stickslip.diagram import simulate, wire
from stickslip.gap import diagnose
from stickslip.gap.effects import effect
from stickslip.logs import Log


def _opened(OP):
    return OP * (0.7 + 0.006 * OP)


def oven(theta):
    """A temperature that answers ``theta`` [s] late behind a valve that bends, its controller scanning each second."""
    return wire(
        [
            SampledPI(2.0, 300.0, dt=1.0, high=100.0, start_op=50.0),
            Equations("valve", out=_opened, inputs="OP", outputs="MV").with_role("valve", OP="OP", MV="MV"),
            FirstOrder(0.6, 300.0, theta, start=30.0, inputs="MV", outputs="heated"),
            Noise("inflow", sd=0.1, dt=1.0, correlation_time=300.0, mean=35.0, name="feed"),
            Sum("T", {"heated": 1.0, "inflow": 1.0}, name="oven"),
            SampledSensor(1.0, sd=0.05, start=65.0, inputs="T", outputs="PV"),
        ],
        inputs=["SP"],
    )


@pytest.mark.parametrize(("own", "more"), [(0.0, 45.0), (40.0, 30.0)])
def test_a_dead_time_of_more_than_25_scans_is_named_with_its_size(own, more):
    t = np.arange(0.0, 7200.0, 5.0)
    SP = np.select([t < end for end in (1400.0, 3000.0, 4400.0, 6000.0)], [65.0, 75.0, 60.0, 72.0], 65.0)
    log = simulate(oven(own + more), 7200.0, times=t, inputs=Log(t, {"SP": SP}), signals=["SP", "PV", "OP"]).log
    logged = Log(t, {"SP": SP, "PV": np.round(log["PV"][: len(t)], 2), "OP": np.round(log["OP"][: len(t)], 2)})
    known = [effect("dead_time"), effect("process_gain")]
    (cause,) = diagnose(oven(own), logged, catalogue=known, limits=False).causes
    assert cause.effect == "dead_time"
    assert cause.parameters["theta"].value == pytest.approx(more, abs=3.0)

"""A continuous controller behind a sensor that samples more often than the log, with a load that nobody measures."""

import numpy as np
import pytest
from stickslip.blocks import PI, FirstOrder, IdealValve, Noise, SampledSensor, Sum
from stickslip.diagram import simulate, wire
from stickslip.gap import diagnose
from stickslip.gap.effects import effect
from stickslip.logs import Log

T = np.arange(0.0, 1800.0, 4.0)
SP = np.repeat([0.5, 0.6, 0.45], 150)


def loop(gain=1.0):
    """Return the loop; the load's block is called as one likes to call it."""
    return wire(
        [
            PI(2.0, 60.0, start_op=0.5),
            IdealValve(),
            Noise("load", sd=0.02, dt=1.0, correlation_time=60.0, seed=3),
            Sum("q", {"MV": 1.0, "load": 1.0}),
            FirstOrder(gain, 40.0, theta=3.0, start=0.5, inputs="q", outputs="y"),
            SampledSensor(dt=1.0, sd=0.002, start=0.5, inputs="y", outputs="PV", seed=1),
        ],
        inputs=["SP"],
    )


@pytest.mark.parametrize(("gain", "named"), [(1.0, []), (2.0, ["process_gain"])])
def test_a_gap_is_named_where_there_is_one(gain, named):
    log = simulate(loop(gain), T[-1], times=T, inputs=Log(T, {"SP": SP})).log
    catalogue = [effect(name) for name in ("step_disturbance", "process_gain")]
    log = Log(T, {s: log[s] for s in ("SP", "OP", "PV")})
    report = diagnose(loop(), log, catalogue=catalogue, limits=False)
    assert [cause.effect for cause in report.causes] == named, report

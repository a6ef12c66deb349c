"""Effects at a valve that holds its characteristic: the stem stands before the law, gain and leak are of the flow."""

import math

import numpy as np
import pytest
from stickslip.blocks import Equations, FirstOrder, QuasiStaticStem
from stickslip.diagram import simulate, wire
from stickslip.gap.effects import effect
from stickslip.gap.insertion.bent_valve import gives_flow
from stickslip.logs import Log

T = np.arange(0.0, 400.0)
OP = 0.5 + 0.3 * np.sin(T / 25.0) + 0.04 * np.sin(T / 3.0)


def law(OP):
    return 30.0**-OP


def valve():
    """Return an air-to-close valve of equal percentage, in one block of functions."""
    block = Equations("valve", out=lambda OP: 30.0**-OP, inputs="OP", outputs="f")
    lag = FirstOrder(1.0, 5.0, inputs="f", outputs="PV")
    return wire([block.with_role("valve", OP="OP", MV="f"), lag], inputs=["OP"])


def ran(diagram, signal):
    return simulate(diagram, T[-1], times=T, inputs=Log(T, {"OP": OP})).log[signal]


def test_a_stem_sticks_before_the_law_and_in_percent_of_op():
    stem = simulate(
        wire([QuasiStaticStem(0.06, 0.02, low=-np.inf, high=np.inf, start=OP[0])], inputs=["OP"]),
        T[-1], times=T, inputs=Log(T, {"OP": OP}),
    ).log["MV"]  # fmt: skip
    sticky = effect("stiction").insert(valve(), "valve", S=6.0, J=2.0)
    found = ran(sticky.starting_at({"valve:stiction.x": OP[0]}), "f")
    np.testing.assert_allclose(found, law(stem), rtol=1e-9)
    assert np.max(np.abs(np.log(found / law(OP)))) > 0.05  # and it does stick


def test_a_gain_and_a_leak_are_of_the_flow():
    plain = ran(valve(), "PV")  # of a lag, which is linear
    np.testing.assert_allclose(ran(effect("valve_gain").insert(valve(), "valve", factor=0.75), "PV"), 0.75 * plain)
    leak = ran(effect("valve_leak").insert(valve(), "valve", flow=5.0), "PV") - plain
    np.testing.assert_allclose(leak, leak[-1] * (1.0 - np.exp(-T / 5.0)), atol=1e-6)
    assert leak[-1] > 0.0


@pytest.mark.parametrize(
    ("out", "bent"),
    [(law, True), (lambda OP: 2.0 * OP, False), (lambda OP: max(OP, 0.5), False), (lambda OP: math.log(OP), False)],
)
def test_what_gives_its_stem_or_half_of_a_split_range_is_no_flow(out, bent):
    block = Equations("valve", out=out, inputs="OP", outputs="MV").with_role("valve", OP="OP", MV="MV")
    assert gives_flow(wire([block], inputs=["OP"]), "valve") == bent

"""Selectors: numpy's minimum and maximum as oracles, located hand-overs, override control."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from stickslip.blocks.first_order import FirstOrder
from stickslip.blocks.periodic import Sine
from stickslip.blocks.pi import PI
from stickslip.blocks.ports import BlockError
from stickslip.blocks.recorded import Staircase
from stickslip.blocks.select import MaxSelect, MinSelect
from stickslip.blocks.sources import Constant, Step
from stickslip.diagram import simulate, wire
from stickslip.diagram.reference import simulate_reference

PAIRS = [(MinSelect, np.minimum), (MaxSelect, np.maximum)]


@pytest.mark.parametrize(("block", "oracle"), PAIRS)
@given(u=st.lists(st.floats(-1e3, 1e3), min_size=2, max_size=6))
def test_static(block, oracle, u):
    selector = block("y", [f"u_{i}" for i in range(len(u))])
    assert float(selector.output(0.0, [], u)[0]) == oracle.reduce(u)


@pytest.mark.parametrize(("block", "oracle"), PAIRS)
def test_compiled_with_located_hand_overs(block, oracle):
    waves = [Sine("a", 1.0, 10.0), Sine("b", 0.8, 7.0, phase=1.0), Staircase("c", [0.5, -0.6, 0.1], dwell=9.0)]
    run = simulate(wire([*waves, block("y", ["a", "b", "c"])]), 30.0, every=0.01)
    expected = oracle(oracle(run.log["a"], run.log["b"]), run.log["c"])
    np.testing.assert_allclose(run.log["y"], expected, atol=1e-12)
    for event in run.events[1:]:
        if event.t not in (9.0, 18.0):  # jumps of c
            t = event.t
            value = {"a": np.sin(2 * np.pi * t / 10), "b": 0.8 * np.sin(2 * np.pi * t / 7 + 1)}
            value["c"] = 0.5 if t < 9 else -0.6 if t < 18 else 0.1
            assert value[event.before] == pytest.approx(value[event.after], abs=1e-9)
    assert {event.after for event in run.events} <= {"a", "b", "c"} and run.statistics.steps < 400


def override():
    flow = PI(0.5, 5.0, name="flow", outputs="OP_flow")
    limit = Constant("OP_max", 0.4)
    return wire([Step("SP", 2.0), flow, limit, MinSelect("MV", ["OP_flow", "OP_max"]), FirstOrder(3.0, 5.0)])


def test_override_in_a_loop_agrees_with_the_reference():
    ours = simulate(override(), 60.0, every=1.0, rtol=1e-10, atol=1e-12)
    theirs = simulate_reference(override(), 60.0, every=1.0)
    np.testing.assert_allclose(ours.log["PV"], theirs.log["PV"], atol=1e-8)
    assert ours.log["PV"][-1] == pytest.approx(1.2, abs=1e-4)  # analytic: 3 x 0.4
    assert simulate(override(), 600.0).statistics.steps < 200


def test_equal_signals_hand_nothing_over():
    parts = [Sine("a", 1.0, 10.0), Sine("b", 1.0, 10.0), MinSelect("y", ["a", "b"])]
    run = simulate(wire(parts), 100.0)
    assert run.ok and run.events == ()


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: MinSelect("y", ["a"]), "there are two or more to select from"),
        (lambda: MinSelect("y", ["a", "b"]).with_params(n=3), "n = 3.0, but the selector has 2 inputs"),
        (lambda: MinSelect("y", ["a", "b"]).with_params(sign=-1), "sign = -1.0, but it is as built"),
        (lambda: MaxSelect("y", ["a", "a"]), "two ports called 'a'"),
    ],
)
def test_misuse_is_explained(make, words):
    with pytest.raises(BlockError, match=words):
        make()

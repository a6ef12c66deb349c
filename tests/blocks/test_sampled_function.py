"""A Python function called every dt: when, with what, and what state it keeps."""

import numpy as np
import pytest
from stickslip.blocks import FirstOrder, SampledFunction, SampledPI, Step
from stickslip.diagram import drive, simulate, wire


def test_it_is_called_at_its_instants_with_values_by_name():
    calls = []

    def note(t, PV, gain=2.0):
        calls.append((t, PV))
        return gain * PV

    block = SampledFunction("note", note, dt=1.0, offset=0.5, inputs="PV", outputs="y", start_output=-1.0)
    run = drive(block, 3.0, every=0.5, PV=([0.0, 3.0], [0.0, 3.0]))
    assert calls == [pytest.approx(pair) for pair in [(0.5, 0.5), (1.5, 1.5), (2.5, 2.5)]]
    np.testing.assert_allclose(run.log["y"], [-1.0, 1.0, 1.0, 3.0, 3.0, 5.0, 5.0])


def controller(state, SP, PV, dt, K_p, T_i):
    e = SP - PV
    return state + dt * K_p * e / T_i, K_p * e + state


def test_a_controller_written_as_a_function_is_the_block():
    """Oracle: the compiled SampledPI, which shares no code with it."""
    own = SampledFunction(
        "own", controller, dt=0.5, inputs=["SP", "PV"], outputs="OP", params={"K_p": 0.4, "T_i": 5.0}, state=0.0
    )
    rest = [Step("SP", 0.5), FirstOrder(3.0, 10.0, inputs="OP")]
    compiled = SampledPI(0.4, 5.0, dt=0.5, low=-9.0, high=9.0)
    ours, theirs = (simulate(wire([*rest, block]), 60.0, every=0.5).log["PV"] for block in (own, compiled))
    np.testing.assert_allclose(ours, theirs, atol=1e-12)
    assert ours[-1] > 0.4


def test_every_run_begins_with_a_copy_of_the_state():
    def history(state, u):
        state.append(u)
        return state, len(state)

    block = SampledFunction("history", history, dt=1.0, inputs="u", outputs="n", state=[])
    for _ in range(2):
        assert drive(block, 2.0, every=1.0, u=0.0).log["n"].tolist() == [1.0, 2.0, 3.0]


def test_several_outputs_and_no_state():
    block = SampledFunction("both", lambda a, b: np.array([a + b, a - b]), dt=1.0, inputs=["a", "b"],
                            outputs=["sum", "difference"], labels={"sum": "total"})  # fmt: skip
    log = drive(block, 1.0, every=1.0, a=3.0, b=1.0).log
    assert (log["total"][0], log["difference"][0]) == (4.0, 2.0)


REFUSALS = {
    "unknown": (lambda: SampledFunction("f", lambda MW: 0.0, dt=1.0, inputs="MV", outputs="y"), ["did you mean 'MV'"]),
    "dt": (lambda: SampledFunction("f", lambda MV: 0.0, dt=0.0, inputs="MV", outputs="y"), ["dt = 0.0"]),
    "twice": (
        lambda: SampledFunction("f", lambda u: 0.0, dt=1.0, inputs="u", outputs="y", params={"u": 1.0}), ["twice"],
    ),
    "count": (
        lambda: drive(SampledFunction("f", lambda u: (1, 2), dt=1.0, inputs="u", outputs="y"), 1.0, u=0.0),
        ["(1, 2)", "1 output"],
    ),
    "no return": (
        lambda: drive(SampledFunction("f", lambda u: None, dt=1.0, inputs="u", outputs="y"), 1.0, u=0.0),
        ["f: step returns None", "return one number each"],
    ),
    "no number": (
        lambda: drive(SampledFunction("f", lambda u: "high", dt=1.0, inputs="u", outputs="y"), 1.0, u=0.0),
        ["f: step returns 'high'", "return one number each"],
    ),
    "no state back": (
        lambda: drive(SampledFunction("f", lambda state, u: u, dt=1.0, inputs="u", outputs="y"), 1.0, u=0.0),
        ["return (next state, outputs)"],
    ),
}  # fmt: skip


@pytest.mark.parametrize("what", REFUSALS)
def test_refusals(refuses, what):
    refuses(*REFUSALS[what])


def test_an_error_of_the_function_says_where_it_was_called():
    block = SampledFunction("filter", lambda u: 1.0 / (u - 3.0), dt=1.0, inputs="u", outputs="y")
    with pytest.raises(ZeroDivisionError) as caught:
        drive(block, 2.0, every=1.0, u=3.0)
    assert "filter: step failed at t = 0 s with inputs [3.0]" in caught.value.__notes__

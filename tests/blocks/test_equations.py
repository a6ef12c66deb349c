"""Blocks from plain functions: arguments by name, compiled where possible, called in Python where not."""

import importlib.util
import math

import numpy as np
import pytest
from stickslip.blocks import Equations
from stickslip.diagram import drive, simulate, wire
from stickslip.engine.call import address

GRAVITY = 9.81


def outflow(h, k):
    return k * math.sqrt(max(h, 0.0))


def tank_rate(h, q, area, k):
    return (q - outflow(h, k)) / area


def lag(**changes):
    return Equations("lag", **({
        "der": lambda PV, MV, K, tau: (K * MV - PV) / tau, "states": {"PV": 0.0}, "inputs": "MV",
        "params": {"K": 3.0, "tau": 10.0},
    } | changes))  # fmt: skip


def test_arguments_are_bound_by_name_in_any_order():
    block = lag(der=lambda tau, MV, K, PV: (K * MV - PV) / tau)
    run = drive(block, 20.0, every=5.0, rtol=1e-9, atol=1e-12, MV=0.5)
    np.testing.assert_allclose(run.log["PV"], 1.5 * (1.0 - np.exp(-run.log.t / 10.0)), atol=1e-8)  # analytic
    assert run.in_python == ()


def test_parameters_change_without_new_code():
    first, second = lag(), lag(params={"K": 1.0, "tau": 2.0})
    run = drive(second.with_params(K=4.0), 40.0, every=40.0, MV=1.0)
    assert run.log["PV"][-1] == pytest.approx(4.0, abs=1e-4)
    there = {address(block.kernels.der) for block in (first, second)}
    assert len(there) == 1, "one lambda is compiled once, however many blocks use it"


def test_helpers_constants_and_defaults():
    block = Equations(
        "tank", der=tank_rate, states={"h": 4.0}, inputs=["q"], params={"area": 2.0, "k": 0.5},
        out=lambda h, rho=1000.0: (h, rho * GRAVITY * h), outputs=["level", "p"], labels={"level": "LT"},
    )  # fmt: skip
    assert block.param_names == ("area", "k", "rho") and block.output_labels == ["LT", "p"]
    assert not block.kernels.feeds
    log = drive(block, 400.0, every=200.0, q=1.0).log
    np.testing.assert_allclose(log["LT"], 4.0, atol=1e-9)  # analytic: rests at (q/k)^2
    np.testing.assert_allclose(log["p"], 4.0 * 9810.0, rtol=1e-9)


def test_values_from_around_a_function_are_its_own():
    def scaled(factor):
        return Equations("gain", out=lambda u: factor * u, inputs="u", outputs="y")

    for factor in (2.0, 5.0):
        assert drive(scaled(factor), 1.0, every=1.0, u=1.0).log["y"].tolist() == [factor, factor]


def test_an_output_that_takes_an_input_follows_it_at_once():
    assert Equations("g", out=lambda u: 2.0 * u, inputs="u", outputs="y").kernels.feeds
    loop = [Equations("a", out=lambda y2: y2, inputs="y2", outputs="y1")]
    with pytest.raises(ValueError, match="algebraic loop"):
        wire([*loop, Equations("b", out=lambda y1: y1, inputs="y1", outputs="y2")])


def test_what_cannot_be_compiled_runs_in_python_with_the_same_result():
    def slow(PV, MV, K, tau):
        return sum(rate for rate in [(K * MV - PV) / tau])  # the compiler knows no generators

    run = drive(lag(der=slow), 20.0, every=5.0, MV=0.5)
    np.testing.assert_array_equal(run.log["PV"], drive(lag(), 20.0, every=5.0, MV=0.5).log["PV"])
    (entry,) = run.in_python
    assert entry.blocks == ("lag",) and entry.calls >= run.statistics.rhs and entry.seconds > 0.0
    assert "cannot be compiled" in entry.reason
    assert "calls in Python" in repr(run) and "lag" in repr(run)
    again = drive(lag(der=slow), 20.0, every=5.0, MV=0.5)
    assert again.in_python[0].calls == entry.calls, "each run counts its own"


def test_the_reason_names_what_the_compiler_does_not_know():
    from scipy import special

    run = drive(lag(der=lambda PV, MV, K, tau: (K * MV - PV) / tau * special.gamma(2.0)), 20.0, every=5.0, MV=0.5)
    np.testing.assert_array_equal(run.log["PV"], drive(lag(), 20.0, every=5.0, MV=0.5).log["PV"])  # gamma(2) = 1
    assert "'gamma'" in run.in_python[0].reason and "/" not in run.in_python[0].reason


def test_an_exception_comes_out_as_it_went_in():
    def strict(PV, MV):
        if PV > 0.5:
            raise ArithmeticError(f"level {PV:.1f} is too high")
        return str(MV) and 1.0

    block = Equations("strict", der=strict, states={"PV": 0.0}, inputs="MV")
    with pytest.raises(ArithmeticError, match="too high") as caught:
        drive(block, 5.0, MV=0.0)
    assert "t = " in caught.value.__notes__[0]
    assert drive(lag(), 1.0, MV=0.0).ok, "the next run is not disturbed"


def test_an_interrupt_in_a_python_function_ends_the_run():
    calls = []

    def stopped(PV, MV):
        calls.append(1)
        if len(calls) > 50:
            raise KeyboardInterrupt
        return MV - PV

    run = drive(Equations("stopped", der=stopped, states={"PV": 0.0}, inputs="MV"), 1e4, MV=([0, 1e4], [0.0, 1e4]))
    assert run.status.name == "INTERRUPTED"


def test_time_is_an_argument_too():
    block = Equations("ramp", der=lambda t: 2.0 * t, states={"x": 1.0})
    run = simulate(wire([block], outputs=["x"]), 3.0, every=1.0)
    np.testing.assert_allclose(run.log["x"], [1.0, 2.0, 5.0, 10.0], atol=1e-8)  # 1 + t^2


def test_it_runs_in_a_loop_and_in_python_control():
    import control as ct

    gain = Equations("P", out=lambda PV, SP, K_p=2.0: K_p * (SP - PV), inputs=["PV", "SP"], outputs="MV")
    loop = wire([lag(), gain], inputs=["SP"])
    assert simulate(loop, 100.0, inputs={"SP": 0.5}).log["PV"][-1] == pytest.approx(3.0 / 7.0, abs=1e-5)  # 6 x 0.5 / 7
    assert ct.linearize(loop, loop.x0, [0.5]).poles() == pytest.approx([-0.7], abs=1e-6)  # analytic: -(1 + 6)/10


REFUSALS = {
    "unknown": (lambda: lag(der=lambda PV, MW, K, tau: 0.0), ["'MW'", "did you mean 'MV'"]),
    "twice": (lambda: lag(params={"K": 1.0, "tau": 1.0, "MV": 2.0}), ["'MV' is used twice"]),
    "t": (lambda: lag(params={"K": 1.0, "tau": 1.0, "t": 2.0}), ["'t' is used twice"]),
    "count": (lambda: lag(der=lambda PV: (1.0, 2.0)), ["2 values", "1 are needed"]),
    "too few": (
        lambda: Equations("v", der=lambda x: x, states={"x": 0.0, "v": 0.0}), ["1 value", "return a tuple of 2"],
    ),
    "star": (lambda: lag(der=lambda *all_of_them: 0.0), ["*all_of_them", "by name"]),
    "no der": (lambda: lag(der=None), ["give both der= and states="]),
    "outputs": (lambda: lag(outputs="level"), ["level", "give out="]),
    "label": (lambda: lag(labels={"pv": "x"}), ["no port 'pv'", "did you mean 'PV'"]),
    "states without starts": (lambda: lag(states=["PV"]), ["states = ['PV']", "start value", "{'PV': 0.0}"]),
    "no function": (lambda: lag(der=3.0), ["lag", "3.0 is no function"]),
    "param": (lambda: lag(params={"K": "big", "tau": 1.0}), ["K = 'big'"]),
}  # fmt: skip


@pytest.mark.parametrize("what", REFUSALS)
def test_refusals(refuses, what):
    refuses(*REFUSALS[what])


def test_functions_of_a_file_that_was_loaded_without_a_name_are_compiled(tmp_path):
    # as a notebook, or a script of the user's, loads a model: no module of that name is to be found again
    file = tmp_path / "model_of_mine.py"
    file.write_text("def rate(PV, MV, K, tau):\n    return (K * MV - PV) / tau\n")
    spec = importlib.util.spec_from_file_location("model_of_mine", file)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    run = drive(lag(der=module.rate), 20.0, every=5.0, MV=0.5)
    assert run.in_python == ()
    np.testing.assert_array_equal(run.log["PV"], drive(lag(), 20.0, every=5.0, MV=0.5).log["PV"])

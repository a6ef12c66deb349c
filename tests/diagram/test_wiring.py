"""Every way to wire wrongly is refused with the signals it concerns and the nearest right name."""

import re

import numpy as np
import pytest
from stickslip.blocks import PI, Constant, FirstOrder, IdealValve, MinSelect, SampledPI, Step, StickSlip, Sum
from stickslip.blocks.ports import BlockError
from stickslip.diagram import WiringError, simulate, wire


def parts(**names):
    return [Step("SP", 0.5), PI(0.4, 10.0), StickSlip(), FirstOrder(3.0, 10.0)]


WRONG = {
    "unknown": (lambda: wire([Step("SPP", 0.5), *parts()[1:]]), ["SP", "controller", "did you mean 'SPP'"]),
    "dangling": (lambda: wire([*parts()[:2], parts()[3]]), ["'MV'", "process", "inputs=['MV']"]),
    "doubly driven": (lambda: wire([*parts(), FirstOrder(1.0, 1.0, name="p2")]), ["'PV'", "process", "p2", "Sum"]),
    "same name": (lambda: wire([*parts(), FirstOrder(1.0, 1.0, outputs="x")]), ["'process'", "name="]),
    "units": (
        lambda: wire([Step("SP", 50.0, unit="%"), PI(0.4, 10.0, units={"SP": "bar"}), *parts()[2:]]),
        ["'SP'", "[%]", "[bar]", "Gain"],
    ),
    "algebraic loop": (
        lambda: wire([Step("SP", 0.5), PI(0.4, 10.0), IdealValve(outputs="PV")]),
        ["controller", "valve", "(OP)", "(PV)", "algebraic loop"],
    ),
    "unread source": (lambda: wire([*parts(), Constant("load", 1.0)]), ["'load'", "outputs="]),
    "unknown output": (lambda: wire(parts(), outputs=["PVV"]), ["'PVV'", "did you mean 'PV'"]),
    "unread input": (lambda: wire(parts(), inputs=["SPX"]), ["'SPX'", "did you mean 'SP'"]),
    "driven input": (lambda: wire(parts(), inputs=["SP"]), ["'SP'", "take it out"]),
    "not a block": (lambda: wire([3.0]), ["3.0", "neither a block nor a diagram"]),
    "part": (lambda: wire(parts()).part(["valv"]), ["'valv'", "did you mean 'valve'"]),
    "without": (lambda: wire(parts()).without("controler"), ["did you mean 'controller'"]),
    "replace": (lambda: wire(parts()).replace("valve", PI(1.0, 1.0, name="x")), ["1 inputs", "must agree"]),
    "parameter": (lambda: wire(parts()).with_params({"valve.F_S": 1.0}), ["did you mean 'F_s'"]),
    "block of a parameter": (lambda: wire(parts()).with_params({"vlave.F_s": 1.0}), ["did you mean 'valve'"]),
    "no block of a parameter": (lambda: wire(parts()).with_params({"F_s": 1.0}), ["'valve.F_s'"]),
    "start": (lambda: wire(parts()).starting_at({"process.pv": 1.0}), ["did you mean 'PV'"]),
    "mode": (lambda: wire(parts()).in_mode("idle"), ["did you mean 'ideal'"]),
    "mode of a block": (lambda: wire(parts()).in_mode({"valve": "stuk"}), ["did you mean 'stuck'"]),
    "open input": (lambda: simulate(wire(parts()[1:], inputs=["SP"]), 1.0), ["'SP'", "inputs={'SP': 0.0}"]),
    "input of simulate": (lambda: simulate(wire(parts()), 1.0, inputs={"SP": 1.0}), ["no open input 'SP'"]),
    "kind of input": (
        lambda: simulate(wire(parts()[1:], inputs=["SP"]), 1.0, inputs={"SP": "half"}),
        ["'SP'", "str", "source block"],
    ),
    "label of named": (lambda: wire(parts()[1:], inputs=["SP"]).named("a", Sp="x"), ["did you mean 'SP'"]),
}


@pytest.mark.parametrize(
    ("inputs", "outputs", "says"),
    [
        (["SP"], ["OP"], r"has 2 inputs \(SP, PV\), but 1 labels were given"),
        (["SP", "PV", "x"], ["OP"], r"has 2 inputs \(SP, PV\), but 3 labels were given"),
        (["SP", "PV"], [], r"has 1 outputs \(OP\), but 0 labels were given"),
        (["SP", "SP"], ["OP"], r"two inputs labelled 'SP'"),
    ],
)
def test_labels_too_many_or_too_few_are_refused(inputs, outputs, says):
    with pytest.raises(BlockError, match=says):
        PI(0.4, 10.0).relabelled("PI", inputs, outputs)


def test_what_only_a_removed_block_reads_goes_with_it():
    loop = wire([Step("SP", 0.5), *parts()[1:]])
    left = loop.without("controller")
    assert [block.name for block in left.blocks] == ["valve", "process"] and left.open_inputs == ("OP",)
    shared = wire([Step("SP", 0.5), *parts()[1:], Sum("e", {"SP": 1.0, "PV": -1.0})]).without("controller")
    assert "SP" in shared.signals  # another block still reads it


@pytest.mark.parametrize("what", WRONG)
def test_refusals(what):
    attempt, words = WRONG[what]
    with pytest.raises(ValueError) as caught:
        attempt()
    for word in words:
        assert word in str(caught.value), (word, str(caught.value))


def test_an_algebraic_loop_names_its_signals_in_order():
    with pytest.raises(WiringError) as caught:
        wire([Sum("a", {"c": 0.5}), Sum("b", {"a": 1.0}), Sum("c", {"b": 1.0})])
    chain = re.findall(r"'(\w)' -\((\w)\)->", str(caught.value))
    assert [block for block, _ in chain] == [signal for _, signal in chain]
    assert {signal for _, signal in chain} == {"a", "b", "c"}


def test_order_of_the_list_does_not_matter():
    one = simulate(wire(parts()), 50.0, every=1.0)
    other = simulate(wire(parts()[::-1]), 50.0, every=1.0)
    for signal in one.log.names:
        np.testing.assert_allclose(one.log[signal], other.log[signal], atol=1e-9)


def test_units_that_agree_are_kept():
    loop = wire([Step("SP", 50.0, unit="%"), PI(0.4, 10.0, units={"SP": "%", "PV": "%"}), *parts()[2:]])
    assert loop.signal_units["SP"] == "%"
    assert simulate(loop, 1.0).log.units["SP"] == "%"


@pytest.mark.parametrize(
    "block",
    [
        PI(1.0, 10.0, inputs={"SP": "a", "PV": "b"}),
        SampledPI(1.0, 10.0, dt=1.0, inputs={"SP": "a", "PV": "b"}),
        Sum("y", {"a": 1.0, "b": -1.0}),
        MinSelect("y", ["a", "b"]),
    ],
    ids=lambda block: type(block).__name__,
)
def test_signals_that_have_one_unit_in_a_block_may_not_state_two(block):
    a, b = Constant("a", 1.0, unit="bar"), Constant("b", 1e5, unit="Pa")
    with pytest.raises(WiringError, match=r"mismatched units: 'a' in \[bar\] and 'b' in \[Pa\]"):
        wire([a, b, block])
    wire([a, Constant("b", 1.0), block])  # not stated: free


def test_a_sum_may_convert_units_with_its_weights():
    wire([Constant("a", 1.0, unit="bar"), Constant("b", 1e5, unit="Pa"), Sum("y", {"a": 1.0, "b": 1e-5})])

"""Sum and gain; expected numbers are analytic."""

import math

import pytest
from stickslip.blocks.arithmetic import Gain, Sum
from stickslip.blocks.sources import Constant
from stickslip.diagram import ensemble, simulate, wire


def test_sum_weighs_its_inputs():
    parts = [Constant("A", 2.0), Constant("B", 3.0), Constant("C", 5.0)]
    total = Sum("y", {"A": 1.0, "B": -2.0, "C": 0.5}, offset=10.0)
    log = simulate(wire([*parts, total], outputs=["y"]), 1.0, every=1.0).log
    assert log["y"].tolist() == [8.5, 8.5]
    assert float(total.with_params(w_B=0.0).output(0.0, [], [2.0, 3.0, 5.0])[0]) == 14.5


@pytest.mark.parametrize("names", [("PV", "n"), ("n", "offset"), ("offset", "w_offset"), ("out", "p"), ("i", "total")])
def test_an_input_may_have_any_name(names):
    """A signal called as the sum's own parameter, port or anything else is a signal like any other (analytic)."""
    total = Sum("y", dict.fromkeys(names, 1.0), offset=0.5, unit="bar")
    sources = [Constant(name, value) for name, value in zip(names, (2.0, 5.0), strict=True)]
    diagram = wire([*sources, total], outputs=["y"])
    assert simulate(diagram, 1.0, every=1.0).log["y"].tolist() == [7.5, 7.5]
    assert simulate(diagram, 1.0, every=1.0, params={f"y.w_{names[1]}": -1.0}).log["y"].tolist() == [-2.5, -2.5]
    assert ensemble(diagram, 1.0, every=1.0, params={f"y.w_{names[1]}": [0.0, 2.0]}).values["y"][:, 0].tolist() == [
        2.5, 12.5,
    ]  # fmt: skip
    assert float(total.output(0.0, [], [2.0, 5.0])[0]) == 7.5
    assert diagram.signal_units == {names[0]: "", names[1]: "", "y": "bar"}  # the inputs keep their own unit


def test_gain_and_offset_convert_units():
    fahrenheit = Gain("T_F", "T_C", 1.8, offset=32.0, unit="degF")
    assert float(fahrenheit.output(0.0, [], [100.0])[0]) == pytest.approx(212.0)
    assert fahrenheit.units["out"] == "degF"


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Sum("y", {}), ["weights", "at least one"]),
        (lambda: Sum("y", {"A": 1.0}).with_params(n=3), ["no parameter 'n'", "offset, w_A"]),
        (lambda: Sum("y", {"A": math.inf}), ["w_A = inf", "finite"]),
        (lambda: Gain("y", "u", math.nan), ["factor = nan"]),
    ],
)
def test_misuse_is_refused_with_value_rule_and_remedy(refuses, make, words):
    refuses(make, words)

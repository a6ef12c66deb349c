"""Sum and gain; expected numbers are analytic."""

import math

import pytest

from blocks.arithmetic import Gain, Sum
from blocks.ports import BlockError
from blocks.sources import Constant
from plant import simulate, wire


def test_sum_weighs_its_inputs():
    parts = [Constant("A", 2.0), Constant("B", 3.0), Constant("C", 5.0)]
    total = Sum("y", {"A": 1.0, "B": -2.0, "C": 0.5}, offset=10.0)
    log = simulate(wire([*parts, total], outputs=["y"]), 1.0, every=1.0).log
    assert log["y"].tolist() == [8.5, 8.5]
    assert float(total.with_params(B=0.0).output(0.0, [], [2.0, 3.0, 5.0])[0]) == 14.5


def test_gain_and_offset_convert_units():
    fahrenheit = Gain("T_F", "T_C", 1.8, offset=32.0, unit="degF")
    assert float(fahrenheit.output(0.0, [], [100.0])[0]) == pytest.approx(212.0)
    assert fahrenheit.units["out"] == "degF"


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Sum("y", {}), ["weights", "at least one"]),
        (lambda: Sum("y", {"A": 1.0}).with_params(n=3), ["n = 3.0", "1 inputs"]),
        (lambda: Sum("y", {"A": math.inf}), ["A = inf", "finite"]),
        (lambda: Gain("y", "u", math.nan), ["factor = nan"]),
    ],
)
def test_misuse_is_refused_with_value_rule_and_remedy(make, words):
    with pytest.raises(BlockError) as error:
        make()
    for word in words:
        assert word in str(error.value)

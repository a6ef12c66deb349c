"""Product and quotient: numpy as oracle, the denominator's limit located; expected numbers are analytic."""

import math

import numpy as np
import pytest
from stickslip.blocks.periodic import Sine
from stickslip.blocks.ports import BlockError
from stickslip.blocks.product import Divide, Product
from stickslip.blocks.sources import Ramp
from stickslip.diagram import simulate, wire
from stickslip.diagram.reference import simulate_reference


def test_product_of_signals():
    parts = [Sine("a", 2.0, 10.0, mean=1.0), Ramp("b", 0.3), Product("y", ["a", "b"], factor=-2.0)]
    log = simulate(wire(parts), 20.0, every=0.1).log
    np.testing.assert_allclose(log["y"], -2.0 * log["a"] * log["b"], rtol=1e-14)
    assert float(Product("y", ["a"]).output(0.0, [], [7.0])[0]) == 7.0


def test_quotient_and_its_smallest_denominator():
    parts = [Ramp("a", 1.0, before=1.0), Sine("b", 1.0, 8.0, mean=0.5), Divide("y", "a", "b", low=0.25, factor=3.0)]
    ours = simulate(wire(parts), 8.0, every=0.1)
    np.testing.assert_allclose(ours.log["y"], 3.0 * ours.log["a"] / np.maximum(ours.log["b"], 0.25), rtol=1e-12)
    below = 8 * (math.pi + math.asin(0.25)) / (2 * math.pi)  # sin = -1/4
    assert [e.t for e in ours.events] == pytest.approx([below, 12.0 - below], abs=1e-9)
    assert [e.after for e in ours.events] == ["at low limit", "free"]
    theirs = simulate_reference(wire(parts), 8.0, every=0.1)
    np.testing.assert_allclose(ours.log["y"], theirs.log["y"], rtol=1e-12)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Product("y", []), "a product needs an input"),
        (lambda: Product("y", ["a"], factor=math.inf), "factor = inf"),
        (lambda: Product("y", ["a"]).with_params(n=2), "n = 2.0, but the product has 1 inputs"),
        (lambda: Divide("y", "a", "b", low=0.0), "low = 0.0, but it must be positive"),
        (lambda: Divide("y", "a", "b", factor=math.nan), "factor = nan"),
    ],
)
def test_misuse_is_explained(make, words):
    with pytest.raises(BlockError, match=words):
        make()

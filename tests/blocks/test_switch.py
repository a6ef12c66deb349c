"""Switch: numpy's where as oracle, located switching, hysteresis; expected numbers are analytic."""

import math

import numpy as np
import pytest
from stickslip.blocks.integrator import Integrator
from stickslip.blocks.periodic import Sine
from stickslip.blocks.ports import BlockError
from stickslip.blocks.sources import Constant
from stickslip.blocks.switch import Switch
from stickslip.diagram import simulate, wire
from stickslip.diagram.reference import simulate_reference


def test_it_chooses_and_tells_when():
    parts = [Sine("c", 1.0, 10.0), Sine("a", 2.0, 3.0), Constant("b", -1.0), Switch("y", "c", above="a", below="b")]
    run = simulate(wire(parts), 20.0, every=0.03)
    np.testing.assert_array_equal(run.log["y"], np.where(run.log["c"] > 0.5, run.log["a"], run.log["b"]))
    # analytic: sin = 1/2 at 1/12 and 5/12 of the period
    assert [e.t for e in run.events] == pytest.approx([10 / 12, 50 / 12, 130 / 12, 170 / 12], abs=1e-9)
    assert [e.after for e in run.events] == ["above", "below"] * 2


def batch():
    """A tank filled until 0.9 and emptied until 0.2."""
    flows = [Constant("fill", 0.1), Constant("empty", -0.05)]
    choice = Switch("MV", "PV", above="empty", below="fill", switch_on=0.9, switch_off=0.2)
    return wire([*flows, choice, Integrator(1.0)])


def test_hysteresis_makes_a_batch():
    run = simulate(batch(), 100.0, every=1.0)
    # analytic: 0.9/0.1, then 0.7/0.05 and 0.7/0.1 in turn
    times = [e.t for e in run.events]
    assert times[0] == pytest.approx(9.0, abs=1e-9)
    assert np.diff(times) == pytest.approx(([14.0, 7.0] * 4)[: len(times) - 1], abs=1e-9)
    assert run.statistics.steps < 20 * len(times)
    theirs = simulate_reference(batch(), 100.0, every=1.0)
    np.testing.assert_allclose(run.log["PV"], theirs.log["PV"], atol=1e-7)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Switch("y", "c", above="a", below="b", switch_off=0.6), "switch_off = 0.6, but it switches off"),
        (lambda: Switch("y", "c", above="a", below="b", switch_on=math.nan), "switch_on = nan"),
    ],
)
def test_misuse_is_explained(make, words):
    with pytest.raises(BlockError, match=words):
        make()

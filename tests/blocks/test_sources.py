"""Constant, step, ramp: values on both sides of every discontinuity; expected numbers are analytic."""

import math

import numpy as np
import pytest
from stickslip.blocks.sources import Constant, Ramp, Step
from stickslip.diagram import simulate, wire


def at(block, t):
    return float(block.output(t, [], [])[0])


def upcoming(block, t):
    out = np.array([np.inf, np.inf])
    block.kernels.next_time(t, block.x0, block.d0, np.zeros(0), block.p, out)
    return out[0]


def test_step_switches_at_its_instant_and_announces_it():
    step = Step("SP", after=0.5, before=0.2, at=3.0)
    assert [at(step, t) for t in (0.0, np.nextafter(3.0, 0.0), 3.0, 9.0)] == [0.2, 0.2, 0.5, 0.5]
    assert upcoming(step, 0.0) == 3.0
    assert upcoming(step, 3.0) == math.inf


def test_ramp_follows_its_line_between_two_announced_kinks():
    ramp = Ramp("SP", slope=0.1, start=2.0, end=5.0, before=1.0)
    assert [at(ramp, t) for t in (0.0, 2.0, 4.0, 5.0, 99.0)] == pytest.approx([1.0, 1.0, 1.2, 1.3, 1.3])
    assert [upcoming(ramp, t) for t in (0.0, 2.0, 5.0)] == [2.0, 5.0, math.inf]


def test_ramp_without_end_goes_on():
    assert at(Ramp("SP", slope=-2.0), 1e6) == -2e6


def test_compiled_sources_equal_interpreted_ones():
    sources = [Constant("A", 2.5), Step("B", 0.7, 0.1, at=1.3), Ramp("C", slope=0.3, start=0.5, end=2.25, before=-1.0)]
    log = simulate(wire(sources, outputs=["A", "B", "C"]), 4.0, every=0.25).log
    for source, signal in zip(sources, "ABC", strict=True):
        np.testing.assert_array_equal(log[signal], [at(source, t) for t in log.t])


def test_units_and_names():
    block = Constant("p_in", 12e5, unit="Pa", name="suction")
    assert (block.name, block.output_labels, block.units) == ("suction", ["p_in"], {"out": "Pa"})


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Constant("SP", math.nan), ["SP", "value = nan", "finite"]),
        (lambda: Step("SP", after=math.inf), ["after = inf", "finite"]),
        (lambda: Ramp("SP", slope=1.0, start=5.0, end=1.0), ["end = 1.0", "before its start", "after start"]),
        (lambda: Constant("SP", 1.0).with_params(valeu=2.0), ["no parameter 'valeu'", "did you mean 'value'"]),
    ],
)
def test_misuse_is_refused_with_value_rule_and_remedy(refuses, make, words):
    refuses(make, words)

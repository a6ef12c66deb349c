"""The crude: cases 1 and 2, slugs, a trip."""

import numpy as np
import pytest
from stickslip.blocks.sources import Constant, Step
from stickslip.diagram import simulate
from stickslip.plant import SETS, InfeasibleFeed, feed, production_plant


def value(blocks, t):
    return [float(block.output(t, [], [])[0]) for block in blocks]


def test_sine_is_case_2():
    assert value(feed.sine(), 0.0) == [7600.0, 0.25]
    assert value(feed.sine(), 125.0)[1] == pytest.approx(0.35)  # published: table 5.2
    assert value(feed.sine(), 375.0)[1] == pytest.approx(0.15)
    assert value(feed.sine(), 500.0)[1] == pytest.approx(0.25)


def test_slugs_are_opposite_and_start_without_a_jump():
    blocks = feed.slugs(8000.0, period=100.0)
    assert value(blocks, 0.0) == [8000.0, 0.37]
    F, Z = value(blocks, 40.0)
    assert pytest.approx(8400.0) == F and pytest.approx(0.32) == Z  # top of the rise
    t = np.linspace(0.0, 100.0, 1001)
    assert np.mean([value(blocks, s)[0] for s in t[:-1]]) == pytest.approx(8000.0, abs=1.0)


def test_trip():
    blocks = feed.trip(8000.0)
    assert value(blocks, 0.0)[0] == 8000.0
    assert value(blocks, 15.0)[0] == pytest.approx(2400.0)
    assert value(blocks, 99.0)[0] == pytest.approx(2400.0)


def test_slugs_shake_the_plant():
    run = simulate(production_plant("B", feed=feed.slugs(period=200.0)), 600.0, every=1.0, method="stiff")
    assert run.ok
    assert np.ptp(run.log["p_1"]) > 0.3e5 and np.ptp(run.log["V_1"]) > 0.3


@pytest.mark.parametrize("name", SETS)
@pytest.mark.parametrize("make", [feed.constant, feed.sine, feed.slugs, feed.trip], ids=lambda make: make.__name__)
def test_the_plant_rests_where_its_feed_starts(name, make):
    """Held at its start, the feed moves nothing: analytic."""
    for blocks in (make(), make(7300.0, 0.33)):
        plant = production_plant(name, feed=blocks)
        held = plant
        for block in blocks:
            held = held.replace(block.name, Constant(block.name, float(block.output(0.0, [], [])[0])))
        run = simulate(held, 50.0, every=10.0, method="stiff")
        for signal in ("p_1", "V_1", "p_out2", "w"):
            np.testing.assert_allclose(run.log[signal], run.log[signal][0], rtol=1e-9)


@pytest.mark.parametrize("name", ["A", "E"])
def test_a_feed_that_begins_later_leaves_the_plant_at_rest_until_then(name):
    for blocks in (feed.slugs(start=60.0), feed.trip(at=60.0), [Step("F_in", 7000.0, 7400.0, at=60.0, unit="mol/s")]):
        blocks = [*blocks, Constant("Z_I", 0.35)] if len(blocks) == 1 else blocks
        run = simulate(production_plant(name, feed=blocks), 100.0, every=1.0, method="stiff")
        before = run.log.t < 60.0
        for signal in ("p_1", "V_1", "p_out2", "w"):
            np.testing.assert_allclose(run.log[signal][before], run.log[signal][0], rtol=1e-9)
        assert np.ptp(run.log["p_1"]) > 1e3


def test_another_rest_may_be_asked_for():
    plant = production_plant("B", feed=feed.constant(7600.0, 0.36), F_in=8000.0, Z_I=0.37)
    np.testing.assert_array_equal(plant["S1"].x0, production_plant("B")["S1"].x0)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: feed.constant(8000.0, 37.0), "Z_I = 37 to 37, but it lies within 0 to 1"),
        (lambda: feed.constant(float("nan"), 0.37), "F_in = nan to nan"),
        (lambda: feed.sine(amplitude=0.4), "Z_I = -0.15 to 0.65"),
        (lambda: feed.slugs(8000.0, flow=9000.0), "F_in = -1000 to 17000, but it is finite and never negative"),
        (lambda: feed.slugs(gas=0.7), "Z_I = -0.33 to 1.07"),
        (lambda: feed.trip(8000.0, to=-0.1), "F_in = -800 to -800"),
        (lambda: feed.trip(within=0.0), "within 0.0 s is no ramp"),
    ],
)
def test_feeds_that_cannot_be_are_refused_with_the_numbers(make, words):
    with pytest.raises(InfeasibleFeed) as error:
        make()
    assert words in str(error.value)

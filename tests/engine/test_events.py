"""Events: located against closed forms, at the start, at the end, simultaneous, in chains, and twice in a step."""

import math

import numpy as np
import pytest
from stickslip.blocks import Constant, FirstOrder, SampledPI, Sine, Step
from stickslip.blocks.block import Block, Kernels
from stickslip.blocks.ports import Port
from stickslip.diagram import drive, simulate, wire
from stickslip.engine.status import Status

SHARP = {"rtol": 1e-12, "atol": 1e-14}


def _ball_out(t, x, d, u, p, y):
    y[0] = x[0]


def _ball_der(t, x, d, u, p, dx):
    dx[0] = x[1]
    dx[1] = -p[0]


def _ball_zc(t, x, d, u, p, g):
    g[0] = -x[0] if x[1] < 0.0 else -1.0


def _ball_jump(t, x, d, u, p, k):
    x[0] = 0.0
    x[1] = -p[1] * x[1]
    d[0] = 1.0 - d[0]


class Ball(Block):
    """A bouncing ball: gravity g, restitution e, dropped from height 1."""

    ports_out = (Port("height"),)
    kernels = Kernels(out=_ball_out, der=_ball_der, zc=_ball_zc, jump=_ball_jump, n_events=1, feeds=False)
    modes = {"even": 0.0, "odd": 1.0}

    def __init__(self, g=9.81, e=0.8, height=1.0, name="ball", outputs="height"):
        super().__init__(
            name=name, params={"g": g, "e": e}, states={"z": height, "v": 0.0}, memory={"n": 0.0}, outputs=outputs
        )


def _count_out(t, x, d, u, p, y):
    y[0] = d[0]


def _count_zc(t, x, d, u, p, g):
    g[0] = u[0] - p[0] if d[0] < 0.5 else p[0] - u[0]


def _count_jump(t, x, d, u, p, k):
    d[0] = 1.0 if d[0] < 0.5 else 0.0


class Above(Block):
    """1 while the input is above ``level``, else 0; both changes are events."""

    ports_in = (Port("in"),)
    ports_out = (Port("out"),)
    kernels = Kernels(out=_count_out, zc=_count_zc, jump=_count_jump, n_events=1, feeds=False)
    modes = {"below": 0.0, "above": 1.0}

    def __init__(self, level, name="above", inputs="in", outputs="out"):
        super().__init__(name=name, params={"level": level}, memory={"mode": 0.0}, inputs=inputs, outputs=outputs)


def times_of(run, block=None):
    return np.array([e.t for e in run.events if block in (None, e.block)])


def impacts(n, g=9.81, e=0.8, height=1.0):
    """Analytic: t_n = sqrt(2 h/g) (1 + 2 (e + ... + e^(n - 1)))."""
    return math.sqrt(2.0 * height / g) * (1.0 + 2.0 * np.cumsum(np.concatenate([[0.0], e ** np.arange(1.0, n)])))


@pytest.mark.parametrize("method", ["auto", "explicit", "stiff"])
def test_bouncing_ball(method):
    ball = wire([Ball()], outputs=["height"])
    run = simulate(ball, 4.0, method=method, rtol=1e-8, atol=1e-10)
    assert run.ok
    expected = impacts(60)
    expected = expected[expected < 4.0]
    np.testing.assert_allclose(times_of(run), expected, atol=1e-9)  # a parabola: all methods are exact
    assert run.log["height"].min() > -1e-12


def test_zeno_is_reported_and_does_not_hang():
    # analytic: infinitely many bounces before t = sqrt(2/g) (1 + e)/(1 - e) = 4.06 s
    run = simulate(wire([Ball()], outputs=["height"]), 5.0)
    assert run.status is Status.CHATTERING
    assert "ball" in run.hint
    last = times_of(run)[-1]
    assert last == pytest.approx(math.sqrt(2.0 / 9.81) * 9.0, abs=1e-4)
    assert np.isnan(run.log["height"][-1]) and np.isfinite(run.log["height"][run.log.t < last]).all()


@pytest.mark.parametrize("level", [-0.7, 0.0, 0.3, 0.999])
def test_crossings_of_a_sine(level):
    run = drive(Above(level), 20.0, **{"in": Sine("in", 1.0, 4.0)}, **SHARP)
    rise = (4.0 / (2.0 * math.pi)) * math.asin(level)
    up = rise + 4.0 * np.arange(6)
    down = 2.0 - rise + 4.0 * np.arange(6)
    expected = np.sort(np.concatenate([up, down]))  # analytic
    expected = expected[(expected >= 0.0) & (expected < 20.0)]
    found = times_of(run)
    if level < 0.0:
        assert found[0] == 0.0  # above from the start
        found = found[1:]
    assert run.ok
    np.testing.assert_allclose(found, expected, atol=3e-13 / max(1e-3, math.sqrt(1.0 - level**2)))


def test_event_that_comes_and_goes_within_a_step():
    # the lag follows a slow ramp, so steps are long; its excess over the level peaks for a moment only
    signal = ([0.0, 50.0, 100.0], [0.0, 1.0, 0.0])  # a tent; the lag (tau = 1) peaks at 1 - ln(2 - exp(-50))
    peak = (50.0 - math.log(2.0)) / 50.0  # analytic: x' = 0 where x = u, t = 50 + ln 2
    lag = FirstOrder(1.0, 1.0, inputs="in", outputs="x", name="lag")
    run = simulate(wire([lag, Above(peak - 1e-4, inputs="x")], inputs=["in"]), 100.0, inputs={"in": signal}, **SHARP)
    assert run.ok
    assert [e.after for e in run.events] == ["above", "below"]
    assert times_of(run)[0] < 50.0 + math.log(2.0) < times_of(run)[1]


def test_event_at_the_start_and_at_the_end():
    run = drive(Above(0.5), 2.0, every=1.0, **{"in": Step("in", 1.0, at=0.0)})
    assert [(e.t, e.after) for e in run.events] == [(0.0, "above")]
    assert run.log["out"].tolist() == [1.0, 1.0, 1.0]
    run = drive(Above(0.5), 2.0, every=1.0, **{"in": Step("in", 1.0, at=2.0)})
    assert [(e.t, e.after) for e in run.events] == [(2.0, "above")]
    assert run.log["out"].tolist() == [0.0, 0.0, 1.0]
    run = drive(Above(0.5), 2.0, every=1.0, **{"in": ([0.0, 2.0], [0.0, 1.0])})  # exactly zero is not yet an event
    assert times_of(run) == pytest.approx([1.0], abs=1e-14)


def test_simultaneous_events_of_two_blocks():
    two = wire(
        [Sine("in", 1.0, 4.0), Above(0.5, "a", outputs="a"), Above(0.5, "b", outputs="b"), Above(0.5, "c", "b", "c")]
    )
    run = simulate(two, 8.0, every=0.5)
    expected = [1 / 3, 5 / 3, 13 / 3, 17 / 3]  # analytic
    for name in "abc":  # c reads what b writes: a chain at the same instant
        np.testing.assert_allclose(times_of(run, name), expected, atol=1e-12)
    assert np.array_equal(times_of(run, "b"), times_of(run, "c"))


def test_left_limit_at_a_step():
    # the integrator sees 0 until t = 1 exactly and 1 from then on: analytic x(t) = max(0, t - 1)
    lag = FirstOrder(1e3, 1e3, inputs="in", outputs="x")  # x' = u - x/1000
    diagram = wire([Step("in", 1.0, at=1.0), lag])
    run = simulate(diagram, 2.0, times=[0.5, np.nextafter(1.0, 0.0), 1.0, 2.0], **SHARP)
    assert run.log["in"].tolist() == [0.0, 1.0, 1.0, 1.0]  # times closer than rounding are one instant
    np.testing.assert_allclose(run.log["x"], [0.0, 0.0, 0.0, 1e3 * (1.0 - math.exp(-1e-3))], atol=1e-12)
    assert run.statistics.rejected == 0


def test_transitions_that_undo_each_other_are_chattering():
    run = simulate(wire([Constant("in", 1.0), Toggle()]), 1.0)
    assert run.status is Status.CHATTERING
    assert run.hint.startswith("modes switch back and forth")
    assert run.hint.endswith(" in toggle)")  # and not in the block that drives it


def _toggle_zc(t, x, d, u, p, g):
    g[0] = u[0]


def _toggle_jump(t, x, d, u, p, k):
    d[0] = 1.0 - d[0]


class Toggle(Block):
    """Its event function stays positive."""

    ports_in = (Port("in"),)
    ports_out = (Port("out"),)
    kernels = Kernels(out=_count_out, zc=_toggle_zc, jump=_toggle_jump, n_events=1, feeds=False)
    modes = {"off": 0.0, "on": 1.0}

    def __init__(self):
        super().__init__(name="toggle", params={}, memory={"mode": 0.0})


def test_events_are_found_far_from_time_zero():
    t0 = 1.7e9  # seconds since 1970
    run = simulate(wire([Ball()], outputs=["height"]), 3.0, t0=t0, rtol=1e-8, atol=1e-10)
    expected = impacts(60)
    expected = expected[expected < 3.0]
    assert run.ok
    np.testing.assert_allclose(times_of(run) - t0, expected, atol=2e-5)  # the clock ticks in 2.4e-7 s there


def test_many_events_fill_the_buffer_and_none_is_lost():
    run = drive(Above(0.0), 1500.0, every=1500.0, **{"in": Sine("in", 1.0, 1.0, phase=-1.0)})
    assert run.ok
    assert len(run.events) == 3000
    assert np.diff(times_of(run)) == pytest.approx(0.5, abs=1e-9)


def test_sampled_block_sees_a_step_at_the_same_nominal_instant():
    # 3 x 0.3 = 0.8999999999999999: rounding must not let the sample miss a step at 0.9
    run = simulate(
        wire([Step("SP", 0.5, at=0.9), Constant("PV", 0.0), SampledPI(1.0, math.inf, dt=0.3)]), 1.2, every=0.1
    )
    assert run.log["OP"][[8, 9, 10]].tolist() == [0.0, 0.5, 0.5]

"""Rate limiter: closed forms of letting go and meeting again; random inputs against a recurrence on a fine grid."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq
from stickslip.blocks.first_order import FirstOrder
from stickslip.blocks.periodic import Sine
from stickslip.blocks.pi import PI
from stickslip.blocks.ports import BlockError
from stickslip.blocks.rate_limiter import RateLimiter
from stickslip.blocks.recorded import Recorded, Staircase
from stickslip.blocks.sources import Ramp, Step
from stickslip.diagram import drive, simulate, wire
from stickslip.diagram.reference import simulate_reference


def test_steps_become_ramps_of_their_own_rate():
    run = drive(
        RateLimiter("y", "u", 0.5, 2.0), 12.0, every=0.25, u=Staircase("u", [0.0, 2.0, 1.0], at=[0.0, 1.0, 8.0])
    )
    expected = np.interp(run.log.t, [0, 1, 5, 8, 8.5, 12], [0, 0, 2, 2, 1, 1])  # analytic
    np.testing.assert_allclose(run.log["y"], expected, atol=1e-9)
    assert [(round(e.t, 9), e.after) for e in run.events] == [
        (1.0, "rising"), (5.0, "following"), (8.0, "falling"), (8.5, "following")
    ]  # fmt: skip


def test_a_sine_is_left_and_met_where_the_closed_form_says():
    w, r = 2 * math.pi / 10.0, 0.3
    run = drive(RateLimiter("y", "u", r), 5.0, every=0.01, u=Sine("u", 1.0, 10.0))
    # analytic: the sine starts too steep, is met from below, and left where its slope is -r
    meet = brentq(lambda t: math.sin(w * t) - r * t, 1.0, 5.0)
    go = (math.pi - math.acos(r / w)) / w
    assert [e.after for e in run.events] == ["rising", "following", "falling"]
    assert [e.t for e in run.events] == pytest.approx([0.0, meet, go], abs=1e-6)
    u = np.sin(w * run.log.t)
    expected = np.select(
        [run.log.t < meet, run.log.t < go], [r * run.log.t, u], math.sin(w * go) - r * (run.log.t - go)
    )
    np.testing.assert_allclose(run.log["y"], expected, atol=1e-6)


def test_a_gentle_sine_is_followed():
    run = drive(RateLimiter("y", "u", 0.7), 50.0, every=0.1, u=Sine("u", 1.0, 10.0))
    assert run.events == () and np.array_equal(run.log["y"], run.log["u"])


def test_a_ramp_at_the_limit_does_not_chatter():
    for rate in (0.1, 1e-4, 30.0):
        run = drive(RateLimiter("y", "u", rate), 100.0, u=Ramp("u", rate, before=5.0))
        assert run.ok and len(run.events) <= 1
        np.testing.assert_allclose(run.log["y"], run.log["u"], rtol=1e-6)


def test_two_in_a_row_are_the_slower_one():
    two = wire([RateLimiter("a", "u", 0.5), RateLimiter("y", "a", 0.5)], inputs=["u"], outputs=["y"])
    run = simulate(two, 10.0, inputs={"u": Staircase("u", [0.0, 3.0, -1.0], dwell=3.0)})
    assert run.ok and len(run.events) < 12
    np.testing.assert_allclose(run.log["y"], run.log["a"], atol=1e-6)


def test_one_side_only():
    run = drive(RateLimiter("y", "u", math.inf, 1.0), 4.0, every=1.0, u=Staircase("u", [0, 3, 0, 2], dwell=1.0))
    assert run.log["y"].tolist() == pytest.approx([0.0, 3.0, 3.0, 2.0, 2.0])


def test_it_can_start_away_from_its_input():
    run = drive(RateLimiter("y", "u", 0.5, start=0.0), 4.0, every=1.0, u=1.0)
    assert run.log["y"].tolist() == pytest.approx([0.0, 0.5, 1.0, 1.0, 1.0])
    down = drive(RateLimiter("y", "u", 0.5, start=0.0), 4.0, every=1.0, u=-1.0)
    assert down.log["y"].tolist() == pytest.approx([0.0, -0.5, -1.0, -1.0, -1.0])


@settings(max_examples=30)
@given(
    levels=st.lists(st.floats(-1.0, 1.0).map(lambda v: round(v, 2)), min_size=2, max_size=8),
    hold=st.sampled_from(["linear", "previous"]),
    up=st.sampled_from([0.2, 1.0, 5.0]),
    down=st.sampled_from([0.3, 2.0]),
)
def test_random_inputs_agree_with_a_fine_recurrence(levels, hold, up, down):
    # oracle: y_(k+1) = y_k + clip(u_(k+1) - y_k, -down h, up h), which is first order in h
    h = 1e-3
    t = np.arange(0.0, len(levels), h)
    knots = np.arange(len(levels))
    u = np.interp(t, knots, levels) if hold == "linear" else np.array(levels)[np.floor(t + 1e-9).astype(int)]
    y = [u[0]]
    for value in u[1:]:
        y.append(y[-1] + float(np.clip(value - y[-1], -down * h, up * h)))
    signal = Recorded("u", knots, levels, hold=hold)
    run = simulate(wire([signal, RateLimiter("y", "u", up, down)]), float(t[-1]), times=t)
    assert run.ok
    np.testing.assert_allclose(run.log["y"], y, atol=6 * h)


def loop():
    parts = [Step("SP", 0.8), PI(2.0, 10.0, low=0.0, high=1.0), RateLimiter("MV", "OP", 0.05), FirstOrder(1.0, 5.0)]
    return wire(parts)


def test_a_loop_costs_few_steps_and_the_reference_agrees():
    ours = simulate(loop(), 200.0, every=1.0)
    assert ours.ok and ours.statistics.steps < 80 and len(ours.events) < 8
    sharp = simulate(loop(), 60.0, every=1.0, rtol=1e-10, atol=1e-12)
    theirs = simulate_reference(loop(), 60.0, every=1.0, max_step=0.5)
    np.testing.assert_allclose(sharp.log["PV"], theirs.log["PV"], atol=1e-6)
    assert [(e.block, e.after) for e in sharp.events] == [(e.block, e.after) for e in theirs.events]


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: RateLimiter("y", "u", 0.0), "up = 0.0, but a rate is positive"),
        (lambda: RateLimiter("y", "u", 1.0, -1.0), "down = -1.0, but a rate is positive"),
        (lambda: RateLimiter("y", "u", math.inf), "up = inf, but one of up and down is finite"),
    ],
)
def test_misuse_is_explained(make, words):
    with pytest.raises(BlockError, match=words):
        make()

"""Steps of components that are linear in each mode: against expm, against the other methods, and where none can be."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.linalg import expm
from stickslip.blocks import (
    PI,
    FirstOrder,
    QuasiStaticStem,
    Ramp,
    RateLimiter,
    Recorded,
    SecondOrder,
    Sine,
    StateSpace,
    Step,
    StickSlip,
)
from stickslip.blocks.block import Block, Kernels
from stickslip.blocks.ports import BlockError, Port
from stickslip.diagram import simulate, wire
from stickslip.engine import layout as at

SHARP = {"rtol": 1e-10, "atol": 1e-12}


def method_of(diagram):
    """Return the method that the diagram's first component takes."""
    return int(diagram.plan().components[0].I[at.EXPLICIT])


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(1, 6))
@example(6784, 6)  # 22 of its steps are refused, each with a matrix of its own
def test_linear_systems_follow_the_matrix_exponential(seed, n):
    """x' = A x + B u with u = 1 + 0.1 t: the augmented matrix exponential carries it exactly (analytic)."""
    rng = np.random.default_rng(seed)
    A = rng.normal(size=(n, n)) - 1.5 * np.eye(n)
    B, C, x0 = rng.normal(size=(n, 1)), rng.normal(size=(1, n)), rng.normal(size=n)
    diagram = wire([Ramp("u", 0.1, before=1.0), StateSpace(A, B, C, start=x0)])
    assert method_of(diagram) == 3
    run = simulate(diagram, 8.0, every=0.5, rtol=1e-9, atol=1e-12)
    whole = np.zeros((n + 2, n + 2))
    whole[:n, :n], whole[:n, n], whole[n, n + 1] = A, B[:, 0], 0.1
    expected = [float(C[0] @ (expm(whole * t) @ [*x0, 1.0, 1.0])[:n]) for t in run.log.t]
    np.testing.assert_allclose(run.log["y"], expected, atol=1e-7 * (1.0 + np.abs(expected).max()))
    cost = run.statistics  # a sweep a step, and those that the matrix takes, once more before a step is refused
    assert cost.rhs < 6 * cost.steps + (n + 2) * cost.rejected + 40


@pytest.mark.parametrize("anti_windup", ["conditional", "back_calculation", "none"])
@pytest.mark.parametrize(
    ("valve", "SP"), [(QuasiStaticStem(0.06, 0.02), 1.2), (StickSlip.high(), 0.5)], ids=["massless", "mass"]
)
def test_events_are_where_the_other_methods_find_them(valve, SP, anti_windup):
    loop = wire([Step("SP", SP, at=2.0), PI(0.4, 10.0, anti_windup=anti_windup), valve, FirstOrder(3.0, 10.0)])
    assert method_of(loop) == 3
    ours, theirs = (simulate(loop, 300.0, every=1.0, method=method, **SHARP) for method in ("auto", "explicit"))
    assert [(e.block, e.after) for e in ours.events] == [(e.block, e.after) for e in theirs.events]
    np.testing.assert_allclose([e.t for e in ours.events], [e.t for e in theirs.events], atol=1e-6)
    np.testing.assert_allclose(ours.log["PV"], theirs.log["PV"], atol=1e-7)


def test_a_diagram_with_a_curved_input_takes_another_method():
    diagram = wire([Sine("MV", 1.0, 10.0), FirstOrder(2.0, 5.0)])
    assert method_of(diagram) == 2
    assert method_of(wire([Step("MV", 1.0), FirstOrder(2.0, 5.0, theta=1.0)])) == 2  # what leaves a dead time is curved
    assert method_of(wire([Step("MV", 1.0), SecondOrder(2.0, 0.5, 0.5)])) == 3


def _out(t, x, d, u, p, y):
    y[0] = x[0]


def _bending_der(t, x, d, u, p, dx):
    dx[0] = -0.1 * x[0] if x[0] < 5.0 else -0.5 - 0.02 * (x[0] - 5.0) * (x[0] - 5.0)


class Bends(Block):
    """A block that says that it is linear, and is where it is tried, but not beyond 5."""

    ports_out = (Port("x"),)
    kernels = Kernels(out=_out, der=_bending_der, feeds=False, linear=True)

    def __init__(self):
        super().__init__(name="bends", params={}, states={"x": 0.0})


def test_a_block_that_is_less_linear_than_it_says_is_integrated_all_the_same():
    diagram = wire([Bends()]).starting_at({"bends.x": 30.0})
    ours = simulate(diagram, 20.0, every=1.0, rtol=1e-8, atol=1e-10)
    theirs = simulate(diagram, 20.0, every=1.0, method="explicit", **SHARP)
    assert ours.ok
    np.testing.assert_allclose(ours.log["x"], theirs.log["x"], rtol=1e-6)


def _square_der(t, x, d, u, p, dx):
    dx[0] = -x[0] * x[0]


class Square(Bends):
    """A block that says that it is linear, and is not."""

    kernels = Kernels(out=_out, der=_square_der, feeds=False, linear=True)


def _rates_zc(t, x, d, u, p, g):
    g[0] = u[1] - 1.0


def _jump(t, x, d, u, p, k):
    d[0] = 1.0


def _still_out(t, x, d, u, p, y):
    y[0] = d[0]


class Unasked(Block):
    """A block whose event function looks at a rate in a mode in which it says that it does not."""

    ports_in, ports_out, modes = (Port("u"),), (Port("y"),), {"off": 0.0, "on": 1.0}
    kernels = Kernels(out=_still_out, zc=_rates_zc, jump=_jump, n_events=1, feeds=False, rates=True, rate_modes=(1.0,))

    def __init__(self):
        super().__init__(name="unasked", params={}, memory={"mode": 0.0})


def test_wrong_words_are_found_at_wiring():
    with pytest.raises(BlockError, match=r"kernel der .* is not affine, but linear=True"):
        wire([Square()])
    with pytest.raises(BlockError, match="looks at rates in mode 0, which is not among its rate_modes"):
        wire([Ramp("u", 1.0), Unasked()])


@pytest.mark.parametrize("method", ["auto", "explicit"])
def test_a_limiter_in_front_of_a_kink_does_not_chatter(method):
    """OP comes off its limit with a kink; the limiter behind it lets go once and meets it once."""
    parts = [Step("SP", 0.8), PI(2.0, 10.0, low=0.0, high=1.0), RateLimiter("MV", "OP", 0.05), FirstOrder(1.0, 5.0)]
    run = simulate(wire(parts), 200.0, every=1.0, method=method)
    assert [e.after for e in run.events] == ["at high limit", "falling", "free", "following"]


def test_an_event_that_comes_and_goes_before_another_one_in_a_long_step_is_found():
    """v = K_p (e + 1/T_i int e dt) with e falling on a line is a parabola: it passes 1 in between and 0 at the end."""
    parts = [Ramp("SP", -0.02, before=0.5), Ramp("PV", 0.0), PI(1.5, 4.0, low=0.0, high=1.0, anti_windup="none")]
    run = simulate(wire(parts), 60.0, every=10.0)
    t = np.linspace(0.0, 60.0, 600_001)
    v = 1.5 * (0.5 - 0.02 * t + (0.5 * t - 0.01 * t**2) / 4.0)  # analytic
    crossings = t[np.flatnonzero(np.diff((v > 1.0).astype(int) - (v < 0.0).astype(int)))]
    np.testing.assert_allclose([e.t for e in run.events], crossings, atol=2e-4)
    assert len(crossings) == 3


@pytest.mark.parametrize("every", [1.0, 0.3])  # rows at the samples only, and between them too
def test_steps_from_sample_to_sample_follow_the_matrix_exponential(every):
    """A held input changes each second, and a ramp enters too: steps of one length, whose sums are kept."""
    rng = np.random.default_rng(7)
    A, B, held = rng.normal(size=(3, 3)) - 1.5 * np.eye(3), rng.normal(size=(3, 2)), rng.normal(size=40)
    parts = [Recorded("u", np.arange(40.0), held, hold="previous"), Ramp("r", 0.05)]
    diagram = wire([*parts, StateSpace(A, B, np.eye(3), inputs=["u", "r"], outputs=["a", "b", "c"])])
    assert method_of(diagram) == 3
    run = simulate(diagram, 39.0, every=every, rtol=1e-9, atol=1e-12)
    x, expected = np.zeros(5), []
    whole = np.zeros((5, 5))
    whole[:3, :3], whole[:3, 3], whole[3, 4] = A, B[:, 1], 0.05  # states, the ramp, one
    grid = np.unique(np.concatenate([np.arange(40.0), run.log.t]))
    x[4] = 1.0
    for before, after in zip(grid, [*grid[1:], np.inf], strict=True):
        if np.any(np.abs(run.log.t - before) < 1e-12):
            expected.append(x[:3].copy())
        if np.isfinite(after):
            step = whole.copy()
            step[:3, 4] += B[:, 0] * held[int(np.floor(before + 1e-9))]
            x = expm(step * (after - before)) @ x
    found = np.array([run.log[s] for s in ("a", "b", "c")]).T
    np.testing.assert_allclose(found, expected, atol=1e-8 * (1.0 + np.abs(expected).max()))
    end = run.ends[0]
    assert end.W[end.I[at.O_AGAIN]] > 0.0  # the last steps were kept ones


def test_an_event_inside_a_step_that_comes_again_is_found():
    """From sample to sample the lag is at rest or falls; the relay-like valve slips within such a step (analytic)."""
    OP = Recorded("OP", np.arange(50.0), np.r_[np.zeros(30), np.ones(20)], hold="previous")
    ramp = [OP, FirstOrder(1.0, 4.0, inputs="OP", outputs="x"), QuasiStaticStem(0.5, 0.0, inputs="x", outputs="MV")]
    run = simulate(wire(ramp, outputs=["MV"]), 49.0, every=1.0, rtol=1e-9, atol=1e-12)
    slip = next(e.t for e in run.events if e.t > 0.0)
    np.testing.assert_allclose(1.0 - np.exp(-(slip - 30.0) / 4.0), 0.25, atol=1e-8)  # half the stickband

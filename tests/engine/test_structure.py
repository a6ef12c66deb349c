"""What the wiring says: sparsity, elimination without pivoting, what stands still, what looks at the clock."""

import cProfile
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numba import njit
from stickslip.blocks import PI, Constant, FirstOrder, Gain, Noise, QuasiStaticStem, Sine, Step
from stickslip.diagram import simulate, wire
from stickslip.engine import layout as at
from stickslip.engine.call import pointer_to
from stickslip.engine.elimination import eliminate
from stickslip.engine.linear import factorise, solve
from stickslip.engine.structure import analyse

from benchmarks.peers.coupled_sticky import coupled_sticky_loops


@st.composite
def sparse(draw):
    """A random pattern with a full diagonal, and values that dominate there."""
    n = draw(st.integers(1, 12))
    cells = st.tuples(st.integers(0, n - 1), st.integers(0, n - 1))
    entries = sorted(set(draw(st.lists(cells, max_size=4 * n))))
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    return n, entries, rng.normal(size=len(entries)), rng.normal(size=n)


@settings(max_examples=60)
@given(sparse())
def test_elimination_solves_what_numpy_solves(problem):
    n, entries, values, b = problem
    order = eliminate(n, entries)
    I = np.zeros(at.H, dtype=np.int64)
    lists = {
        at.L_PLACE: order.places, at.L_DIAGONAL: order.diagonals, at.L_FACTOR: order.factor,
        at.L_FORWARD: order.forward, at.L_BACKWARD: order.backward,
    }  # fmt: skip
    for slot, numbers in lists.items():
        I[slot] = len(I)
        I = np.concatenate([I, np.array(numbers, dtype=np.int64)])
    I[at.N_STATES], I[at.N_JAC], I[at.N_FACTORS] = n, len(entries), order.size
    I[at.O_JAC], I[at.O_LU] = 0, len(entries)
    W = np.concatenate([values, np.zeros(order.size), b])
    assert factorise_and_solve(I, W, 40.0, len(entries) + order.size)
    dense = np.diag(np.full(n, 40.0))
    for (i, j), value in zip(entries, values, strict=True):
        dense[i, j] -= value
    assert W[-n:] == pytest.approx(np.linalg.solve(dense, b), rel=1e-10, abs=1e-12)  # independent: LAPACK, pivoting


def test_a_singular_matrix_is_reported():
    order = eliminate(1, [(0, 0)])
    I = np.zeros(at.H, dtype=np.int64)
    for slot, numbers in {at.L_PLACE: order.places, at.L_DIAGONAL: order.diagonals, at.L_FACTOR: order.factor}.items():
        I[slot] = len(I)
        I = np.concatenate([I, np.array(numbers, dtype=np.int64)])
    I[at.N_STATES], I[at.N_JAC], I[at.N_FACTORS], I[at.O_LU] = 1, 1, order.size, 1
    assert not factorise_and_solve(I, np.array([3.0, 0.0, 1.0]), 3.0, 2)


@njit
def _both(ints, floats, diagonal, b):
    good = factorise(pointer_to(ints), pointer_to(floats), diagonal)
    if good:
        solve(pointer_to(ints), pointer_to(floats), b)
    return good


def factorise_and_solve(I, W, diagonal, b):
    """Call the compiled functions as the engine does, with pointers."""
    return _both(I, W, diagonal, b)


def test_a_chain_needs_no_new_entries():
    chain = [(i, i) for i in range(50)] + [(i, i + 1) for i in range(49)] + [(i + 1, i) for i in range(49)]
    assert eliminate(50, chain).size == len(chain)


def test_an_arrow_is_turned_round():
    arrow = [(i, i) for i in range(20)] + [(0, i) for i in range(1, 20)] + [(i, 0) for i in range(1, 20)]
    assert eliminate(20, arrow).size == len(arrow)  # in the given order it would fill up: 400


def component_of(blocks, **more):
    laid = wire(blocks, **more).plan()
    return [laid.flat[b] for b in laid.components[0].blocks]


def test_constants_and_what_only_they_feed_stand_still():
    rows = component_of(
        [Constant("SP", 0.5), Gain("r", "SP", 2.0), PI(K_p=1.0, T_i=5.0, inputs=["r", "PV"]),
         FirstOrder(K=1.0, tau=3.0, inputs=["OP"], outputs=["PV"])]
    )  # fmt: skip
    shape = analyse(rows)
    names = [row.name for row in rows]
    assert {names[i] for i, still in enumerate(shape.still) if still} == {"SP", "r"}
    assert all(not shape.still[i] for i in shape.for_rates)
    assert not shape.timed


def test_a_sine_makes_the_rates_depend_on_time():
    rows = component_of([Sine("u", amplitude=1.0, period=5.0), FirstOrder(K=1.0, tau=2.0, inputs=["u"])])
    assert analyse(rows).timed


def test_a_diagram_whose_rates_depend_on_time_is_solved_as_exactly_as_one_whose_do_not():
    # analytic: x' = (sin(2 pi t/T) - x)/tau from x = 0
    T, tau = 5.0, 0.5
    w = 2.0 * math.pi / T
    run = simulate(
        wire([Sine("u", amplitude=1.0, period=T), FirstOrder(K=1.0, tau=tau, inputs=["u"], outputs=["y"])]),
        10.0, every=0.5, method="stiff", rtol=1e-9, atol=1e-12,
    )  # fmt: skip
    t = run.log.t
    exact = (np.sin(w * t) - w * tau * np.cos(w * t) + w * tau * np.exp(-t / tau)) / (1.0 + (w * tau) ** 2)
    assert np.abs(run.log["y"] - exact).max() < 1e-8


def test_stiff_steps_end_just_behind_an_event_so_that_it_is_located_well():
    loop = wire(
        [Sine("OP", amplitude=0.2, period=7.0, mean=0.5), QuasiStaticStem(start=0.5, inputs=["OP"], outputs=["MV"]),
         FirstOrder(K=1.0, tau=3.0, inputs=["MV"], outputs=["PV"])]
    )  # fmt: skip
    run = simulate(loop, 30.0, every=1.0, method="stiff")
    stops = [event.t for event in run.events if event.after == "stuck"]
    turns = [7.0 * (k + 0.25) for k in range(20)] + [7.0 * (k + 0.75) for k in range(20)]  # analytic: OP turns
    assert stops
    assert max(min(abs(t - turn) for turn in turns) for t in stops) < 1e-6


def test_what_a_sampled_block_alone_feeds_stands_still_wherever_it_is_in_the_order():
    rows = component_of([Noise("D", sd=1.0, dt=1.0), Gain("u", "D", 2.0), FirstOrder(1.0, 5.0, inputs="u")])
    assert rows[-1].name == "D"  # it takes its sample last
    still = analyse(rows).still
    assert {row.name for row, rests in zip(rows, still, strict=True) if rests} == {"D", "u"}


def test_a_source_may_feed_what_moves_and_what_nobody_reads():
    loop = [Step("r", 1.0), Gain("a", "r", 2.0), Gain("b", "r", 3.0), FirstOrder(1.0, 5.0, inputs="a")]
    run = simulate(wire(loop, outputs=["b", "PV"]), 10.0, every=5.0)
    assert run.log["b"].tolist() == [3.0, 3.0, 3.0]
    np.testing.assert_allclose(run.log["PV"], 2.0 * (1.0 - np.exp(-run.log.t / 5.0)), atol=1e-6)  # analytic


@pytest.mark.parametrize("seed", range(5))
def test_states_are_eliminated_in_markowitz_order(seed):
    """Snapshot of the order's rule: always the state that adds fewest entries next, the first of several."""
    rng = np.random.default_rng(seed)
    n = 30
    entries = [(i, i) for i in range(n)] + [tuple(pair) for pair in rng.integers(n, size=(60, 2)).tolist()]
    right = [{j for i, j in entries if i == k and j != k} for k in range(n)]
    below = [{i for i, j in entries if j == k and i != k} for k in range(n)]
    waiting, order = set(range(n)), []
    while waiting:
        pivot = min(waiting, key=lambda i: (len(right[i]) * len(below[i]), i))
        waiting.remove(pivot)
        order.append(pivot)
        for i in below[pivot]:
            right[i] = (right[i] | right[pivot]) - {i, pivot}
        for j in right[pivot]:
            below[j] = (below[j] | below[pivot]) - {j, pivot}
    plan, at = eliminate(n, list(dict.fromkeys(entries))).forward, 0
    found = []
    while at < len(plan):
        found.append(plan[at])
        at += 3 + plan[at + 2]
    assert found == order


def test_laying_out_a_diagram_takes_work_in_proportion():
    def calls(count):  # of functions, which no other load on the machine changes
        loops = coupled_sticky_loops(count)
        watch = cProfile.Profile()
        watch.runcall(loops.plan)
        return sum(entry.callcount for entry in watch.getstats())

    calls(10)
    assert calls(400) < 5.0 * calls(100)  # four times the loops; it was fourteen times as long


def test_python_control_maps_are_made_when_looked_at():
    loops = coupled_sticky_loops(20)
    assert "connect_map" not in loops.__dict__
    assert loops.connect_map.shape == (140, 100) and loops.connect_map.sum() == 140
    assert loops.output_map.shape == (100, 240)

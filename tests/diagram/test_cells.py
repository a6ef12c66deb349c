"""A large diagram cut into cells gives what one component gives, at a cost that grows no faster than its size."""

import numpy as np
import pytest
from stickslip.blocks import PI, FirstOrder, IdealValve, Integrator, KanoValve, QuasiStaticStem, Step, StickSlip, Sum
from stickslip.diagram import Diagram, simulate, wire
from stickslip.diagram.cells import MANY
from stickslip.engine.status import Status

from benchmarks.peers.coupled_sticky import coupled_sticky_loops

COUNT = 40  # loops, more than MANY


def whole(monkeypatch, *arguments, **keywords):
    """Simulate as one component."""
    with monkeypatch.context() as patch:
        patch.setattr(Diagram, "plan_in_cells", Diagram.plan)
        run = simulate(*arguments, **keywords)
    assert run.statistics.components == 1
    return run


def largest_difference(one, other):
    return max(float(np.max(np.abs(one.log[s] - other.log[s]))) for s in one.log.names)


@pytest.mark.parametrize("A", [0.02, 0.2])
def test_coupled_sticky_loops_in_cells_are_what_they_are_together(monkeypatch, A):
    loops = coupled_sticky_loops(COUNT, A=A, B=-0.5 * A)
    run = simulate(loops, 200.0, every=1.0)
    exact = whole(monkeypatch, loops, 200.0, every=1.0, rtol=1e-10, atol=1e-12)
    assert run.ok and run.statistics.components == COUNT > MANY
    assert largest_difference(run, exact) < 2e-5
    found, true = (sorted((e.block, e.t, e.before, e.after) for e in r.events) for r in (run, exact))
    assert [(b, old, new) for b, _, old, new in found] == [(b, old, new) for b, _, old, new in true]
    assert np.allclose([t for _, t, _, _ in found], [t for _, t, _, _ in true], rtol=0.0, atol=1e-3)


def test_a_tighter_tolerance_makes_cells_more_accurate(monkeypatch):
    loops = coupled_sticky_loops(COUNT)
    exact = whole(monkeypatch, loops, 100.0, every=1.0, rtol=1e-11, atol=1e-13)
    errors = [largest_difference(simulate(loops, 100.0, every=1.0, rtol=r, atol=1e-3 * r), exact) for r in (1e-5, 1e-8)]
    assert errors[1] < 1e-6 and errors[1] < 0.1 * errors[0]


def test_staggered_scans_in_cells_are_what_they_are_together(monkeypatch):
    loops = coupled_sticky_loops(COUNT, scan=1.0)
    run = simulate(loops, 60.0, every=1.0)
    exact = whole(monkeypatch, loops, 60.0, every=1.0, rtol=1e-10, atol=1e-12)
    assert run.ok and run.statistics.components == COUNT
    assert largest_difference(run, exact) < 2e-5


def test_the_cost_of_a_loop_does_not_grow_with_their_number():
    cost = [simulate(coupled_sticky_loops(n), 200.0, every=1.0).statistics.rhs / n for n in (COUNT, 4 * COUNT)]
    assert cost[1] < 1.3 * cost[0]  # as one component: the rates of all, 1.8 times as often (and each 4 times as dear)


def test_a_run_in_cells_goes_on_where_it_ended(monkeypatch):
    loops = coupled_sticky_loops(COUNT)
    first = simulate(loops, 60.0, every=1.0)
    second = simulate(first.final, 60.0, every=1.0, t0=60.0)
    exact = whole(monkeypatch, loops, 120.0, every=1.0, rtol=1e-10, atol=1e-12)
    assert first.statistics.components == second.statistics.components == COUNT
    assert max(float(np.max(np.abs(second.log[s] - exact.log[s][60:]))) for s in second.log.names) < 2e-5


def test_the_signals_asked_for_are_those_of_a_full_log():
    loops = coupled_sticky_loops(COUNT)
    full, some = simulate(loops, 50.0, every=1.0), simulate(loops, 50.0, every=1.0, signals=["PV7", "MV39"])
    assert set(some.log.names) == {"PV7", "MV39"}
    assert all(np.array_equal(some.log[s], full.log[s]) for s in some.log.names)


def test_cells_that_hang_together_tightly_are_run_as_one(monkeypatch):
    blocks = []
    for i in range(COUNT):  # a ring of integrators with a gain of 2000 1/s, each with a valve
        blocks += [
            Step(f"SP{i}", after=0.5 + 0.01 * i),
            PI(K_p=0.1, T_i=10.0, name=f"C{i}", inputs=[f"SP{i}", f"PV{i}"], outputs=f"OP{i}"),
            StickSlip(name=f"V{i}", inputs=[f"OP{i}"], outputs=f"MV{i}"),
            Sum(f"u{i}", {f"MV{i}": 1.0, f"PV{(i + 1) % COUNT}": 2000.0, f"PV{i}": -2001.0}),
            Integrator(1.0, 1.0, name=f"P{i}", inputs=[f"u{i}"], outputs=f"PV{i}"),
        ]
    ring = wire(blocks)
    assert ring.plan_in_cells().links
    run = simulate(ring, 5.0, every=0.5)
    exact = whole(monkeypatch, ring, 5.0, every=0.5, rtol=1e-9, atol=1e-12)
    assert run.ok and run.statistics.components == 1
    assert largest_difference(run, exact) < 1e-4


def test_a_run_that_fails_says_what_it_says_as_one_component(monkeypatch):
    loops = coupled_sticky_loops(COUNT)
    fed_back = [Sum("u", {"PV3": 1.0, "x": 10.0}), FirstOrder(1.0, 1.0, name="P", inputs=["u"], outputs=["x"])]
    failing = wire([*loops.blocks, *fed_back])  # x grows as exp(9 t): infinite at 79 s
    run, one = simulate(failing, 100.0, every=1.0), whole(monkeypatch, failing, 100.0, every=1.0)
    assert not run.ok and (run.status, run.hint) == (one.status, one.hint)


def test_a_run_in_cells_can_be_interrupted():
    loops = coupled_sticky_loops(4 * COUNT)
    full, reached = simulate(loops, 200.0, every=1.0), []

    def stop(t):
        reached.append(t)
        raise KeyboardInterrupt

    run = simulate(loops, 200.0, every=1.0, on_progress=stop)
    assert run.status is Status.INTERRUPTED and 0.0 < reached[0] < 200.0
    rows = int(reached[0])
    assert all(np.array_equal(run.log[s][:rows], full.log[s][:rows]) for s in run.log.names)
    assert all(np.isnan(run.log[s][rows + 2 :]).all() for s in run.log.names)


def test_few_loops_stay_one_component():
    assert not coupled_sticky_loops(MANY // 2).plan_in_cells().links


def mixed_ring(seed):
    """Return loops of all kinds in a ring: valves with events and samples, processes with and without dead time."""
    rng = np.random.default_rng(seed)
    blocks = []
    for i in range(COUNT):
        wires = {"name": f"V{i}", "inputs": [f"OP{i}"], "outputs": f"MV{i}"}
        theta = float(rng.choice([0.0, 0.0, 0.4, 1.3]))
        blocks += [
            Step(f"SP{i}", after=float(rng.uniform(0.2, 0.6)), at=float(rng.uniform(0.0, 3.0))),
            PI(float(rng.uniform(0.1, 0.4)), 10.0, name=f"C{i}", inputs=[f"SP{i}", f"PV{i}"], outputs=f"OP{i}"),
            [StickSlip, IdealValve, lambda **w: QuasiStaticStem(0.06, 0.02, **w),
             lambda **w: KanoValve(0.06, 0.02, dt=0.3, **w)][rng.integers(4)](**wires),
            Sum(f"u{i}", {f"MV{i}": 1.0, f"PV{(i + 1) % COUNT}": 0.1, f"PV{(i + 5) % COUNT}": -0.05}),
            FirstOrder(float(rng.uniform(0.5, 2.0)), float(rng.uniform(3.0, 10.0)), theta, name=f"P{i}",
                       inputs=[f"u{i}"], outputs=f"PV{i}"),
        ]  # fmt: skip
    return wire(blocks)


@pytest.mark.parametrize("seed", range(4))
def test_mixed_loops_in_cells_are_what_they_are_together(monkeypatch, seed):
    ring = mixed_ring(seed)
    assert ring.plan_in_cells().links
    run = simulate(ring, 40.0, every=0.5)
    exact = whole(monkeypatch, ring, 40.0, every=0.5, rtol=1e-9, atol=1e-12)
    assert run.ok and run.statistics.components >= COUNT
    # where a signal jumps at a log time, either side of it may be logged
    apart = np.array([np.abs(run.log[s] - exact.log[s]) for s in run.log.names if s.startswith("PV")])
    assert apart.max() < 2e-5

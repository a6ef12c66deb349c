"""Sampled blocks: their clock, their order at one instant, blocks that run in Python, and continued runs."""

import math

import numpy as np
import pytest
from stickslip.blocks import (
    Constant,
    FirstOrder,
    IdealValve,
    QuasiStaticStem,
    Recorded,
    SampledPI,
    Sine,
    Step,
    StickSlip,
)
from stickslip.blocks.block import Block, Kernels
from stickslip.blocks.ports import Port
from stickslip.diagram import simulate, wire
from stickslip.engine.status import Status


def _count(t, x, d, u, p, y):
    d[0] += 1.0
    d[1] = t
    y[0] = d[0]
    y[1] = u[0]


class Counter(Block):
    """Counts its samples and repeats its input at each."""

    ports_in = (Port("in"),)
    ports_out = (Port("count"), Port("seen"))
    kernels = Kernels(step=_count)
    period_param = "dt"
    offset_param = "offset"

    def __init__(self, dt, offset=0.0, name="counter", inputs="in", outputs=("count", "seen")):
        super().__init__(
            name=name, params={"dt": dt, "offset": offset}, memory={"n": 0.0, "t": 0.0}, inputs=inputs, outputs=outputs
        )

    def smooth(self):
        return Twin(self)


class Twin(Block):
    """What python-control sees: two outputs that rest."""

    ports_in = (Port("in"),)
    ports_out = (Port("a"), Port("b"))
    kernels = Kernels(feeds=False)

    def __init__(self, block):
        super().__init__(name=block.name, params={}, inputs=block.input_labels, outputs=block.output_labels)


class Adder:
    """A host that adds one to its input and keeps the instants in its state."""

    def init(self, p):
        return ()

    def step(self, t, state, u, p):
        return (*state, t), [u[0] + 1.0, float(len(state) + 1)]


class Hosted(Block):
    ports_in = (Port("in"),)
    ports_out = (Port("out"), Port("taken"))
    kernels = Kernels()
    period_param = "dt"
    host = Adder()

    def __init__(self, dt, name="hosted", inputs="in", outputs=("out", "taken")):
        super().__init__(name=name, params={"dt": dt}, inputs=inputs, outputs=outputs)

    def smooth(self):
        return Twin(self)


def test_clock_does_not_drift():
    dt = 0.1  # not a binary fraction
    run = simulate(wire([Constant("in", 1.0), Counter(dt)]), 1e4, every=1e4)
    assert run.log["count"][-1] == 100_001.0
    assert run.final["counter"].d0[1] == 100_000 * dt


def test_periods_and_offsets_that_share_nothing():
    blocks = [Sine("in", 1.0, 7.0), Counter(math.sqrt(2.0), 0.3, "a", outputs=["na", "a"]),
              Counter(math.e / 3.0, 0.0, "b", outputs=["nb", "b"])]  # fmt: skip
    run = simulate(wire(blocks), 50.0, every=0.01)
    for name, dt, offset in (("a", math.sqrt(2.0), 0.3), ("b", math.e / 3.0, 0.0)):
        k = np.floor((run.log.t - offset) / dt + 1e-9)
        np.testing.assert_array_equal(run.log[f"n{name}"], np.maximum(k + 1.0, 0.0))
        held = np.where(k < 0.0, 0.0, np.sin(2.0 * np.pi * (offset + k * dt) / 7.0))  # analytic
        np.testing.assert_allclose(run.log[name], held, atol=1e-12)


def test_order_at_one_instant_follows_the_signals():
    chain = wire([Counter(0.5, name="c", inputs="b", outputs=["nc", "c"]), IdealValve(inputs="a", outputs="b"),
                  Counter(0.5, name="a", outputs=["na", "a"]), Recorded("in", [0.0, 1.0], [0.0, 0.9])])  # fmt: skip
    run = simulate(chain, 1.0, every=0.5)
    assert run.log["c"].tolist() == run.log["in"].tolist() == [0.0, 0.45, 0.9]


def test_what_runs_in_python_stands_in_the_same_order():
    chain = wire([Recorded("in", [0.0, 1.0], [0.0, 0.8]), Counter(0.25, name="a", outputs=["na", "a"]),
                  Hosted(0.25, inputs="a", outputs=["h", "taken"]),
                  Counter(0.25, name="c", inputs="h", outputs=["nc", "c"])])  # fmt: skip
    run = simulate(chain, 1.0, every=0.25)
    np.testing.assert_allclose(run.log["c"], run.log["in"] + 1.0, atol=1e-15)
    assert run.log["taken"].tolist() == [1.0, 2.0, 3.0, 4.0, 5.0]


def test_hosted_block_starts_where_the_run_starts():
    run = simulate(wire([Constant("in", 0.5), Hosted(0.5)]), 1.0, every=0.5, t0=1000.0)
    assert run.log["taken"].tolist() == [1.0, 2.0, 3.0]


def test_a_jump_of_a_hosted_output_moves_a_rate_driven_stem():
    # analytic: OP goes from 0 to 1.2 at t = 0.5; the stem without mass follows OP, less half its deadband 0.04
    op = Recorded("in", [0.0, 0.4, 0.5], [-1.0, -1.0, 0.2])
    stem = QuasiStaticStem(0.06, 0.02, low=-2.0, high=2.0, inputs="h")
    run = simulate(wire([op, Hosted(0.5, inputs="in", outputs=["h", "taken"]), stem]), 1.0, every=0.25)
    np.testing.assert_allclose(run.log["MV"], [0.0, 0.0, 1.18, 1.18, 1.18], atol=1e-12)


def test_sampling_parameters_changed_after_the_plan_was_made():
    pi = wire([Constant("SP", 0.5), Constant("PV", 0.0), SampledPI(0.4, 10.0, dt=1.0)])
    simulate(pi, 5.0)
    run = simulate(pi, 5.0, every=0.5, t0=10.0, params={"controller.dt": 0.5})
    np.testing.assert_allclose(run.log["OP"], 0.2 + 0.01 * np.arange(11), atol=1e-15)  # analytic: K_p e dt/T_i each


@pytest.mark.parametrize("every", [0.1, 0.15, 0.3, 0.9])
def test_every_row_is_written(every):
    run = simulate(wire([Constant("SP", 0.5), Constant("PV", 0.0), SampledPI(0.4, 10.0, dt=0.3)]), 0.9, every=every)
    assert run.ok and np.isfinite(run.log["OP"]).all()
    assert run.log["OP"][-1] == pytest.approx(0.218)  # analytic: the sample at 0.9 = 3 x 0.3 is in


LOOPS = {
    "continuous": lambda: [Step("SP", 0.5, at=1.0), SampledPI(0.4, 10.0, dt=0.5), StickSlip(), FirstOrder(3.0, 10.0)],
    "dead time": lambda: [Step("SP", 0.5), SampledPI(0.2, 10.0, dt=0.7), StickSlip(), FirstOrder(3.0, 10.0, 2.0)],
    "rates": lambda: [
        Step("SP", 0.5),
        SampledPI(0.4, 10.0, dt=0.5),
        QuasiStaticStem(0.06, 0.02),
        FirstOrder(3.0, 10.0),
    ],
}


@pytest.mark.parametrize("kind", LOOPS)
@pytest.mark.parametrize("cut", [33.0, 33.25, 35.0])  # at, between, at sampling instants
def test_two_pieces_equal_one(kind, cut):
    loop = wire(LOOPS[kind]())
    settings = {"rtol": 1e-10, "atol": 1e-12}
    times = np.array([cut, cut + 1.0, 70.0, 100.0])
    whole = simulate(loop, 100.0, times=times, **settings)
    first = simulate(loop, cut, every=cut, **settings)
    second = simulate(first.final, 100.0 - cut, t0=cut, times=times, **settings)
    for signal in whole.log.names:
        np.testing.assert_allclose(second.log[signal], whole.log[signal], atol=1e-9)
    assert len(first.events) + len(second.events) == len(whole.events)


def test_progress_is_told_and_changes_nothing():
    loop = wire(LOOPS["dead time"]())
    seen = []
    plain = simulate(loop, 3e5, every=100.0)
    watched = simulate(loop, 3e5, every=100.0, on_progress=seen.append)
    assert plain.statistics.steps > 20_000 and len(seen) > 4
    assert seen == sorted(seen) and seen[-1] == 3e5
    for signal in plain.log.names:
        np.testing.assert_array_equal(watched.log[signal], plain.log[signal])


def test_a_run_can_be_interrupted_and_keeps_what_it_has():
    def stop(t):
        raise KeyboardInterrupt

    run = simulate(wire(LOOPS["dead time"]()), 3e5, every=100.0, on_progress=stop)
    assert run.status is Status.INTERRUPTED and "interrupted" in run.hint
    reached = np.isfinite(run.log["PV"])
    assert 1 < reached.sum() < len(reached) and not reached[-1]


def _delay(t, x, d, u, p, y):
    y[0] = d[0]
    d[0] = u[0]


class UnitDelay(Block):
    """y(k) = u(k - 1)."""

    ports_in = (Port("in"),)
    ports_out = (Port("late"),)
    kernels = Kernels(step=_delay, feeds=False)
    period_param = "dt"

    def __init__(self, dt, **labels):
        super().__init__(name="delay", params={"dt": dt}, memory={"last": 0.0}, **labels)


def test_a_unit_delay_reads_what_is_current_at_its_instant():
    """A sampled block without feedthrough takes its sample after its drivers, wherever it stands in the list."""
    run = simulate(wire([Constant("in", 1.0), UnitDelay(dt=1.0, inputs="count"), Counter(1.0)]), 4.0, every=1.0)
    np.testing.assert_array_equal(run.log["count"], [1, 2, 3, 4, 5])
    np.testing.assert_array_equal(run.log["late"], [0, 1, 2, 3, 4])  # analytic: exactly one sample late

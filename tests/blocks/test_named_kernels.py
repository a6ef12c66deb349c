"""Kernels written with names do what the same equations do in arrays, and are refused in words when they cannot."""

import math
import pickle

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from stickslip.blocks import BlockError, Constant, FirstOrder, LeadLag, StickSlip
from stickslip.blocks.block import Block, Kernels
from stickslip.blocks.dry_run import dry_run
from stickslip.blocks.ports import Port
from stickslip.blocks.stick_slip import NOISE, TIE, slack
from stickslip.diagram import drive

UP, DOWN, STUCK, IDEAL = 1.0, -1.0, 0.0, 2.0


def block(ins="F", outs="L", states=None, memory=None, params=None, **kernels):
    ports = {"ports_in": tuple(map(Port, ins.split())), "ports_out": tuple(map(Port, outs.split()))}
    made = type("Made", (Block,), {**ports, "kernels": Kernels(**kernels)})
    return made(name="made", params=params or {}, states=states, memory=memory)


def test_a_tank_follows_its_closed_form():
    tank = block(states={"L": 0.0}, params={"A": 2.0, "k": 0.5}, der=lambda L, F, A, k: (F - k * L) / A)
    dry_run(tank)
    assert not tank.kernels.feeds and not tank.kernels.timed  # the output is a state
    level = drive(tank, 10.0, every=10.0, F=1.0, rtol=1e-10).log["L"][-1]
    assert level == pytest.approx(2.0 * (1.0 - math.exp(-2.5)), rel=1e-8)  # analytic


def test_what_a_function_takes_says_what_it_depends_on():
    late = block(outs="y", out=lambda t, F: F * t)
    assert late.kernels.feeds and late.kernels.timed
    still = block(outs="y", states={"L": 0.0}, out=lambda L: L, der=lambda t, F: F * t)
    assert not still.kernels.feeds and still.kernels.timed
    dry_run(late)
    dry_run(still)


def test_blocks_of_one_kind_share_their_kernels_and_survive_pickle():
    first, second = FirstOrder(3.0, 10.0), FirstOrder(2.0, 5.0, name="other")
    assert first.kernels is second.kernels
    for made in (first, StickSlip(), Constant("SP", 0.5)):
        again = pickle.loads(pickle.dumps(made))
        assert again.kernels is made.kernels and again.with_params().kernels is made.kernels


def test_a_port_with_a_name_that_python_keeps_for_itself():
    lead = LeadLag("FF", "D", K=2.0, T_lead=3.0, T_lag=1.0)
    assert lead.output(0.0, [0.0], [1.0]).tolist() == [6.0]  # analytic: K T_lead/T_lag


def test_events_and_samples_return_memories_first():
    """A counter of samples whose output is limited, and a clock that is set back by an event."""
    counter = type("Counter", (Block,), {
        "ports_in": (Port("in"),), "ports_out": (Port("n"),), "period_param": "dt",
        "kernels": Kernels(step=lambda count, in_, most: (count + in_, min(count + in_, most))),
    })(name="counter", params={"dt": 1.0, "most": 3.0}, memory={"count": 0.0})  # fmt: skip
    assert drive(counter, 4.0, every=1.0, **{"in": 1.0}).log["n"].tolist() == [1.0, 2.0, 3.0, 3.0, 3.0]
    clock = block(
        ins="", outs="age", states={"age": 0.0}, memory={"mode": 0.0, "rounds": 0.0}, params={"span": 2.0}, n_events=1,
        der=lambda age: 1.0 + 0.0 * age, zc=lambda age, span: age - span,
        jump=lambda event, mode, rounds: (mode, rounds + 1.0 + event, 0.0),
    )  # fmt: skip
    assert drive(clock, 5.0, every=1.0).log["age"].round(9).tolist()[1::2] == [1.0, 1.0, 1.0]  # analytic: t mod 2


@pytest.mark.parametrize(
    ("kernels", "message"),
    [
        ({"der": lambda L, q: q - L}, "der takes 'q', which is no state, memory, input or parameter"),
        ({"der": lambda L, F: (F, L)}, "der returns 2 values, but 1 are needed"),
        ({"der": lambda L, F: F, "out": lambda *all: 0.0}, "its arguments are read by name"),
        ({"der": lambda L, event: event - L}, "der takes 'event'"),
    ],
)
def test_what_cannot_be_is_refused(kernels, message):
    with pytest.raises(BlockError, match=message.replace("*", r"\*")):
        block(states={"L": 0.0}, **kernels)


def test_a_name_for_two_things_is_refused():
    with pytest.raises(BlockError, match="'F' is used twice"):
        block(states={"L": 0.0}, params={"F": 1.0}, der=lambda L, F: F - L)


# --- the stem as it was written before, with places in arrays: an oracle of its own --------------------------


def old_zc(x, d, u, p, g):
    spring = p[0] * (u[0] - x[0])
    g[0] = -1.0
    g[1] = -1.0
    if d[0] == STUCK:
        breakaway = max(p[4], p[3] + max(TIE * p[3], NOISE * p[0]))
        if spring > 0.0:
            g[0] = spring - breakaway if x[0] < p[6] else -1.0
        else:
            g[0] = -spring - breakaway if x[0] > p[5] else -1.0
    elif d[0] != IDEAL:
        forward = d[0] * x[1]
        braking = d[0] * spring < p[3] + (p[2] - slack(p[0], p[1], p[2])) * forward
        g[0] = (p[7] if braking else 0.0) - forward
        g[1] = x[0] - p[6] if d[0] == UP else p[5] - x[0]


def old_jump(x, d, u, p, k):
    if d[0] == STUCK:
        d[0] = UP if u[0] > x[0] else DOWN
    else:
        if k[0] == 1.0:
            x[0] = p[6] if d[0] == UP else p[5]
        elif d[0] * p[0] * (u[0] - x[0]) > p[3]:
            x[0] = min(max(u[0] - d[0] * p[3] / p[0], p[5]), p[6])
        d[0] = STUCK
    x[1] = 0.0


@given(st.floats(-0.1, 1.1), st.floats(-1.0, 1.0), st.floats(-0.2, 1.2), st.sampled_from([STUCK, UP, DOWN, IDEAL]))
def test_the_stem_with_names_is_the_stem_with_places(x, v, OP, mode):
    stem = StickSlip(F_s=1750.0)
    state, memory, u = np.array([x, v]), np.array([mode]), np.array([OP])
    expected, found = np.zeros(2), np.zeros(2)
    old_zc(state, memory, u, stem.p, expected)
    stem.kernels.zc(0.0, state, memory, u, stem.p, found)
    assert found.tolist() == expected.tolist()
    for event in (0.0, 1.0) if mode != IDEAL else ():
        here, there = (state.copy(), memory.copy()), (state.copy(), memory.copy())
        old_jump(*here, u, stem.p, [event])
        stem.kernels.jump(0.0, *there, u, stem.p, np.array([event]))
        assert [a.tolist() for a in here] == [a.tolist() for a in there]

"""A logged stem that stands still: what it says of the valve, and when its tag is dead."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from stickslip.calibration import draw, simulate
from stickslip.calibration.drawing import one
from stickslip.detect.judge.answer import answer
from stickslip.detect.judge.own_slips import own_slips
from stickslip.detect.judge.still_stem import still_stem
from stickslip.detect.prepare.prepared import Prepared
from stickslip.detect.stem.stick import stick
from stickslip.logs import LoopRecord

T = np.arange(2000.0)


def stuck():
    """A load that PV shows as it is, because the stem stands, and a PI that swings OP by 4.5 % in vain."""
    r = np.random.default_rng(1)
    load = np.zeros(len(T))
    for k in range(1, len(T)):
        load[k] = 0.97 * load[k - 1] + r.normal()
    load += 0.02 * np.std(load) * r.normal(size=len(T)) - np.mean(load)
    moves = -(load + np.cumsum(load) / 60.0)
    return load, 50.0 + 4.5 * (moves - 0.5 * (np.max(moves) + np.min(moves))) / np.ptp(moves)


LOAD, U = stuck()


def loop(mv, op=U, pv=LOAD, sp=None, span=(0.0, 100.0)):
    return Prepared(LoopRecord.from_arrays(T, pv=pv, op=op, sp=sp, mv=mv + 0.0 * T, op_span=span))


@settings(max_examples=60, deadline=None)
@given(st.floats(0.5, 15.0), st.floats(0.0, 1.0), st.floats(-1.0, 1.0), st.floats(0.2, 9.0), st.integers(0, 2**32 - 1))
def test_a_stem_that_stands_has_a_band_wider_than_the_range_of_op(S, share, start, size, seed):
    """Analytic, 2 f_S = S + J; and J <= S: of any OP, wherever the stem stood at first."""
    walk = np.cumsum(np.random.default_rng(seed).normal(size=300))
    u = size * (walk - walk[0]) / np.ptp(walk)
    stem = stick(u, S, share * S, start)
    if np.ptp(stem) == 0.0:
        assert np.ptp(u) <= S + share * S + 1e-6 and 0.5 * np.ptp(u) - 1e-6 <= S


def test_a_stem_that_stands_while_op_comes_and_goes_is_called_with_the_least_that_its_band_can_be():
    stem = stick(U, 6.0, 1.5, (U[0] - 50.0) / 3.75)  # from 50 %, f_S = 3.75 %
    assert np.ptp(stem) == 0.0
    said = answer(loop(stem))
    assert said.word == "stiction" and said.probability is None and said.S is None
    turned = still_stem(loop(stem)).turned
    assert turned >= 2
    assert f"never moves while OP travels 4.5 % of its span and turns back {turned} times" in said.reason
    assert "S + J above 4.5 % of OP" in said.reason and "deadband" in said.reason and "dead transmitter" in said.reason
    assert "valve maintenance" in said.action and "move OP by" in said.action


def test_the_noise_of_a_stem_that_stands_does_not_hide_it():
    noise = 0.02 * np.random.default_rng(5).normal(size=len(T))
    assert answer(loop(50.1 + noise)).word == "stiction"


def test_a_stem_that_follows_is_none_that_stands():
    noise = 0.02 * np.random.default_rng(6).normal(size=len(T))
    for mv in (stick(U, 0.4, 0.1) + noise, U + noise, 0.01 * U):  # 0.01: a stem in another unit
        assert still_stem(loop(mv)) is None


@pytest.mark.parametrize(
    "why, mv, op, span",
    [
        ("OP never goes", 65.0, U, (0.0, 100.0)),
        ("end of its span", 0.0, np.abs(U - 50.0), (0.0, 100.0)),
        ("only when OP moves further", 50.1, 50.0 + 0.35 * (U - 50.0), (0.0, 100.0)),  # 1.6 %
        ("only when OP moves further", 50.1, 50.0 + 4.0 * T / T[-1], (0.0, 100.0)),  # one way
        ("only when OP moves further", 50.1, U, None),  # in what unit is not known
    ],
)
def test_nothing_is_called_where_something_else_may_hold_the_stem_or_its_tag(why, mv, op, span):
    still = still_stem(loop(mv, op, span=span))
    assert still.means == "open" and why in still.why
    assert answer(loop(mv, op, span=span)).word != "stiction"


def test_moves_below_what_a_sound_valve_need_follow_say_nothing():
    assert still_stem(loop(50.0, 50.0 + 0.2 * (U - 50.0))) is None  # 0.9 %


def test_where_pv_follows_sp_the_tag_is_dead():
    """A first-order process behind a valve that moves; the tag of the stem says 50 throughout."""
    sp = np.where(T % 500.0 < 250.0, 40.0, 60.0)
    pv = np.zeros_like(T)
    op = np.full_like(T, 50.0)
    integral = 0.0
    for k in range(1, len(T)):
        pv[k] = pv[k - 1] + 0.1 * (2.0 * (op[k - 1] - 30.0) - pv[k - 1])
        integral += 0.02 * (sp[k] - pv[k])
        op[k] = 50.0 + 0.2 * (sp[k] - pv[k]) + integral
    still = still_stem(loop(float(np.mean(op)), op, pv, sp))
    assert still.means == "dead" and "PV follows the moves of SP" in still.why
    said = answer(loop(float(np.mean(op)), op, pv, sp))
    assert said.word != "stiction"


def test_where_pv_shows_slips_the_tag_is_dead_and_the_slips_answer():
    """A level behind a sticky valve, S = 4 % (analytic)."""
    t = np.arange(3000.0)
    u = 50 + 5 * np.sin(t / 60) + 2 * np.sin(t / 171)
    level = np.cumsum(50 - stick(u, 4.0, 1.0) + np.sin(t / 100))
    record = LoopRecord.from_arrays(t, pv=level, op=u, mv=0 * t + 50, op_span=(0, 100), process="integrating")
    assert own_slips(Prepared(record)) is not None
    said = answer(Prepared(record))
    assert said.word == "stiction" and said.S.value == pytest.approx(4.0, rel=0.05) and "tag is dead" in said.reason


def test_the_stem_of_the_plant_that_stands_is_called():
    """Constant feed, normal stiction, start 7: VPCS1 stands while OP travels 3.6 % (S + J = 7.4 %, S = 5.7 %)."""
    from benchmarks.thesis_cases import logs_of

    log = list(logs_of("constant", "normal", 8))[7]
    assert np.ptp(log["MV_VPCS1"]) == 0.0
    said = answer(Prepared(log.loop(name="PCS11")))
    assert said.word == "stiction" and "S + J above 3.6 % of OP" in said.reason


def test_of_simulated_loops_with_a_logged_stem_no_stem_is_said_to_stand_that_moves():
    """300 loops of the training law, seed 64100 used for nothing else."""
    for record, truth in simulate(draw(300, 64100, "training"), 1, mv=True):
        still = still_stem(Prepared(record))
        if still is not None and still.means == "sticks":
            assert truth.cause in ("stiction", "deadband") and np.ptp(record.mv) == 0.0


@pytest.mark.parametrize(("stuck", "low", "high"), [(True, 0.4, 1.0), (False, 0.0, 0.15)])
def test_a_frozen_tag_is_told_from_a_stuck_stem_by_a_pv_that_answers_op(stuck, low, high):
    """Simulated loops of seed 72103, the tag of the stem frozen at the median of OP; before, all asked were called.

    Of 133 others, seeds 72100 and 72101, 36 lie above the limit, of 25 whose valve passes nothing on 24.
    """
    groups = (
        ["dead_loop"] if stuck else ["healthy", "tight_tuning", "external_sine", "external_stochastic", "saturation"]
    )
    asked = called = 0
    for record, _ in simulate([one(groups[k % len(groups)], (72103, k, 0)) for k in range(40)], 1):
        if record.op_span is None:
            continue
        frozen = np.full(len(record), np.median(record.op))
        own = Prepared(
            LoopRecord.from_arrays(record.t, pv=record.pv, op=record.op, sp=record.sp, mv=frozen, op_span=(0.0, 100.0))
        )
        still = still_stem(own)
        if still is not None and still.means == "sticks":
            asked += 1
            called += answer(own).word == "stiction"
    assert asked >= 10
    assert low * asked <= called <= high * asked

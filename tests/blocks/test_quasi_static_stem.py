"""The massless stem: against a turning-point oracle, against the full-mass stem, and in loops with closed forms."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from stickslip.blocks.dead_time import DeadTime
from stickslip.blocks.first_order import FirstOrder
from stickslip.blocks.periodic import Sine
from stickslip.blocks.pi import PI
from stickslip.blocks.ports import BlockError
from stickslip.blocks.quasi_static_stem import QuasiStaticStem
from stickslip.blocks.recorded import Recorded
from stickslip.blocks.sampled_pi import SampledPI
from stickslip.blocks.sources import Step
from stickslip.blocks.stick_slip import StickSlip
from stickslip.diagram import drive, simulate, wire
from stickslip.diagram.reference import simulate_reference

LAG = 612.0 / 52500.0  # s; analytic: how far behind its massless twin the thesis's stem slides, per rate of OP
WIDE = {"low": -math.inf, "high": math.inf}


def turning_points(levels, f_s, f_c, x):
    """Independent oracle: stem position after each monotone move of OP, moves being all that matters without mass."""
    found, sliding, before = [], 0.0, levels[0]
    for op in levels:
        if (op - before) * sliding < 0.0:
            sliding = 0.0
        if sliding == 0.0 and abs(op - x) > f_s:
            sliding = math.copysign(1.0, op - x)
        if sliding != 0.0:
            x = op - sliding * f_c
        found.append(x)
        before = op
    return np.array(found)


def on_a_grid(low, high):
    """Levels on a grid that no sum or difference of the bands below hits: breakaway never hangs on rounding."""
    return st.lists(st.integers(low, high).map(lambda n: n / 64.0), min_size=2, max_size=20)


@settings(max_examples=60)
@given(
    levels=on_a_grid(-64, 128), J=st.sampled_from([0.0, 0.0213, 0.171]), hold=st.sampled_from(["linear", "previous"])
)
def test_any_walk_of_op(levels, J, hold):
    S = 0.1714
    source = Recorded("OP", np.arange(len(levels)), levels, hold=hold)
    valve = QuasiStaticStem(S, J, start=levels[0], **WIDE)
    run = simulate(wire([source, valve]), float(len(levels)), times=np.arange(len(levels)))
    assert run.ok
    np.testing.assert_allclose(run.log["MV"], turning_points(levels, valve.f_s, valve.f_c, levels[0]), atol=1e-9)
    assert np.all(np.abs(run.log["OP"] - run.log["MV"]) <= valve.f_s + 1e-9)  # analytic: no larger force exists


@pytest.mark.parametrize("F_s", [1250.0, 1750.0, 2250.0])
@pytest.mark.parametrize("period", [37.0, 100.0])
def test_follows_the_full_mass_stem(F_s, period):
    source, heavy = Sine("OP", 0.1, period, mean=0.5), StickSlip(F_s, start=0.5)
    every = period / 2000
    full = simulate(wire([source, heavy]), 3 * period, every=every, rtol=1e-8, atol=1e-11)
    light = simulate(wire([source, heavy.quasi_static()]), 3 * period, every=every)
    apart = np.abs(full.log["MV"] - light.log["MV"])
    slips = [e.t for e in light.events if e.before == "stuck"]
    settled = np.ones(len(apart), dtype=bool)
    for slip in slips:
        settled &= ~((light.log.t >= slip - 1e-6) & (light.log.t < slip + 0.1))
    peak_rate = 0.1 * 2 * math.pi / period
    # analytic: the lag F_v/k at the largest rate of OP, plus what is left of a jump after 0.1 s
    assert apart[settled].max() <= LAG * peak_rate * 1.001 + heavy.J * 2e-5
    assert apart[settled].max() >= LAG * peak_rate * 0.9  # and it is the lag
    assert [e.after for e in full.events] == [e.after for e in light.events]
    np.testing.assert_allclose([e.t for e in full.events], [e.t for e in light.events], atol=1.1 * LAG)


def test_jump_and_corners():
    valve = QuasiStaticStem(start=0.5)
    run = drive(valve, 100.0, every=0.01, OP=Recorded("OP", [0, 50, 100], [0.5, 0.7, 0.5]))
    moves = np.abs(np.diff(run.log["MV"]))
    op_step = 0.2 / 50 * 0.01
    assert np.sort(moves)[-2:] == pytest.approx([valve.J] * 2, abs=op_step)  # analytic; published 0.0191
    slip = run.events[2]
    op = 0.7 - (slip.t - 50) * 0.2 / 50
    assert 0.7 - op == pytest.approx(valve.S, abs=1e-9)  # analytic: S after the reversal
    assert [e.after for e in run.events] == ["sliding up", "stuck", "sliding down"]


def test_held_op_does_not_stop_a_slide_for_good():
    t, op = [0.0, 1.0, 5.0, 6.0, 7.0], [0.5, 0.6, 0.6, 0.605, 0.6]
    run = drive(QuasiStaticStem(S=0.06, J=0.02, start=0.5), 7.0, every=1.0, OP=(t, op))
    assert run.log["MV"][[1, 4, 6, 7]] == pytest.approx([0.58, 0.58, 0.585, 0.585])  # analytic: OP - f_c, then stuck


def test_stops():
    t, op = [0.0, 1.0, 2.0, 12.0], [0.5, 1.5, 1.5, 0.5]
    run = drive(QuasiStaticStem(S=0.06, J=0.02, start=0.5), 12.0, every=0.1, OP=(t, op))
    assert [e.after for e in run.events] == ["sliding up", "stuck", "sliding down"]
    assert run.log["MV"].max() == 1.0
    assert run.events[1].t == pytest.approx(0.52)  # analytic: OP - f_c reaches 1
    assert run.events[2].t == pytest.approx(2 + 10 * 0.54)  # analytic: 1 - OP = f_s
    jumped = drive(QuasiStaticStem(S=0.06, J=0.02, start=0.9), 1.0, every=1.0, OP=Step("OP", 2.0, 0.9, at=0.5))
    assert jumped.log["MV"].tolist() == [0.9, 1.0] and jumped.events[-1].after == "stuck"


def test_nothing_moves_within_the_band_or_at_rest():
    valve = QuasiStaticStem(start=0.5)
    small = drive(valve, 500.0, OP=Sine("OP", 0.999 * valve.f_s, 50.0, mean=0.5))
    rest = drive(valve, 500.0, OP=0.5)
    for run in (small, rest):
        assert run.events == () and np.all(run.log["MV"] == 0.5)


def thesis_loop(controller, valve, r):
    return wire([Step("SP", r), controller, valve, FirstOrder(3.0, 10.0)])


@pytest.mark.parametrize(("F_s", "K_p", "r", "T"), [(2250.0, 0.4, 0.5, 350 / 3), (1750.0, 0.4, 3 / 7, 200.0)])
def test_limit_cycle_of_the_pole_cancelled_loop(F_s, K_p, r, T):
    # analytic: T = S T_i/(K_p K J)/(alpha (1 - alpha)) with alpha = 1/2; published 117 and 200 s
    loop = thesis_loop(PI(K_p=K_p, T_i=10.0, **WIDE), StickSlip(F_s).quasi_static(), r)
    run = simulate(loop, 1200.0, every=1.0, rtol=1e-9, atol=1e-12)
    assert run.ok
    slips = np.array([e.t for e in run.events if e.block == "valve" and e.after == "sliding up"])
    np.testing.assert_allclose(np.diff(slips)[1:], T, rtol=1e-4)
    x = run.log["MV"][run.log.t > 300.0]
    assert np.ptp(x) == pytest.approx(StickSlip(F_s).J, rel=1e-4)  # analytic: it jumps and sticks at once


def test_sampled_controller_sticks_at_the_old_position():
    loop = thesis_loop(SampledPI(K_p=0.4, T_i=10.0, dt=1.0, **WIDE), StickSlip.high().quasi_static(), 0.5)
    run = simulate(loop, 1200.0, every=1.0)
    assert run.ok
    x, op = run.log["MV"], run.log["OP"]
    valve = StickSlip.high().quasi_static()
    np.testing.assert_allclose(x, turning_points([0.0, *op], valve.f_s, valve.f_c, 0.0)[1:], atol=1e-9)
    assert len(run.events) > 10  # and it cycles


def test_linear_views():
    ideal, held = QuasiStaticStem().in_mode("ideal"), QuasiStaticStem(start=0.3)
    assert float(ideal.output(0.0, [], [0.7])[0]) == 0.7
    assert float(held.output(0.0, held.seen_start(), [0.7])[0]) == 0.3


def test_misuse_is_explained():
    with pytest.raises(BlockError, match=r"J = 0.1, but 0 <= J <= S = 0.05.*raise S"):
        QuasiStaticStem(S=0.05, J=0.1)
    with pytest.raises(BlockError, match=r"S = -0.1"):
        QuasiStaticStem(S=-0.1, J=0.0)
    with pytest.raises(BlockError, match=r"J = -0.1"):
        QuasiStaticStem.from_friction(f_s=0.1, f_c=0.2)
    with pytest.raises(BlockError, match=r"start = -0.5, but the stops"):
        QuasiStaticStem(start=-0.5)
    with pytest.raises(BlockError, match=r"high = 0.0"):
        QuasiStaticStem(high=0.0)


def test_a_held_op_behind_a_dead_time_does_not_stop_the_stem():
    # found by benchmarks.torture, seed 34: rounding in the dead time looked like a reversal, and J was needed again
    rng = np.random.default_rng(1)
    at = np.arange(60) * 0.5
    op = np.cumsum(rng.uniform(0.001, 0.01, at.size))  # only ever upwards, by less than J
    late = wire([
        Recorded("OP", at, op, hold="previous"), DeadTime(1.234567, inputs="OP", outputs="late"),
        QuasiStaticStem(S=0.06, J=0.03, inputs="late"),
    ])  # fmt: skip
    times = at[10:] + 1.234567 + 0.237
    moving = op[10:] > op[np.argmax(op > 0.045)] - 1e-12
    expected = op[10:] - 0.015  # analytic: once it has slipped it slides, MV = OP - f_c
    for run in (simulate(late, 40.0, times=times), simulate_reference(late, 40.0, times=times)):
        assert moving.sum() > 30
        assert np.abs(run.log["MV"] - expected)[moving].max() < 1e-12


@pytest.mark.parametrize(("mode", "op", "stop"), [("sliding up", 0.0, 0.0), ("sliding down", 1.0, 1.0)])
@pytest.mark.parametrize("run", [simulate, simulate_reference])
def test_a_stem_started_beyond_the_stop_behind_it_rests_there(run, mode, op, stop):
    # analytic: f_s = 0.04, f_c = 0.02; OP moves inwards by 0.1 in 1 s, so that the stem rests until 0.4 s
    inwards = 0.1 if op == 0.0 else -0.1
    stem = QuasiStaticStem(0.06, 0.02, start=0.5).in_mode(mode)
    log = run(wire([Recorded("OP", [0.0, 1.0], [op, op + inwards]), stem]), 1.0, times=[0.0, 0.3, 1.0]).log
    assert log["MV"] == pytest.approx([stop, stop, op + inwards - 0.2 * inwards], abs=1e-9)

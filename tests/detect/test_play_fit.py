"""The play fit: an exact play comes back, valves of three models with and without a cycle, what proves nothing."""

import numpy as np
import pytest
from scipy.signal import lfilter
from stickslip.detect.methods import play_fit
from stickslip.detect.methods.play_fit import detect, fit
from stickslip.detect.stem.controller import controller_sign
from stickslip.detect.stem.lags import Lags
from stickslip.detect.stem.stick import stick, turns
from stickslip.logs import LoopRecord

MOVES = tuple(2.0 * np.cumsum(np.random.default_rng(3).normal(size=20)))


def swings(n=1200):
    t = np.arange(float(n))
    return 5 * np.sin(t / 15) + 2 * np.sin(t / 47)


def test_play_against_the_closed_form():
    u = np.array([0.0, 2.0, 5.0, 3.0, -1.0, -4.0, 0.0, 3.0])
    # analytic: a play of width 4 is the recursion x = clip(x, u - 2, u + 2)
    assert stick(u, 4.0).tolist() == [0.0, 0.0, 3.0, 3.0, 1.0, -2.0, -2.0, 1.0]


@pytest.mark.parametrize(("S", "J"), [(6.0, 4.0), (3.0, 0.0), (5.0, 5.0)])
def test_stick_is_the_valve_of_kano(S, J, sticky):
    record = sticky(S=S, J=J, noise=0.05, moves=MOVES)
    found = stick(record.op, S, J)
    same = np.isclose(found, record.mv, atol=1e-9)
    assert same[np.argmax(same) :].mean() > 0.9  # the start of the record is not known; then the stems agree


def test_turns():
    assert turns(np.array([0.0, 5.0, 4.0, 6.0, 1.0, 2.0, 0.0, 7.0]), 3.0).tolist() == [3, 6]
    assert not len(turns(np.arange(100.0), 5.0))


def test_lags_tell_a_chain_of_lags_and_dead_time_but_no_derivative():
    u = np.cumsum(np.random.default_rng(1).normal(size=1500))
    late = lfilter([0.1], [1, -0.9], np.concatenate([np.zeros(12), u[:-12]]))
    assert 1 - (model := Lags(late, 60.0)).fit(u[:, None])[0].rss / model.tss > 0.999
    rate = np.gradient(u)
    assert 1 - (model := Lags(rate, 60.0)).fit(u[:, None])[0].rss / model.tss < 0.5


@pytest.mark.parametrize(("S", "start"), [(4.0, 0.0), (2.5, 1.0), (7.0, -0.5)])
def test_exact_play_gives_S(S, start):  # analytic: PV is the play of OP itself
    u = swings()
    found = fit(u, stick(u, S, 0.0, start), 47.0)
    assert abs(found.S - S) < 0.02 * S and found.J < 0.05 * S
    assert found.ratio > 5 and found.wins == 1.0 and found.low <= found.S <= found.high


@pytest.mark.parametrize("process", ["self_regulating", "integrating"])
def test_exact_play_behind_a_process(process):
    u, rng = swings(), np.random.default_rng(0)
    x = stick(u, 4.0)
    inside = np.cumsum(x - x.mean()) * 0.02 if process == "integrating" else lfilter([0.1], [1, -0.9], x)
    found = fit(u, inside + 0.05 * rng.normal(size=len(u)), 47.0, kinds=(process == "integrating",))
    assert abs(found.S - 4.0) < 0.2
    assert found.ratio > 1.4 and found.gain > 100


def test_without_play_there_is_none():
    u = swings()
    y = lfilter([0.05], [1, -0.95], np.concatenate([np.zeros(5), u[:-5]]))
    found = fit(u, y + 0.02 * np.random.default_rng(0).normal(size=len(u)), 47.0)
    assert found.ratio < 1.05 and found.explained_without > 0.99


@pytest.mark.parametrize("valve", ["kano", "choudhury", "he"])
@pytest.mark.parametrize("process", ["self_regulating", "integrating"])
def test_valves_in_an_even_cycle(valve, process, simulated):
    v = detect(simulated(valve, process, S=6.0, J=4.0, n=1500 if process == "self_regulating" else 4000))
    if v.verdict != "stiction":  # a cycle that repeats exactly has another explanation, which is said
        assert v.verdict == "inconclusive" and ("constant period" in v.reason or "deadband" in v.reason), v.reason
    assert 4.2 < 100 * v.evidence["S"] < 7.0  # S = 6 %, slip and lag trade places in a steady cycle


@pytest.mark.parametrize("valve", ["kano", "choudhury", "he"])
def test_stiction_under_set_point_moves(valve, simulated):
    v = detect(simulated(valve, "integrating", S=3.0, J=1.5, moves=MOVES, n=3000))
    assert v.verdict == "stiction", v.reason
    assert v.amount_percent_op == pytest.approx(3.0, rel=0.3)


@pytest.mark.parametrize("noise", [0.02, 0.2])
def test_deadband_is_sized_and_is_not_stiction(noise, sticky):
    record = sticky(S=4.0, J=0.0, noise=noise, moves=MOVES)
    v = detect(record)
    assert v.verdict == "inconclusive" and "deadband" in v.reason, v.reason
    assert v.evidence["S"] == pytest.approx(4.0, rel=0.1)
    assert v.evidence["S_low"] < 4.0 < v.evidence["S_high"]


def test_wave_from_outside_keeps_time_and_is_not_stiction(outside_square):
    accused = [detect(outside_square(seed)).verdict == "stiction" for seed in range(12)]
    assert not any(accused)


def test_outside_wave_is_the_rival_that_wins():
    """The rival tells an outside square wave that OP has nothing to do with, and no valve does."""
    rng = np.random.default_rng(0)
    t = np.arange(1500.0)
    u = swings(1500)
    y = lfilter([0.1], [1, -0.9], u) + 3.0 * np.sign(np.sin(2 * np.pi * t / 61.0)) + 0.05 * rng.normal(size=1500)
    assert fit(u, y, 47.0, wave=60.0).clock < 0.5


@pytest.mark.parametrize("process", ["self_regulating", "integrating"])
@pytest.mark.parametrize("noise", [0.02, 0.2])
def test_healthy_valve_is_cleared_with_a_size(process, noise, sticky):
    v = detect(sticky(process, S=0.0, J=0.0, noise=noise, moves=MOVES))
    assert v.verdict == "no_stiction", v.reason
    assert "S below" in v.reason and v.amount_percent_op is None


def test_constant_set_point_clears_nothing(sticky, loop, wave):
    t = np.arange(2000.0)
    disturbed = loop(t, wave("sine", t) + 0.1 * np.random.default_rng(0).normal(size=2000))
    for record in (disturbed, sticky(S=0.0, J=0.0, noise=0.3)):
        v = detect(record)
        assert v.verdict == "inconclusive", v.reason


def test_one_way_drift_proves_nothing():
    t = np.arange(1500.0)
    rng = np.random.default_rng(0)
    op = 40 + 0.01 * t  # OP makes up for a load ramp while PV stays at SP, then a second ramp begins
    pv = 30 + np.where(t > 700, 0.01 * (t - 700), 0.0) + 0.02 * rng.normal(size=1500)
    v = detect(LoopRecord.from_arrays(t, pv=pv, op=op + 0.02 * rng.normal(size=1500), sp=0 * t + 30))
    assert v.verdict == "inconclusive" and "drift" in v.reason


def test_load_with_random_walk_accuses_nobody():
    words = []
    for seed in range(12):
        rng = np.random.default_rng(seed)
        load, e, pv, i, rows = 0.0, 0.0, 0.0, 0.0, []
        for _ in range(1500):
            load += 0.2 * rng.normal()
            e = -pv - 0.05 * rng.normal()
            i += 0.05 * e
            op = i + 0.5 * e
            pv += 0.1 * (op + load - pv)
            rows.append((-e, op))
        y, u = np.array(rows).T
        words.append(detect(LoopRecord.from_arrays(np.arange(1500.0), pv=y, op=50 + u, sp=0 * y)).verdict)
    assert words.count("stiction") == 0


@pytest.mark.parametrize("process", ["self_regulating", "integrating"])
def test_unit_offset_sign_and_action_do_not_matter(process, sticky):
    base = sticky(process, noise=0.05)
    first = detect(base)
    for gain, offset, op_gain in ((-3.0, 40.0, 1.0), (0.1, 0.0, -1.0), (1e3, -7.0, -1.0)):
        other = LoopRecord.from_arrays(
            base.t, pv=gain * base.pv + offset, op=50 + op_gain * (base.op - 50), sp=gain * base.sp + offset,
            process=process,
        )  # fmt: skip
        v = detect(other)
        assert v.verdict == first.verdict
        assert v.index == pytest.approx(first.index, rel=1e-3)
        assert v.amount_percent_op == pytest.approx(first.amount_percent_op, rel=1e-3)
    span = LoopRecord.from_arrays(
        base.t, pv=base.pv, op=4 + 0.16 * base.op, sp=base.sp, process=process, op_span=(4.0, 20.0)
    )
    assert detect(span).amount_percent_op == pytest.approx(first.amount_percent_op, rel=1e-3)


def test_resampled_by_two(sticky):
    base = sticky("integrating", noise=0.02)
    half = LoopRecord.from_arrays(
        base.t[::2], pv=base.pv[::2], op=base.op[::2], sp=base.sp[::2], process="integrating"
    )  # fmt: skip
    assert detect(half).verdict == "stiction"
    assert detect(half).amount_percent_op == pytest.approx(detect(base).amount_percent_op, rel=0.1)


def test_controller_sign(sticky):
    record = sticky(noise=0.1)
    assert controller_sign(record.op, record.e) == 1.0
    assert controller_sign(-record.op, record.e) == -1.0


def test_too_short(sticky):
    record = sticky(n=150)
    assert detect(record).code in ("too_few_cycles", "compressed")


def test_picture(sticky):
    figure = detect(sticky(noise=0.1)).plot()
    figure.canvas.draw()
    assert len(figure.axes) == 3
    assert play_fit.CARD.experimental

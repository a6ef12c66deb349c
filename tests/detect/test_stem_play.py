"""Stem and OP: S, J and positioner of known valves come back; deadband and healthy valves are told from sticky ones."""

import numpy as np
import pytest
from stickslip.detect.methods.stem_play import detect
from stickslip.detect.prepare.prepared import Prepared
from stickslip.detect.stem.logged_stem import band, stem
from stickslip.detect.stem.stick import stick
from stickslip.logs import LoopRecord

MOVES = tuple(2.0 * np.cumsum(np.random.default_rng(3).normal(size=20)))


def swings(n=4000):
    t = np.arange(float(n))
    return 50 + 5 * np.sin(t / 40) + np.sin(t / 171)


@pytest.mark.parametrize(("S", "J"), [(4.0, 1.5), (5.0, 5.0), (3.0, 0.0)])
@pytest.mark.parametrize("noise", [0.0, 0.02])
def test_known_stick_and_positioner(S, J, noise):  # analytic: as made
    u = swings()
    mv = 2.0 + 0.5 * stick(u, S, J) + noise * np.random.default_rng(0).normal(size=len(u))
    found = stem(u, mv, noise)
    assert found.S[0] == pytest.approx(S, abs=0.15)
    assert found.J[0] == pytest.approx(J, abs=0.3)
    assert found.lag == 0
    if found.gain_known:
        assert found.gain == pytest.approx(0.5, rel=0.1)
        assert found.offset + found.gain * 50 == pytest.approx(27.0, abs=0.2)


def test_band():  # analytic: a triangle that swings by more than S strays by S + J, a copy not at all
    u = 50 + 8 * (np.abs((np.arange(4000.0) % 400) / 200 - 1) - 0.5)
    assert band(u, 3.0 + 2.0 * u) == pytest.approx(0.0, abs=1e-9)
    assert band(u, stick(u, 2.0, 0.0)) < 3.0
    assert band(u, -u) == np.inf


@pytest.mark.parametrize(("S", "J"), [(4.0, 1.0), (4.0, 4.0), (2.0, 1.0)])
def test_no_delay_is_read_from_rounding(S, J):
    """On an even ramp S scatters by rounding alone, of which the least is no sign of a delay (S was 0.7 too small)."""
    u = 50 + 12 * (np.abs((np.arange(2400.0) % 200) / 100 - 1) - 0.5)
    found = stem(u, stick(u, S, J))
    assert found.lag == 0 and found.S[0] == pytest.approx(S, abs=0.06)  # analytic, to half of OP's step


def test_late_stem():
    u = swings()
    found = stem(u, np.concatenate([[50.0, 50.0], stick(u, 4.0, 1.5)[:-2]]))
    assert found.S[0] == pytest.approx(4.0, abs=0.5)


@pytest.mark.parametrize("valve", ["kano", "choudhury", "he"])
@pytest.mark.parametrize("process", ["self_regulating", "integrating"])
@pytest.mark.parametrize("moves", [(), MOVES])
def test_valves_in_loops(valve, process, moves, simulated):
    v = detect(simulated(valve, process, S=6.0, J=2.0, n=4000, moves=moves))
    assert v.verdict == "stiction", v.reason
    assert v.amount_percent_op == pytest.approx(6.0, rel=0.03)
    assert v.index == pytest.approx(2.0, abs=0.15)
    assert v.evidence["S_low"] - 0.1 < 6.0 < v.evidence["S_high"] + 0.1
    assert v.evidence["deadband"] == pytest.approx(4.0, abs=0.3)


@pytest.mark.parametrize("noise", [0.02, 0.2])
def test_noisy_loop(noise, sticky):
    v = detect(sticky(S=3.0, J=3.0, noise=noise))
    assert v.verdict == "stiction" and v.amount_percent_op == pytest.approx(3.0, rel=0.05)


def test_deadband_is_no_stick(sticky):
    v = detect(sticky("integrating", S=4.0, J=0.0, noise=0.02))
    assert v.verdict == "no_stiction" and "deadband" in v.reason
    assert v.evidence["S"] == pytest.approx(4.0, abs=0.1)
    assert v.amount_percent_op is None


@pytest.mark.parametrize("process", ["self_regulating", "integrating"])
def test_healthy_valve(process, sticky):
    for moves in ((), MOVES):
        v = detect(sticky(process, S=0.0, J=0.0, noise=0.1, moves=moves))
        assert v.verdict == "no_stiction" and "below" in v.reason


@pytest.mark.parametrize("own", [0.0, 0.05, 0.5])
def test_stem_that_copies_a_noisy_op(own):
    rng, t = np.random.default_rng(0), np.arange(3000.0)
    for wave in (np.sin(t / 20), np.sign(np.sin(t / 20)), np.cumsum(0.1 * rng.normal(size=3000))):
        op = 50 + 3 * wave + 0.3 * rng.normal(size=3000)
        mv = op + own * rng.normal(size=3000)
        assert detect(LoopRecord.from_arrays(t, pv=op, op=op, mv=mv)).verdict in ("no_stiction", "inconclusive")


def test_stem_of_another_valve():
    rng = np.random.default_rng(0)
    u, other = swings(), 50 + 5 * np.cumsum(rng.normal(size=4000) * (rng.random(4000) < 0.02))
    assert detect(LoopRecord.from_arrays(np.arange(4000.0), pv=rng.normal(size=4000), op=u, mv=other)).verdict == (
        "inconclusive"
    )


def test_unit_and_action_do_not_matter(sticky):
    base = sticky(noise=0.05)
    first = detect(base)
    for a, span in ((-1.0, (-100.0, 0.0)), (0.16, (0.0, 16.0))):
        other = LoopRecord.from_arrays(base.t, pv=base.pv, op=a * base.op, mv=a * base.mv, sp=base.sp, op_span=span)
        v = detect(other)
        assert v.verdict == first.verdict
        assert v.amount_percent_op == pytest.approx(first.amount_percent_op, rel=1e-6)
        assert v.index == pytest.approx(first.index, rel=1e-6)


def test_refusals_and_picture(sticky, bare):
    assert detect(bare(sticky(noise=0.1))).code == "signal_missing"
    assert detect(sticky(n=150, noise=0.1)).code == "too_few_cycles"
    figure = detect(sticky(noise=0.1)).plot()
    figure.canvas.draw()
    assert len(figure.axes) == 4


def _clipped(S, J, seat, n=6000):
    """A valve whose OP runs into both limits, and whose stem may meet its seat and stop before."""
    u = np.clip(50 + 58 * np.sin(np.arange(n) / 150) + 9 * np.sin(np.arange(n) / 17), 0.0, 100.0)
    x = stick(u, S, J)
    mv = np.clip(1.2 * (x - 50) + 50, 0.0, 100.0) if seat else x
    noisy = mv + 0.02 * np.random.default_rng(1).normal(size=n)
    return LoopRecord.from_arrays(np.arange(float(n)), pv=30 + mv / 9, op=u, mv=noisy, sp=np.full(n, 30.0))


@pytest.mark.parametrize("seat", [False, True])
def test_a_saturated_op_does_not_silence_the_stem(seat):
    sticky, loose = detect(_clipped(5.0, 2.0, seat)), detect(_clipped(5.0, 0.0, seat))
    assert Prepared(_clipped(5.0, 2.0, seat)).present[0].code == "op_saturated"
    assert sticky.verdict == "stiction", sticky.reason
    assert sticky.evidence["S"] == pytest.approx(5.0, rel=0.1)  # analytic
    assert sticky.index == pytest.approx(2.0, rel=0.25)
    assert loose.verdict != "stiction", loose.reason


def test_a_saturated_op_of_unknown_span_is_refused():
    record = _clipped(5.0, 2.0, False)
    op = np.clip(record.op, 20.0, 80.0)  # stands at its own extremes for more than a fifth of the time
    assert detect(LoopRecord.from_arrays(record.t, pv=record.pv, op=op, mv=record.mv, sp=record.sp)).applicable
    blind = LoopRecord.from_arrays(record.t, pv=record.pv, op=op, mv=record.mv, sp=record.sp, op_span=None)
    assert detect(blind).code == "op_saturated"


def _with_reversals(n, S):
    """OP sweeps back and forth, so that the stem turns back n times, each after its own S [%] (analytic: as made)."""
    u, mv, here = [50.0], [50.0], 50.0
    for k in range(n + 1):
        way = 1.0 if k % 2 else -1.0
        for travelled in 0.05 * np.arange(1, 400):
            u.append(u[-1] + way * 0.05)
            if travelled > S[k % len(S)]:
                here += way * (0.05 if mv[-1] != mv[-2] else 1.0)
            mv.append(here)
    noise = 0.004 * np.random.default_rng(2).normal(size=len(u))
    t = np.arange(float(len(u)))
    return LoopRecord.from_arrays(t, pv=30 + np.array(mv) / 9 + noise, op=u, mv=np.array(mv) + noise, sp=0 * t + 30)


def test_three_reversals_do_where_they_agree():
    three, two = detect(_with_reversals(3, [5.0])), detect(_with_reversals(2, [5.0]))
    assert len(three.array("S_each")) == 3 and three.verdict == "stiction", three.reason
    assert three.evidence["S"] == pytest.approx(5.0, abs=0.1)
    assert two.verdict == "inconclusive" and "4 are needed" in two.reason
    apart = detect(_with_reversals(3, [5.0, 3.0, 4.0]))
    assert len(apart.array("S_each")) == 3 and apart.verdict == "inconclusive", apart.reason


def _every_few_samples(S, J, samples, n=900):
    """OP in a triangle of so many samples a turn and 10 % wide; the stem is read with a little noise."""
    t = np.arange(float(n))
    u = 45 + 10 * np.abs(2 * (t / samples % 1.0) - 1)
    mv = stick(u, S, J) + 0.02 * np.random.default_rng(4).normal(size=n)
    return LoopRecord.from_arrays(t, pv=30 + mv / 9, op=u, mv=mv, sp=0 * t + 30, op_span=(0, 100))


@pytest.mark.parametrize("samples", [9.3, 11.7])
def test_a_stem_that_slips_every_few_samples_is_not_taken_for_noise(samples):  # analytic: as made
    v = detect(_every_few_samples(6.0, 5.0, samples))
    assert v.verdict == "stiction", v.reason
    assert v.evidence["S"] == pytest.approx(6.0, rel=0.15)


@pytest.mark.parametrize("S", [3.0, 4.1, 6.0, 7.2])
@pytest.mark.parametrize("samples", [8.0, 9.3, 20.0])
def test_what_op_moves_in_a_sample_is_no_jump(S, samples):
    v = detect(_every_few_samples(S, 0.0, samples))
    assert v.verdict != "stiction", v.reason


def test_two_places_that_are_nearly_multiples_of_the_jump_are_no_rounding():
    """A valve that only slips to and fro: S = 4, J = 1.9 (analytic), from 0.5 % of J beside a multiple of it."""
    u = 50 + 2.1 * np.sin(np.arange(3000) / 25)
    mv = np.where(stick(u, 4.0, 1.9, start=1.0) > np.mean(u), 6.005 * 1.9, 5.005 * 1.9)
    found = detect(LoopRecord.from_arrays(np.arange(3000.0), pv=u, op=u, mv=mv, op_span=(0.0, 100.0)))
    assert found.verdict == "stiction" and pytest.approx(4.0, rel=0.1) == found.amount_percent_op

"""Knocker, constant reinforcement, two moves and gaps: beside equations written apart, and what they do to a loop."""

import math

import numpy as np
import pytest
from stickslip.blocks import (
    BlockError,
    ChenValve,
    ConstantReinforcement,
    Deadband,
    FirstOrder,
    GapPI,
    HeValve,
    Knocker,
    SampledPI,
    Sine,
    Step,
    TwoMove,
)  # fmt: skip
from stickslip.diagram import drive, simulate, wire

WIDE = {"low": -math.inf, "high": math.inf}
F_S, F_D, K, TAU, SP = 0.0429, 0.0238, 3.0, 10.0, 0.5


def looped(*more, valve=None, controller=None, K_p=0.4, T_i=10.0):
    """The ideal loop with a scan of 1 s; ``more`` blocks stand between controller and valve."""
    law = controller or SampledPI(K_p, T_i, dt=1.0, **WIDE, outputs={"OP": "OP_c" if more else "OP"})
    stem = valve or HeValve(F_S, F_D, 1.0, **WIDE)
    return wire([Step("SP", after=SP), law, *more, stem, FirstOrder(K, TAU)])


def by_hand(scans, between, gap=0.0, zone=0.0, K_p=0.4, T_i=10.0):
    """Independent reference: PI, whatever is between, He's stem and the lag under a hold, in plain numbers."""
    a = math.exp(-1.0 / TAU)
    z = y = m = 0.0
    rows = []
    for k in range(scans):
        e = SP - y
        over = math.copysign(max(abs(e) - gap, 0.0), e)
        u = K_p * over + z
        z += K_p * over / T_i if abs(e) > zone else 0.0
        op = between(k, u)
        c = op - m
        if abs(c) > F_S:
            m = op - math.copysign(F_D, c)
        rows.append((y, m))
        y = a * y + (1.0 - a) * K * m
    return np.array(rows)


def logged(diagram, scans):
    log = simulate(diagram, scans - 1.0, every=1.0, rtol=1e-10, atol=1e-13).log
    return np.column_stack([log["PV"], log["MV"]])


class Pulses:
    """Hagglund's pulses in plain numbers."""

    def __init__(self, a, period, width):
        self.a, self.period, self.width, self.last, self.way = a, period, width, 0.0, 0.0

    def __call__(self, k, u):
        if (k + 1) % self.period == 0:
            self.way, self.last = np.sign(u - self.last), u
        return u + (self.a * self.way if k + 1 >= self.period and (k + 1) % self.period < self.width else 0.0)


def test_a_loop_with_a_knocker_beside_one_written_apart():
    made = logged(looped(Knocker(0.03, 5.0, 2.0, 1.0)), 400)
    np.testing.assert_allclose(made, by_hand(400, Pulses(0.03, 5, 2)), atol=1e-8)


@pytest.mark.parametrize(("gap", "zone"), [(0.0, 0.0), (0.03, 0.0), (0.0, 0.04), (0.01, 0.05)])
def test_a_loop_with_gaps_beside_one_written_apart(gap, zone):
    controller = GapPI(0.4, 10.0, dt=1.0, gap=gap, zone=zone, **WIDE)
    made = logged(looped(controller=controller), 400)
    np.testing.assert_allclose(made, by_hand(400, lambda k, u: u, gap, zone), atol=1e-8)


def test_without_gap_and_zone_it_is_the_plain_controller():
    t = np.arange(50.0)
    given = {"SP": (t, np.sin(t)), "PV": 0.1, "every": 1.0}
    law = {"K_p": 1.5, "T_i": 6.0, "dt": 1.0, "low": -1.0, "high": 1.0}
    plain, gap = (drive(kind(**law), 49.0, **given).log["OP"] for kind in (SampledPI, GapPI))
    np.testing.assert_array_equal(gap, plain)


def test_half_the_play_added_undoes_the_play():
    # analytic: a stem with play of width w follows OP -+ w/2, and what is added is +-w/2
    t = np.arange(0.0, 200.0)
    wave = 0.3 * np.sin(t / 12.0)
    made = drive(ConstantReinforcement(0.02, 1.0), 199.0, every=1.0, OP_c=(t, wave)).log["OP"]
    stem = drive(Deadband(0.04, **WIDE), 199.0, every=1.0, OP=(t, made)).log["MV"]
    np.testing.assert_allclose(stem[5:], wave[5:], atol=2e-3)  # but for the scan in which it turns


def test_small_ways_back_do_not_turn_it():
    more = ConstantReinforcement(0.02, 1.0, hold=0.05)
    u = np.array([0.0, 0.2, 0.16, 0.2, 0.1, 0.14])
    made = drive(more, 5.0, every=1.0, OP_c=(np.arange(6.0), u)).log["OP"]
    np.testing.assert_allclose(made - u, [0.0, 0.02, 0.02, 0.02, -0.02, -0.02], atol=1e-12)


def spread_and_travel(diagram, scans=4000):
    y, m = logged(diagram, scans)[scans // 2 :].T
    return float(np.std(y)), float(np.sum(np.abs(np.diff(m))))


def test_what_they_do_to_the_ideal_loop():
    # the stem that cycles swings PV; pulses swing it less and move the stem more; the others let it rest
    sd, travel = spread_and_travel(looped())
    knocked = spread_and_travel(looped(Knocker(0.03, 5.0, 2.0, 1.0)))
    moves = TwoMove(F_S + F_D, F_S - F_D, band=0.04, pause=40.0, dt=1.0, inputs={"SP": "SP", "PV": "PV"})
    rested = spread_and_travel(looped(moves))
    zone = spread_and_travel(looped(controller=GapPI(0.4, 10.0, dt=1.0, zone=0.04, **WIDE)))
    assert sd == pytest.approx(0.0237, abs=5e-4)  # snapshot
    assert knocked[0] < 0.5 * sd and knocked[1] > 2.0 * travel
    assert rested == (pytest.approx(0.0, abs=1e-6), 0.0)
    assert zone == (pytest.approx(0.0, abs=1e-6), 0.0)


def test_two_moves_put_the_stem_where_it_should_rest():
    # analytic: SP / K is where PV is SP; the mean of OP over a wave is right to a fifth of the jump
    moves = TwoMove(F_S + F_D, F_S - F_D, band=0.04, pause=40.0, dt=1.0)
    y, m = logged(looped(moves), 4000)[-1]
    assert m == pytest.approx(SP / K, abs=0.2 * (F_S - F_D))
    assert y == pytest.approx(K * m, abs=1e-9)


def test_two_moves_let_go_without_a_bump():
    t = np.arange(0.0, 300.0)
    sp = 0.2 * np.sin(t / 3.0) * (t < 42) + 0.5 * (t >= 200)  # it waves, rests, and leaves the band
    op = 0.05 * np.sin(t / 3.0) + 0.3 * (t >= 100)  # the controller winds up meanwhile
    made = drive(TwoMove(0.06, 0.02, band=0.1, pause=5.0, dt=1.0), 299.0, every=1.0, OP_c=(t, op), SP=(t, sp), PV=0.0)
    out = made.log["OP"]
    assert np.ptp(out[80:200]) == 0.0
    assert abs(out[200] - out[199]) < 0.01


def test_a_stem_without_stick_needs_none_of_it():
    calm = wire([Sine("OP_c", 0.1, 100.0), Knocker(0.0, 5.0, 2.0, 1.0), ChenValve(0.0, 0.0, 1.0, **WIDE)])
    log = simulate(calm, 100.0, every=1.0).log
    np.testing.assert_allclose(log["MV"], log["OP_c"], atol=1e-12)


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        (lambda: Knocker(-1.0, 5.0, 2.0, 1.0), "a = -1.0"),
        (lambda: Knocker(1.0, 5.0, 5.0, 1.0), "a pulse ends before the next"),
        (lambda: ConstantReinforcement(-0.1, 1.0), "a = -0.1"),
        (lambda: TwoMove(0.02, 0.06, 0.1, 5.0, 1.0), "J = 0.06"),
        (lambda: TwoMove(0.06, 0.02, 0.0, 5.0, 1.0), "band = 0.0"),
        (lambda: GapPI(1.0, 10.0, dt=1.0, zone=-1.0), "zone = -1.0"),
        (lambda: GapPI(1.0, 10.0, dt=1.0, anti_windup="conditional"), "back-calculation or none"),
    ],
)
def test_what_they_refuse(wrong, said):
    with pytest.raises(BlockError, match=said):
        wrong()

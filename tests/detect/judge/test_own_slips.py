"""Slips seen in a loop's own PV: found with their size, and called nowhere where the valve answers or only lags."""

import numpy as np
import pytest
from stickslip.calibration.defects import compressed
from stickslip.calibration.drawing import draw
from stickslip.calibration.simulation import simulate
from stickslip.detect.judge.answer import answer
from stickslip.detect.judge.own_slips import driving, own_slips
from stickslip.detect.prepare.prepared import Prepared
from stickslip.detect.stem.stick import stick
from stickslip.logs import LoopRecord

T = np.arange(3000.0)


def walk(seed: int) -> np.ndarray:
    """OP that turns at no even beat [% of span]: about 10 % of travel, 0.1 % a sample."""
    r = np.random.default_rng(seed)
    waves = zip((4, 2, 1), r.uniform(150, 500, 3), r.uniform(0, 6, 3), strict=True)
    return 50 + sum(size * np.sin(2 * np.pi * T / period + phase) for size, period, phase in waves)


def process(inflow: np.ndarray, tau: float) -> np.ndarray:
    """PV of one store, exact for an inflow held over a sample: tau dPV/dt = inflow - PV, or dPV/dt = inflow."""
    if not tau:
        return np.cumsum(inflow)
    a, y = np.exp(-1.0 / tau), np.zeros(len(inflow))
    for k in range(1, len(y)):
        y[k] = a * y[k - 1] + (1.0 - a) * inflow[k]
    return y


def loop(pv: np.ndarray, op: np.ndarray, tau: float, sp: np.ndarray | None = None) -> Prepared:
    kind = "self_regulating" if tau else "integrating"
    return Prepared(LoopRecord.from_arrays(T, pv=pv, op=op, sp=sp, op_span=(0.0, 100.0), process=kind))


@pytest.mark.parametrize("tau", [8.0, 60.0])
@pytest.mark.parametrize("seed", [0, 1, 3])
def test_S_is_read_off_the_bends_of_PV(tau, seed):
    """Analytic: PV is the exact answer of one store to the flow that the stem lets pass, beside a load that wanders."""
    u = walk(seed)
    noise = 0.016 / max(tau, 1.0) * np.random.default_rng(seed).normal(size=3000)  # a hundredth of the jump of the rate

    def seen(stem):
        return own_slips(loop(process(0.5 * np.sin(T / 200) - stem, tau) + noise, u, tau))

    found = seen(stick(u, 4.0, 1.6))
    assert found is not None and found.low <= 4.0 <= found.high and pytest.approx(4.0, rel=0.05) == found.S
    assert seen(stick(u, 4.0, 0.0)) is None  # a deadband
    assert seen(u) is None  # a valve that answers


@pytest.mark.parametrize("J, called", [(1.2, True), (0.0, False)])
def test_of_a_level_loop_a_stick_is_called_and_a_deadband_is_not(J, called):
    """PI on a tank under a load that wanders; the stem by the rules of the play with a slip jump, analytic."""
    r = np.random.default_rng(4)
    load = np.cumsum(r.normal(size=3000)) * 0.01
    level, u, stem, sum_, moving, way = np.zeros(3000), np.full(3000, 50.0), 50.0, 0.0, False, 0.0
    for k in range(1, 3000):
        level[k] = level[k - 1] + 0.02 * (load[k] - (stem - 50.0))
        sum_ += level[k] * 0.9 / 120.0
        u[k] = 50.0 + 0.9 * level[k] + sum_
        turned = (u[k] - u[k - 1]) * way < 0.0
        if moving and turned:
            moving = False
        if not moving and abs(u[k] - stem) > (4.0 + J) / 2.0:
            moving, way = True, float(np.sign(u[k] - stem))
        if moving:
            stem = u[k] - way * (4.0 - J) / 2.0
    found = own_slips(loop(level + 1e-4 * r.normal(size=3000), u, 0.0))
    assert (found is not None) == called
    assert found is None or found.low <= 4.0 <= found.high


def test_what_drives_a_store_comes_back():
    """Analytic: with a the rate constant, dPV/dt + a PV is the inflow times a, but for a constant."""
    inflow = np.where(T % 300 < 120, 1.0, -1.0)
    pv = process(inflow, 20.0)
    found = driving(0 * T, pv)
    assert np.corrcoef(found[1:], inflow[1:])[0, 1] > 0.9999


@pytest.mark.parametrize("tau", [0.0, 30.0])
@pytest.mark.parametrize("period", [200, 400])
@pytest.mark.parametrize("K_p", [0.3, 1.0])
def test_a_square_wave_that_a_sound_valve_answers_is_no_slip(tau, period, K_p):
    outside = 6.0 * np.where(T % period < period / 2, 1.0, -1.0)
    gain = 0.02 if not tau else 1.0 / tau
    pv, u, sum_ = np.zeros(3000), np.full(3000, 50.0), 0.0
    for k in range(1, 3000):
        fall = pv[k - 1] / tau if tau else 0.0
        pv[k] = pv[k - 1] + gain * (outside[k] - (u[k - 1] - 50.0)) - fall
        sum_ += pv[k] * K_p / (60.0 if not tau else 1.5 * tau)
        u[k] = 50.0 + K_p * pv[k] + sum_
    assert own_slips(loop(pv, u, tau)) is None


def straight(reversals: int) -> tuple[np.ndarray, np.ndarray]:
    """OP in straight lines between turns, and a level that a stem of S = 4 % fills and empties at two paces."""
    turns = 50 + 4.2 * np.where(np.arange(reversals + 2) % 2, 0.5, -0.5)
    u = np.interp(T, np.linspace(0.0, T[-1], len(turns)), turns)
    return u, np.cumsum(50.0 - stick(u, 4.0, 1.0))


def test_three_reversals_that_agree_are_enough_and_a_level_is_straight_between_them():
    """S = 4 % (analytic); between two slips the flow stands, so that PV lies on straight lines as a historian draws."""
    u, level = straight(3)
    slow = loop(level + 1e-3 * np.sin(T / 40), u, 0.0)
    assert any(fact.code == "compressed" for fact in loop(level, u, 0.0).present)
    for one in (slow, loop(level, u, 0.0)):
        found = own_slips(one)
        assert found is not None and found.reversals == 3 and pytest.approx(4.0, rel=0.02) == found.S
    u, level = straight(2)
    assert own_slips(loop(level, u, 0.0)) is None


def test_a_pv_that_a_historian_drew_is_refused():
    u, level = straight(9)
    drawn = compressed(T, level + 0.3 * np.random.default_rng(1).normal(size=len(T)), 0.02)
    assert own_slips(loop(level, u, 0.0)) is not None and own_slips(loop(drawn, u, 0.0)) is None


def test_moves_of_SP_that_a_sound_valve_answers_are_no_slips():
    """A first-order process, PI control, SP between two values: OP and the pace of PV step together."""
    sp = np.where(T % 500.0 < 250.0, 40.0, 60.0)
    pv, u, sum_ = np.zeros(3000), np.full(3000, 50.0), 0.0
    for k in range(1, 3000):
        pv[k] = pv[k - 1] + 0.1 * (2.0 * (u[k - 1] - 30.0) - pv[k - 1])
        sum_ += 0.02 * (sp[k] - pv[k])
        u[k] = 50.0 + 0.2 * (sp[k] - pv[k]) + sum_
    assert own_slips(loop(pv, u, 20.0, sp)) is None


def test_simulated_loops_of_other_causes_are_not_called():
    """400 loops of the training law, seed 61010 used for nothing else: a wrong call in 200 is the limit."""
    made = simulate(draw(400, 61010, "training"), 1)
    called = [(truth.cause, own_slips(Prepared(record).with_stale)) for record, truth in made]
    others = [found is not None for cause, found in called if cause != "stiction"]
    assert len(others) > 150 and sum(others) <= 1
    assert any(found is not None for cause, found in called if cause == "stiction")


@pytest.mark.parametrize("valves, tags", [(("VLCS1",), {"LCS11"}), (("VPCS1",), {"PCS11"}), ((), set())])
def test_of_the_plant_those_loops_are_called_whose_valves_stick(valves, tags):
    """Under slugs, from PV, OP and SP alone: S = (F_s + F_c) / k of the stem is 6.67 % (analytic)."""
    from benchmarks.thesis_cases import logs_of, without_stems

    log = without_stems(next(logs_of("slugs", "high", 1, valves)))
    found = {tag: own_slips(Prepared(log.loop(name=tag))) for tag in log.loops}
    assert {tag for tag, slips in found.items() if slips is not None} == tags
    for tag in tags:
        assert pytest.approx(6.67, rel=0.08) == found[tag].S
        said = answer(Prepared(log.loop(name=tag)))
        assert said.word == "stiction" and said.probability is None and "stands and slips" in said.reason

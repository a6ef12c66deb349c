"""Data health by name: each fault is found with its number where it is, and nowhere else."""

import numpy as np
import pytest
from stickslip.detect import METHODS, diagnose
from stickslip.detect.health.causality import causality, lag_of_pv
from stickslip.detect.health.conditions import examine, set_point
from stickslip.detect.health.in_charge import asleep, copied, untracked
from stickslip.detect.health.response import frozen, unresponsive
from stickslip.detect.health.stale import held, stale, without_stale
from stickslip.detect.prepare.prepared import prepared
from stickslip.logs import LoopRecord

NEW = {"stale_data", "frozen_pv", "pv_unresponsive", "not_in_charge"}


def again(record, **changed):
    parts = {"pv": record.pv, "op": record.op, "sp": record.sp, "mode": record.mode, **changed}
    return LoopRecord.from_arrays(record.t, process=record.process, name=record.name, **parts)


def collected(record, share, seed=0):
    """The record as a historian holds it: at a share of the samples, in stretches of one to four, nothing new."""
    rng = np.random.default_rng(seed)
    at = np.arange(len(record))
    k = 1
    while k < len(at):
        if rng.random() < share / 2.5:
            stop = min(k + int(rng.integers(1, 5)), len(at))
            at[k:stop] = at[k - 1]
            k = stop
        k += 1
    return again(record, pv=record.pv[at], op=record.op[at]), at != np.arange(len(at))


@pytest.mark.parametrize("share", [0.1, 0.3])
def test_stale_samples_are_counted_and_masked(share, sticky):
    record, lost = collected(sticky(noise=0.1), share)
    fact = stale(record)
    assert fact.present and not fact.forbids
    assert fact.value == pytest.approx(lost.mean())  # analytic: the holds that were made
    assert (held(record) == lost).all()
    assert (without_stale(record).good == ~lost).all()
    assert "bit for bit" in fact.text and fact.remedy


def test_stale_collection_is_no_sticky_valve(forced):
    """Held samples look like a stem at rest; masked they change no word."""
    record = forced(noise=0.1)
    held_back, _ = collected(record, 0.4)
    for method in METHODS:
        if method.detect(record).verdict != "stiction":
            assert method.detect(held_back).verdict != "stiction", method.CARD.name


@pytest.mark.parametrize("kind", ["raw", "coarse", "at rest", "coarse both"])
def test_what_is_not_stale(kind, sticky):
    record = sticky(noise=0.1)
    if kind == "coarse":
        record = again(record, pv=np.round(record.pv, 1))
    if kind == "coarse both":
        record = again(record, pv=np.round(record.pv, 1), op=np.round(record.op, 1))
    if kind == "at rest":
        pv, op = record.pv.copy(), record.op.copy()
        pv[:800], op[:800] = pv[0], op[0]
        record = again(record, pv=pv, op=op)
    assert not stale(record).present
    assert without_stale(record) is record


def test_mostly_stale_is_refused(sticky):
    record = sticky(noise=0.1)
    at = np.arange(len(record)) // 8 * 8
    fact = stale(again(record, pv=record.pv[at], op=record.op[at]))
    assert fact.value == pytest.approx(7 / 8, abs=0.01) and fact.forbids  # analytic


def test_stale_samples_are_not_counted_as_missing_too(sticky):
    record = sticky(noise=0.1)
    at = np.arange(len(record)) // 3 * 3
    loop = prepared(again(record, pv=record.pv[at], op=record.op[at]))
    assert [fact.code for fact in loop.present] == ["stale_data"] and not loop.present[0].forbids


def test_a_loop_at_rest_is_no_dead_transmitter():
    """Of a simulated loop that has settled PV is exactly SP, and OP goes on by rounding."""
    t = np.arange(2000.0)
    pv = np.where(t < 600.0, 55.0 + 0.01 * (600.0 - t), 55.0)
    assert not frozen(LoopRecord.from_arrays(t, pv=pv, op=56.5 + 1e-14 * t, sp=0.0 * t + 55.0)).present
    assert frozen(LoopRecord.from_arrays(t, pv=pv, op=56.5 + 1e-4 * t, sp=0.0 * t + 55.0)).present


def test_frozen_transmitter(sticky):
    record = sticky(noise=0.1)
    pv = record.pv.copy()
    pv[600:1300] = pv[600]
    fact = frozen(again(record, pv=pv))
    assert fact.present and fact.value == pytest.approx(700 / len(pv), rel=0.01)  # analytic
    assert not frozen(record).present
    assert not frozen(again(record, pv=np.round(record.pv))).present
    assert prepared(again(record, pv=pv)).present[0].code == "frozen_pv"


def test_pv_that_does_not_answer():
    """No flow: PV is noise at zero, and the controller winds OP up to hold 30."""
    rng = np.random.default_rng(0)
    t = np.arange(3000.0)
    pv = 0.1 * rng.normal(size=3000)
    op = np.minimum(20 + 0.02 * np.cumsum(30 - pv) * 0.05, 88.0) + 0.01 * rng.normal(size=3000)
    fact = unresponsive(LoopRecord.from_arrays(t, pv=pv, op=op, sp=np.full(3000, 30.0)))
    assert fact.present and "does not respond" in fact.text
    # A loop that works: a load ramp makes OP travel while PV rests at SP.
    ramp = LoopRecord.from_arrays(t, pv=30 + pv, op=20 + 0.02 * t - 0.5 * pv, sp=np.full(3000, 30.0))
    assert not unresponsive(ramp).present


def test_working_loops_answer(sticky, forced):
    for record in (sticky(noise=0.1), sticky("integrating", noise=0.1), forced(), sticky(S=0.0, J=0.0, noise=0.3)):
        assert not {fact.code for fact in examine(record) if fact.present} & NEW


def test_output_that_copies_the_measurement(sticky):
    record = sticky(noise=0.1)
    fact = copied(again(record, op=120 - 1.5 * record.pv))  # a P controller does that, too
    assert fact.present and not fact.forbids and fact.value == pytest.approx(1.0)  # analytic
    assert not copied(record).present
    assert copied(again(record, op=record.pv)).forbids
    assert diagnose(again(record, op=record.pv)).verdict == "not_applicable"


def test_manual_that_no_mode_tells(sticky):
    record = sticky(noise=0.1)
    op = record.op.copy()
    op[: len(op) * 3 // 4] = 42.0
    pv = record.pv.copy()
    pv[: len(op) * 3 // 4] += 20.0
    fact = asleep(again(record, pv=pv, op=op))
    assert fact.present and fact.value == pytest.approx(0.75, abs=0.01)  # analytic
    assert not asleep(record).present
    assert not asleep(again(record, op=np.round(record.op))).present


def test_set_point_that_is_not_tracked(sticky):
    record = sticky(noise=0.1)
    off = untracked(again(record, sp=record.sp + 60.0))
    assert off.present and not off.forbids and "not tracked" in off.text
    assert not untracked(record).present


def test_slave_of_a_cascade(sticky):
    record = sticky(noise=0.1)
    moving = record.sp + np.cumsum(np.random.default_rng(0).normal(size=len(record)))
    fact = set_point(again(record, sp=moving))
    assert fact.present and "slave of a cascade" in fact.text and "master" in fact.remedy


@pytest.mark.parametrize("shift", [-9.0, 0.0, 4.5, 12.0])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_lag_of_pv(shift, sign):
    t = np.arange(3000.0)
    lag, r = lag_of_pv(np.sin(t / 20), sign * np.sin((t - shift) / 20), sign, 62.8)
    assert lag == pytest.approx(shift, abs=0.15) and r == pytest.approx(1.0, abs=0.02)  # analytic


def test_causality(sticky):
    record = sticky(noise=0.02)
    assert not prepared(record).causality.present
    n = np.arange(2000)
    e = np.sin(n / 15) + 0.02 * np.random.default_rng(0).normal(size=2000)
    proportional = causality(50 + 4.0 * e, 30 - e, e, 94.0)  # strong P: OP is PV turned over, at once
    # analytic: turned over, a sine agrees with itself half a period away
    assert abs(abs(proportional.value) - 47) < 2 or proportional.present


def test_facts_say_what_to_log_instead(sticky):
    record, _ = collected(sticky(noise=0.1), 0.3)
    for fact in prepared(record).health:
        assert fact.text.endswith(".") or fact.text.endswith("no stretch"), fact
        assert not fact.present or fact.remedy.endswith("."), fact


def test_healthy_records_have_no_fault():
    codes = []
    for seed in range(20):
        rng = np.random.default_rng(seed)
        pv, integral, rows = 50.0, 50.0, []
        for _ in range(1000):
            seen = pv + 0.1 * rng.normal()
            integral += 0.05 * (50.0 - seen)
            u = integral + 0.4 * (50.0 - seen)
            pv += 0.1 * (u - pv) + 0.05 * rng.normal()
            rows.append((seen, u))
        y, u = np.array(rows).T
        record = LoopRecord.from_arrays(np.arange(1000.0), pv=y, op=u, sp=np.full(1000, 50.0))
        codes += [fact.code for fact in examine(record) if fact.present]
    assert codes == []


def test_op_at_its_limit_is_saturated_and_not_asleep():
    t = np.arange(2000.0)
    op = np.clip(95 + 20 * np.sin(t / 100), 0, 100)
    record = LoopRecord.from_arrays(t, pv=40 + np.sin(t / 7), op=op, sp=np.full(2000, 30.0))
    assert asleep(record).value == 0.0
    assert [fact.code for fact in examine(record) if fact.present and fact.forbids] == ["op_saturated"]
    elsewhere = asleep(LoopRecord.from_arrays(t, pv=record.pv, op=op - 5, sp=record.sp))
    assert elsewhere.value == pytest.approx(np.mean(op == 100.0), abs=0.01)  # analytic: the same stands
    assert elsewhere.value > 0.4

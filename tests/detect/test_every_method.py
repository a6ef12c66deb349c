"""What the cards promise, asked of every method and every gate: units and signs do not matter, bad data are refused."""

from functools import lru_cache

import numpy as np
import pytest
from stickslip.detect import GATES, METHODS
from stickslip.logs import LoopRecord

from .conftest import _outside_square, _sticky
from .test_contract import SEEN_IN

CASES = [(method, process) for method in METHODS for process in method.CARD.process]
by_case = pytest.mark.parametrize(
    ("method", "process"), CASES, ids=[f"{method.CARD.name}-{process}" for method, process in CASES]
)
by_gate = pytest.mark.parametrize("gate", GATES, ids=lambda gate: gate.CARD.name)


@lru_cache(maxsize=64)
def base(name, process):
    return _sticky(process, **{"noise": 0.1, **SEEN_IN.get((name, process), SEEN_IN.get(name, {}))})


def changed(r, gain=1.0, offset=0.0, op_gain=1.0, every=1):
    """PV and SP in another unit, OP and MV mirrored or scaled about 50 with its span, every n-th sample."""
    pick = slice(None, None, every)
    op, mv = (50 + op_gain * (x[pick] - 50) for x in (r.op, r.mv))
    span = (50 - 50 * abs(op_gain), 50 + 50 * abs(op_gain))
    return LoopRecord.from_arrays(
        r.t[pick], pv=gain * r.pv[pick] + offset, sp=gain * r.sp[pick] + offset, process=r.process, op=op, mv=mv,
        op_span=span, name=r.name,
    )  # fmt: skip


UPWARDS = {"qualitative_shapes"}  # cuts cycles at upward crossings, other ones where PV is mirrored


@by_case
@pytest.mark.parametrize(
    "change",
    [{"gain": 25.0, "offset": -400.0}, {"op_gain": 0.16}, {"gain": -1.0}, {"op_gain": -1.0}],
    ids=["unit of PV", "unit of OP", "sign of the process gain", "action of the controller"],
)
def test_units_signs_and_action_do_not_matter(method, process, change):
    record = base(method.CARD.name, process)
    first, then = method.detect(record), method.detect(changed(record, **change))
    assert then.verdict == first.verdict, (first.reason, then.reason)
    near = 0.2 if method.CARD.name in UPWARDS else 0.02
    assert then.index == pytest.approx(first.index, rel=near, abs=near)
    if first.amount_percent_op is not None:
        assert then.amount_percent_op == pytest.approx(first.amount_percent_op, rel=0.02)


# Where half the samples leave fewer than the method asks for, or it says itself that it hangs on the sampling.
COARSE = {"segmentation", "bicoherence", "window_tests", "surrogates", "hagglund2011", "change_no_change"}


@by_case
def test_half_the_samples_turn_no_word_round(method, process):
    record = base(method.CARD.name, process)
    first, half = method.detect(record), method.detect(changed(record, every=2))
    assert {first.verdict, half.verdict} != {"stiction", "no_stiction"}
    if method.CARD.name not in COARSE and half.verdict != "not_applicable":
        assert half.verdict == first.verdict, (first.reason, half.reason)
        if first.amount_percent_op is not None:
            assert half.amount_percent_op == pytest.approx(first.amount_percent_op, rel=0.25)


def spoiled(kind, process):
    """A record on which no method may accuse the valve."""
    rng, t = np.random.default_rng(4), np.arange(3000.0)
    wave = np.sin(t / 9)
    if kind == "uncorrelated":  # two oscillations that have nothing in common
        parts = {"pv": 30 + np.sin(t / 13.7) + 0.1 * rng.normal(size=3000), "op": 50 + 2 * np.cumsum(wave) / 9}
    elif kind == "drift":
        parts = {"pv": 30 + 0.1 * rng.normal(size=3000), "op": 30 + 0.01 * t + 0.05 * rng.normal(size=3000)}
    elif kind == "saturated":
        parts = {"pv": 30 + wave + 0.05 * rng.normal(size=3000), "op": np.clip(95 + 20 * np.cos(t / 9), 0, 100)}
    elif kind == "stale":
        at = np.arange(3000) // 6 * 6
        parts = {"pv": (30 + wave + 0.05 * rng.normal(size=3000))[at], "op": (50 + 2 * np.cos(t / 9))[at]}
    elif kind == "frozen":
        pv = 30 + wave + 0.05 * rng.normal(size=3000)
        pv[800:1900] = pv[800]
        parts = {"pv": pv, "op": 50 + 2 * np.cos(t / 9)}
    else:
        outside = _outside_square(3, n=3000)
        return LoopRecord.from_arrays(outside.t, pv=outside.pv, op=outside.op, sp=outside.sp, process=process)
    return LoopRecord.from_arrays(t, sp=np.full(3000, 30.0), process=process, **parts)


REFUSED = {"saturated": {"op_saturated"}, "stale": {"stale_data"}, "frozen": {"frozen_pv"}}


@by_case
@pytest.mark.parametrize("kind", ["uncorrelated", "drift", "saturated", "stale", "frozen"])
def test_no_valve_is_accused_or_cleared_on_bad_data(method, process, kind):
    v = method.detect(spoiled(kind, process))
    assert v.verdict in ("inconclusive", "not_applicable"), v.reason
    if kind in ("stale", "frozen"):
        assert v.code in {*REFUSED[kind], "signal_missing"}, v.reason  # or MV, which the method needs
    if kind == "saturated" and "unsaturated" in method.CARD.needs and "mv" not in method.CARD.needs:
        assert v.code == "op_saturated", v.reason


@by_gate
@pytest.mark.parametrize("scale", [25.0, -1.0, 1e-3])
def test_gates_do_not_mind_the_unit(gate, scale):
    record = base("relay_fit", "self_regulating")
    first, then = gate.find(record), gate.find(changed(record, gain=scale, offset=-7.0))
    assert then.oscillating == first.oscillating and first.oscillating
    assert then.period == pytest.approx(first.period, rel=1e-3)
    assert then.amplitude == pytest.approx(abs(scale) * first.amplitude, rel=0.02)


@by_gate
def test_gates_do_not_mind_the_sampling(gate):
    record = base("relay_fit", "self_regulating")
    assert gate.find(changed(record, every=2)).period == pytest.approx(gate.find(record).period, rel=0.03)


@by_gate
def test_period_found_in_noise_is_none(gate, noise):
    """Of 50 noises of five colours at most one may pass, 2 %."""
    fired = 0
    for kind in ("white", 0.8, 0.95, "walk", "loop"):
        for seed in range(10):
            x = noise(kind, 1200, 500 + seed)
            fired += gate.find(LoopRecord.from_arrays(np.arange(1200.0), pv=x, op=x, sp=0 * x)).oscillating
    assert fired <= 1

import numpy as np
import pytest
from stickslip.detect.health import conditions
from stickslip.logs import LoopRecord


def record(pv, op=None, **more):
    t = np.arange(float(len(pv)))
    return LoopRecord.from_arrays(t, pv=pv, op=50 + np.sin(t) if op is None else op, **more)


@pytest.mark.parametrize("share", [0.0, 0.08, 0.12, 0.6])
def test_saturation_is_the_share_at_the_ends(share):
    op = np.linspace(20, 80, 1000)
    op[: int(500 * share)] = 0.2
    op[1000 - int(500 * share) :] = 99.8
    fact = conditions.saturated(record(np.sin(np.arange(1000) / 9), op))
    assert fact.value == pytest.approx(share)  # analytic
    assert fact.present == (share > 0.10)


def test_saturation_respects_the_span():
    op = np.full(500, 4.0)
    op[::5] = 12.0
    fact = conditions.saturated(record(np.sin(np.arange(500.0)), op, op_span=(4, 20)))
    assert fact.value == pytest.approx(0.8)  # analytic


def test_unknown_span_looks_for_clipping():
    clipped = np.minimum(np.sin(np.arange(1000) / 10), 0.3)
    assert conditions.saturated(record(clipped, clipped, op_span=None)).present
    free = np.sin(np.arange(1000) / 10)
    assert not conditions.saturated(record(free, free, op_span=None)).present


@pytest.mark.parametrize("step, present", [(0.5, True), (0.05, False)])
def test_quantisation_counts_levels(step, present):
    x = np.sin(np.arange(2000) / 20) + np.random.default_rng(0).normal(0, 0.1, 2000)
    gridded = step * np.round(x / step)
    fact = conditions.quantised(record(gridded))
    assert fact.value == pytest.approx(np.ptp(gridded) / step, abs=0.5)  # analytic
    assert fact.present is present


def test_continuous_values_are_on_no_grid():
    assert not conditions.quantised(record(np.random.default_rng(0).normal(size=500))).present


@pytest.mark.parametrize("keep, present", [(1, False), (10, True)])
def test_linear_compression(keep, present):
    t = np.arange(1001.0)
    x = np.sin(t / 15) + np.random.default_rng(0).normal(0, 0.1, 1001)
    fact = conditions.compressed(record(np.interp(t, t[::keep], x[::keep])))
    assert fact.present is present
    assert fact.value == pytest.approx(1 - 1 / keep, abs=0.01)  # analytic


@pytest.mark.parametrize("signal, code", [("PV", "constant_signal"), ("OP", "manual_mode")])
def test_frozen_signals(signal, code):
    moving, still = np.sin(np.arange(100.0)), np.full(100, 7.0)
    r = record(still, moving + 50) if signal == "PV" else record(moving, still)
    fact = conditions.constant(r, signal)
    assert fact.present
    assert fact.code == code
    assert "7" in fact.text


def test_manual_share():
    mode = np.ones(100)
    mode[:60] = 0
    fact = conditions.manual(record(np.sin(np.arange(100.0)), mode=mode))
    assert fact.value == pytest.approx(0.6)
    assert fact.present


def test_missing_share():
    x = np.sin(np.arange(100.0))
    x[:70] = np.nan
    assert conditions.missing(record(x)).value == pytest.approx(0.7)


def test_moving_set_point():
    x = np.sin(np.arange(500) / 8)
    assert conditions.set_point(record(x, sp=0.5 * np.sin(np.arange(500) / 20))).present
    assert not conditions.set_point(record(x, sp=np.where(np.arange(500) < 250, 0.0, 3.0))).present
    assert not conditions.set_point(record(x)).present


def test_every_fact_says_a_number_or_what_is_not_known():
    for fact in conditions.examine(record(np.sin(np.arange(300.0)), sp=np.zeros(300))):
        assert fact.text.endswith(".")
        assert any(c.isdigit() for c in fact.text) or "not" in fact.text


def test_all_bad_samples_raise_nothing():
    nothing = record(np.full(50, np.nan))
    assert any(fact.present and fact.code == "signal_missing" for fact in conditions.examine(nothing))

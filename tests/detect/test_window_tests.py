"""Window tests: levels of significance where nothing changes, closed forms, valves, and what looks alike."""

import numpy as np
import pytest
from stickslip.detect.methods.window_tests import Params, detect, flags, reverse_arrangements
from stickslip.logs import LoopRecord


def test_reverse_arrangements():  # analytic: mean w (w - 1) / 4 and variance (2 w^3 + 3 w^2 - 5 w) / 72 of noise
    w = 8
    A = reverse_arrangements(np.random.default_rng(0).normal(size=(40_000, w)))
    assert np.mean(A) == pytest.approx(w * (w - 1) / 4, rel=0.01)
    assert np.var(A) == pytest.approx((2 * w**3 + 3 * w**2 - 5 * w) / 72, rel=0.03)
    assert reverse_arrangements(np.arange(8.0)[None])[0] == 0.0
    assert reverse_arrangements(-np.arange(8.0)[None])[0] == 28.0


@pytest.mark.parametrize("alpha", [0.01, 0.05, 0.2])
def test_level_of_significance(alpha):
    # analytic: noise passes each test with probability alpha, so PV stays and OP does not in alpha (1 - alpha)
    rng = np.random.default_rng(1)
    found = flags(rng.normal(size=160_000), rng.normal(size=160_000), 8, alpha)
    expected = alpha * (1 - alpha)
    for share in (found.means, found.unequal, found.variances, found.opposite):
        assert np.mean(share) == pytest.approx(expected, abs=0.15 * expected + 0.002)
    assert np.mean(found.trends) == pytest.approx(expected, rel=0.6)  # A is discrete and only nearly normal


def test_ramp_against_noise():  # analytic: OP always changes and has a trend, PV in alpha of the windows
    rng = np.random.default_rng(2)
    found = flags(5 * np.arange(40_000.0), rng.normal(size=40_000), 8)
    assert np.mean(found.means) == pytest.approx(0.95, abs=0.01)
    assert np.mean(found.trends) == pytest.approx(0.95, abs=0.02)


@pytest.mark.parametrize("valve", ["kano", "choudhury", "he"])
def test_valves(valve, simulated):
    v = detect(simulated(valve, S=6.0, J=4.0))
    assert v.verdict == "stiction", v.reason
    assert 3.0 < v.amount_percent_op < 7.0


def test_flow_loop_without_mv(sticky, bare):
    v = detect(bare(sticky(S=6.0, J=4.0, noise=0.05, tau=1.0, T_i=8.0, K_p=0.3)))
    assert v.verdict == "stiction" and v.evidence["mv"] == 0.0, v.reason


def test_noise_passes_the_published_limit_but_not_ours():
    rng = np.random.default_rng(0)
    t = np.arange(3000.0)
    record = LoopRecord.from_arrays(t, pv=rng.normal(size=3000), op=50 + rng.normal(size=3000), sp=0 * t)
    v = detect(record)
    assert v.index > 0.0  # "Omega > 0" would call it
    assert v.verdict == "inconclusive"
    assert detect(record, Params(omega=0.0, excess=0.5, beyond=0.0)).verdict == "stiction"


def test_load_ramp_proves_nothing():
    t, rng = np.arange(2000.0), np.random.default_rng(0)
    pv, op = 30 + 0.1 * rng.normal(size=2000), 40 + 0.01 * t + 0.01 * rng.normal(size=2000)
    v = detect(LoopRecord.from_arrays(t, pv=pv, op=op, sp=0 * t + 30))
    assert v.index > 0.5 and v.verdict == "inconclusive" and "load ramp" in v.reason


def test_unit_sign_action_and_sampling_do_not_matter(sticky, bare):
    base = sticky(S=6.0, J=4.0, noise=0.05, tau=1.0, T_i=8.0, K_p=0.3)
    first = detect(bare(base))
    for change in ({"gain": -3.0, "offset": 40.0}, {"op_gain": -1.0}, {"op_gain": 0.16}):
        v = detect(bare(base, **change))
        assert v.index == pytest.approx(first.index, abs=1e-9)
        assert v.amount_percent_op == pytest.approx(first.amount_percent_op, rel=1e-6)
    assert detect(bare(base, every=2)).verdict == first.verdict


def test_refusals_and_picture(sticky):
    assert detect(sticky("integrating", noise=0.1)).code == "wrong_process_type"
    assert detect(sticky(n=150, noise=0.1)).code == "too_few_cycles"
    figure = detect(sticky(noise=0.1)).plot()
    figure.canvas.draw()
    assert len(figure.axes) == 2

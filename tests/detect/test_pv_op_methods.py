"""The two ideas of the thesis for integrating loops: closed forms of the roundness, sizes in simulation, refusals."""

import numpy as np
import pytest
from scipy.signal import lfilter
from stickslip.detect.methods import high_passed_pv, shifted_pv
from stickslip.detect.methods.high_passed_pv import high_passed
from stickslip.detect.prepare.prepared import Prepared
from stickslip.detect.prepare.pv_op_loops import loops, roundness, tilt
from stickslip.logs import LoopRecord

both = pytest.mark.parametrize("method", [high_passed_pv, shifted_pv], ids=lambda m: m.CARD.name)


def triangle(u):
    return 1 - 4 * np.abs((u + 0.25) % 1.0 - 0.5)


def test_roundness_in_closed_form():
    u = (np.arange(4000) + 0.5) / 4000
    sine = lambda phase: np.sin(2 * np.pi * u + phase)  # noqa: E731
    for phase in (0.05, 0.8, 2.5):  # analytic: every ellipse, sheared and stretched as it may be
        assert roundness(3 * sine(0)[None], (0.2 * sine(phase) + 7 * sine(0))[None])[0] == pytest.approx(1.0, abs=1e-3)
    # analytic: area 2 over 2 pi / 3 for the lozenge; area 4 over 2 pi sqrt(1/3) for the rectangle
    assert roundness(triangle(u)[None], triangle(u + 0.25)[None])[0] == pytest.approx(3 / np.pi, abs=1e-3)
    square = np.where((u + 0.25) % 1.0 < 0.5, 1.0, -1.0)
    assert roundness(triangle(u)[None], square[None])[0] == pytest.approx(2 * np.sqrt(3) / np.pi, abs=1e-3)
    assert roundness(sine(0)[None], sine(0)[None])[0] == 0.0  # a line has no area


def test_high_pass_is_that_of_the_thesis():
    """Against the recursion of equation 7.3, sample by sample; the lead of a sine is atan(1 / (w tau))."""
    x, tau, dt = np.random.default_rng(0).normal(size=50).cumsum(), 4.0, 0.5
    a, y = tau / (tau + dt), [0.0]
    for k in range(1, 50):
        y.append(a * y[-1] + a * (x[k] - x[k - 1]))
    assert high_passed(x, tau, dt) == pytest.approx(np.array(y))
    t, w = np.arange(0.0, 2000.0, 0.1), 2 * np.pi / 100
    lead = np.angle(np.sum(high_passed(np.sin(w * t), 100 / 30, 0.1)[5000:] * np.exp(-1j * w * t[5000:]))) + np.pi / 2
    assert lead == pytest.approx(np.arctan(30 / (2 * np.pi)), abs=0.01)  # analytic: 78 degrees


def test_the_size_is_that_of_the_valve():
    """Analytic: OP a triangle of half range 4 that slips 1 % after each reversal at the tips: R = 8, W = 8."""
    t = np.arange(3000.0)
    op, pv = 50 + 4 * triangle(t / 100), -triangle(t / 100)
    loop = Prepared(LoopRecord.from_arrays(t, pv=pv, op=op, sp=0 * t, process="integrating"))
    found = loops(loop, high_passed(loop.wave("PV", 0.0), 1.0, 1.0))
    assert np.mean(found.range) == pytest.approx(8.0, rel=0.08)  # smoothing rounds the tips
    assert np.mean(found.size) == pytest.approx(8.0, rel=0.08)


@both
@pytest.mark.parametrize(("S", "J"), [(3.0, 2.0), (6.0, 4.0), (10.0, 5.0)])
def test_size_in_simulation(method, sticky, S, J):
    v = method.detect(sticky("integrating", S=S, J=J, noise=0.05, load=50.85, n=5000))
    assert v.verdict == "stiction", v.reason
    assert v.amount_percent_op == pytest.approx(S, rel=0.25)
    assert v.evidence["S_low"] <= v.amount_percent_op <= v.evidence["S_high"]


def sines(phase, noise=0.1, period=60.0, n=3000, gain=1.0, offset=30.0, op_gain=1.0, dt=1.0, tri=False,
          process="integrating"):  # fmt: skip
    t = dt * np.arange(n / dt)
    rng = np.random.default_rng(1)
    wave = triangle if tri else lambda u: np.sin(2 * np.pi * u)
    pv = wave(t / period) + noise * rng.normal(size=len(t))
    op = -wave(t / period + phase) + noise * rng.normal(size=len(t))
    return LoopRecord.from_arrays(t, pv=gain * pv + offset, op=50 + op_gain * op, sp=0 * t + offset, process=process)


@both
@pytest.mark.parametrize("phase", [0.0, 0.1, 0.3])
@pytest.mark.parametrize("noise", [0.02, 0.3])
def test_sines_at_any_phase_are_not_accused(method, phase, noise):
    v = method.detect(sines(phase, noise))
    assert v.verdict == "inconclusive"
    assert v.amount_percent_op is None


@both
@pytest.mark.parametrize("period", [80, 150])
def test_an_outside_flow_that_steps_is_not_accused(method, period):
    """A level with a sound valve under PI control and a square inflow: while OP travels the flow follows it."""
    rng, n = np.random.default_rng(0), 4000
    level, integral, rows = 50.0, 50.0, np.empty((n, 2))
    for k in range(n):
        seen = level + 0.02 * rng.normal()
        integral += 2.0 * (50.0 - seen) / 100.0
        op = integral + 2.0 * (50.0 - seen)
        level += (op - 50.0 + 3.0 * np.sign(np.sin(2 * np.pi * (k + 0.5) / period))) / 50.0
        rows[k] = seen, op
    t = np.arange(float(n))
    v = method.detect(LoopRecord.from_arrays(t, pv=rows[:, 0], op=rows[:, 1], sp=0 * t + 50, process="integrating"))
    assert v.verdict == "inconclusive" and "flow follows OP" in v.reason


@both
def test_a_resonance_driven_by_noise_is_not_accused(method):
    """No valve at all: the swings of OP differ, where the stick would set them."""
    for seed in range(12):
        rng = np.random.default_rng([9, seed])
        pole = np.exp((-0.05 + 1j * np.sqrt(1 - 0.05**2)) * 2 * np.pi / 60)
        e = lfilter([1], [1, -2 * pole.real, abs(pole) ** 2], rng.normal(size=5000))[2000:]
        e /= e.std()
        op = 50 + 0.5 * e + 0.05 * np.cumsum(e - e.mean())
        loop = LoopRecord.from_arrays(np.arange(3000.0), pv=30 - e, op=op, sp=0 * e + 30, process="integrating")
        assert method.detect(loop).verdict != "stiction"


def test_tilt_by_hand():
    """Analytic: pv = 3 sign + 0.6 op with op from 0 to 1: 0.6 / 6."""
    turn = np.arange(64) / 64
    op, jump = np.abs(2 * turn - 1)[None], np.sign(turn - 0.499)[None]
    assert tilt(op, 3 * jump + 0.6 * op) == pytest.approx(0.1, abs=1e-6)
    assert tilt(op, 3 * jump) == pytest.approx(0.0, abs=1e-9)


@both
def test_signals_of_two_periods_give_no_number(method):
    t = np.arange(4000.0)
    rng = np.random.default_rng(5)
    pv = triangle(t / 60) + 0.05 * rng.normal(size=4000)
    loop = LoopRecord.from_arrays(t, pv=pv, op=50 + triangle(t / 41.3), sp=0 * t, process="integrating")
    v = method.detect(loop)
    assert v.index is None and v.verdict in ("inconclusive", "not_applicable")


@both
def test_unit_offset_sign_action_and_sampling_do_not_matter(method):
    base = method.detect(sines(-0.02, 0.02, period=100.0, tri=True))
    assert base.verdict == "stiction"
    for gain, offset, op_gain in ((-3.0, 40.0, 1.0), (0.1, 0.0, 4.0), (1e3, -7.0, 0.02)):
        other = method.detect(sines(-0.02, 0.02, 100.0, gain=gain, offset=offset, op_gain=op_gain, tri=True))
        assert other.index == pytest.approx(base.index, abs=1e-4)
        assert other.amount_percent_op == pytest.approx(op_gain * base.amount_percent_op, rel=1e-4)
    turned = method.detect(sines(-0.02, 0.02, 100.0, op_gain=-1.0, tri=True))  # the cycles start elsewhere
    assert turned.index == pytest.approx(base.index, abs=0.01)
    finer = method.detect(sines(-0.02, 0.02, 100.0, dt=0.5, tri=True))
    assert finer.index == pytest.approx(base.index, abs=0.01)


@both
def test_refusals(method):
    assert method.detect(sines(0.0, process="self_regulating")).code == "wrong_process_type"
    assert method.detect(sines(0.0, process="unknown")).code == "integrating_unknown"
    assert method.detect(sines(0.0, period=12.0)).code == "undersampled"


def test_the_rule_has_bounds():
    with pytest.raises(ValueError, match="tau = 0"):
        high_passed_pv.Params(tau=0.0)


@both
def test_picture(method):
    figure = method.detect(sines(-0.02, 0.02, period=100.0, tri=True)).plot()
    figure.canvas.draw()
    assert figure.axes[0].get_legend_handles_labels()[1] == ["ellipse of two sines", "mean cycle"]

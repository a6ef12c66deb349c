"""The sticky valve before a linear process: sizes, regions, refusals, invariances."""

from typing import get_args

import numpy as np
import pytest
from stickslip.detect.methods import hammerstein
from stickslip.detect.methods.hammerstein import Params, detect, search
from stickslip.detect.stem.linear_models import Linear
from stickslip.detect.stem.valve_models import kano
from stickslip.logs import LoopRecord

LAG = 1 - np.exp(-1 / 8)


def open_loop(S, J, n=900, noise=0.0):
    """A triangle of 60 samples and swing 10 through Kano's valve and a lag of 8 samples: S, J and swing are free."""
    u = 5 * np.abs((np.arange(n) / 15 + 0.5) % 4 - 2) + 45
    x = kano(u, np.array([float(S)]), np.array([float(J)]))[0]
    y = np.zeros(n)
    for k in range(1, n):
        y[k] = y[k - 1] + LAG * (x[k - 1] - y[k - 1]) if k > 1 else x[0]
    return u, y + noise * np.random.default_rng(0).normal(size=n)


@pytest.mark.parametrize(("S", "J"), [(5.0, 3.0), (3.0, 1.5), (7.0, 7.0), (4.0, 0.0), (2.0, 2.0)])
@pytest.mark.parametrize("noise", [0.0, 0.2])
def test_open_loop_sizes_come_out(S, J, noise):
    """Analytic: S and J of the valve that made the record; J is told from the gain because OP travels beyond S."""
    found = search(*open_loop(S, J, noise=noise), 60.0, 10.0, 1.0)
    low, high = found.range(found.S, 2.0)
    assert low <= S <= high
    assert found.S[found.top] == pytest.approx(S, abs=0.8)
    low, high = found.range(found.J, 2.0)
    assert low <= J <= 1.1 * high  # a grid of J / S


def test_a_linear_process_needs_no_valve():
    found = search(*open_loop(0.0, 0.0, noise=0.2), 60.0, 10.0, 1.0)
    assert found.F[found.top] - found.F_linear < 1.0
    assert found.range(found.S, 2.0)[0] == 0.0


@pytest.mark.parametrize("linear", get_args(Linear))
def test_every_linear_model_finds_the_sticky_loop(sticky, linear):
    v = detect(sticky(noise=0.05), Params(linear=linear))
    assert v.verdict == "stiction", v.reason
    assert v.evidence["S_low"] <= 6.0 <= 1.01 * v.evidence["S_high"]
    assert v.amount_percent_op == pytest.approx(6.0, rel=0.2)


def test_the_other_valve_needs_stiction_too(sticky):
    """The loop has Kano's valve: He's must gain by sticking as well, and by about as much."""
    v = detect(sticky(noise=0.05), Params(valve="he"))
    assert v.index > 10
    assert v.evidence["S_low"] <= 6.0 <= 1.01 * v.evidence["S_high"]
    assert v.evidence["S"] == pytest.approx(6.0, rel=0.25)


@pytest.mark.parametrize("S", [0.0, 0.5, 2.0])
@pytest.mark.parametrize("period", [40.0, 90.0])
def test_an_outside_sine_neither_accuses_nor_clears(forced, S, period):
    for seed in range(3):
        v = detect(forced(S=S, J=0.5 * S, period=period, seed=seed))
        assert v.verdict in ("inconclusive", "not_applicable")


def test_offset_scale_sign_and_action(sticky):
    base = sticky(noise=0.05)
    first = detect(base)
    for gain, offset, op_gain in ((-3.0, 40.0, 1.0), (0.1, 0.0, -1.0), (1e3, -7.0, 0.02)):
        other = LoopRecord.from_arrays(
            base.t, pv=gain * base.pv + offset, op=50 + op_gain * (base.op - 50), sp=gain * base.sp + offset,
            process="self_regulating",
        )  # fmt: skip
        v = detect(other)
        assert v.index == pytest.approx(first.index, abs=1e-6)
        assert v.amount_percent_op == pytest.approx(abs(op_gain) * first.amount_percent_op)


def test_half_the_samples_say_the_same(sticky):
    base = sticky(noise=0.05, n=6000)
    half = LoopRecord.from_arrays(
        base.t[::2], pv=base.pv[::2], op=base.op[::2], sp=base.sp[::2], process="self_regulating"
    )
    one, two = detect(base), detect(half)
    assert one.verdict == two.verdict == "stiction"
    assert two.amount_percent_op == pytest.approx(one.amount_percent_op, rel=0.12)


def test_without_a_span_there_is_no_percent(sticky):
    base = sticky(noise=0.05)
    v = detect(LoopRecord.from_arrays(base.t, pv=base.pv, op=base.op, sp=base.sp, op_span=None))
    assert v.verdict == "stiction" and v.amount_percent_op is None
    assert "in the unit of OP" in v.reason


def test_signals_that_have_nothing_to_do_with_each_other(wave):
    """PV and OP of different periods: neither model predicts PV, nothing is decided."""
    t = np.arange(3000.0)
    pv = wave("square", t, 50.0) + 0.1 * np.random.default_rng(0).normal(size=3000)
    op = 50 + wave("triangle", t, 71.0)
    v = detect(LoopRecord.from_arrays(t, pv=pv, op=op, sp=0 * t))
    assert v.verdict == "inconclusive"


def test_picture(sticky):
    figure = detect(sticky(noise=0.05)).plot()
    figure.canvas.draw()
    assert figure.axes[1].get_xlabel().startswith("S")
    assert hammerstein.CARD.experimental


def test_nothing_is_shaved_off_a_ramp():
    u = np.arange(200.0)  # no summit, no valley
    assert hammerstein._shaved(u, u, 20.0) == 0.0

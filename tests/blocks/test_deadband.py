"""Deadband: python-control's own backlash as oracle, located reversals, and the describing function."""

import math

import control as ct
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq
from stickslip.blocks.deadband import Deadband
from stickslip.blocks.integrator import Integrator
from stickslip.blocks.periodic import Sine
from stickslip.blocks.pi import PI
from stickslip.blocks.ports import BlockError
from stickslip.blocks.quasi_static_stem import QuasiStaticStem
from stickslip.blocks.recorded import Recorded
from stickslip.blocks.sources import Step
from stickslip.diagram import drive, simulate, wire

WIDE = {"low": -math.inf, "high": math.inf}


@settings(max_examples=40)
@given(st.lists(st.floats(-1.0, 1.0), min_size=2, max_size=30))
def test_equals_the_backlash_of_python_control(levels):
    levels = [0.0, *levels]
    run = drive(Deadband(0.2, **WIDE), float(len(levels)), every=1.0, OP=(np.arange(len(levels)), levels))
    play = ct.friction_backlash_nonlinearity(0.2)  # independent: python-control
    expected = [play(u) for u in levels]
    assert run.ok
    np.testing.assert_allclose(run.log["MV"][:-1], expected, atol=1e-9)


def test_is_the_stem_without_a_jump():
    source = Recorded("OP", [0, 3, 7, 12], [0.5, 0.9, 0.2, 0.8])
    play, stem = Deadband(0.06, start=0.5), QuasiStaticStem(S=0.06, J=0.0, start=0.5)
    a, b = (simulate(wire([source, valve]), 12.0, every=0.1) for valve in (play, stem))
    assert np.array_equal(a.log["MV"], b.log["MV"]) and a.events == b.events


def test_reversals_are_located():
    run = drive(Deadband(0.05, start=0.5), 100.0, OP=Sine("OP", 0.2, 50.0, mean=0.5))
    sticks = [e.t for e in run.events if e.after == "stuck"]
    np.testing.assert_allclose(sticks, [12.5, 37.5, 62.5, 87.5], atol=2e-6)  # analytic: the extrema of the sine


def test_zero_width_passes_op():
    run = drive(Deadband(0.0, start=0.5), 20.0, OP=Sine("OP", 0.2, 10.0, mean=0.5))
    assert run.ok
    np.testing.assert_allclose(run.log["MV"], run.log["OP"], atol=2e-12)


def test_limit_cycle_with_double_integral_action():
    # analytic, approximate: harmonic balance of play, PI and integrator.  It leaves out the harmonics, hence 10 %.
    width, K_p, T_i, rate = 0.0476, 0.2, 20.0, 0.3

    def play(share):  # describing function; share = width / peak-to-peak of OP
        g = 1 - 2 * share
        real = (math.pi / 2 + math.asin(g) + g * math.sqrt(1 - g * g)) / math.pi
        return complex(real, -4 * share * (1 - share) / math.pi)

    def omega(share):  # balance of phase: atan(1/(omega T_i)) = pi/2 + arg play
        n = play(share)
        return 1 / (T_i * math.tan(math.pi / 2 + math.atan2(n.imag, n.real)))

    def gain(share):
        s = 1j * omega(share)
        return abs(play(share) * K_p * (1 + 1 / (s * T_i)) * rate / s) - 1

    share = brentq(gain, 0.01, 0.99)
    for start in (0.02, 0.2):
        valve = Deadband(width, start=start, **WIDE)
        loop = wire([Step("SP", 0.0), PI(K_p=K_p, T_i=T_i, **WIDE), valve, Integrator(rate)])
        run = simulate(loop, 20000.0, every=2.0)
        ups = np.array([e.t for e in run.events if e.block == "valve" and e.after == "sliding up"])
        assert run.ok
        assert np.diff(ups)[-3:] == pytest.approx([2 * math.pi / omega(share)] * 3, rel=0.1)
        assert np.ptp(run.log["OP"][-2000:]) == pytest.approx(width / share, rel=0.1)


def test_misuse_is_explained():
    with pytest.raises(BlockError, match=r"width = -0.1, but a deadband is not negative"):
        Deadband(-0.1)
    with pytest.raises(BlockError, match=r"J = 0.01, but a deadband does not jump; use QuasiStaticStem"):
        Deadband(0.1).with_params(J=0.01)

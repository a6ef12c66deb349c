"""LuGre friction in the stem: presliding, friction curve, breakaway, passivity, the stick-slip stem as its limit."""

import math

import control as ct
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import brentq
from stickslip.blocks.integrator import Integrator
from stickslip.blocks.lugre_stem import LuGreStem
from stickslip.blocks.periodic import Sine
from stickslip.blocks.pi import PI
from stickslip.blocks.ports import BlockError
from stickslip.blocks.recorded import Recorded
from stickslip.blocks.sources import Ramp, Step
from stickslip.blocks.stick_slip import StickSlip
from stickslip.diagram import drive, simulate, wire
from stickslip.diagram.reference import simulate_reference

K, M, F_V, F_C, F_S = 52500.0, 1.36, 612.0, 1250.0, 2250.0
SIGMA = 1e7
SHARP = {"rtol": 1e-9, "atol": 1e-12}
WIDE = {"low": -math.inf, "high": math.inf}


def test_before_breakaway_it_gives_way_as_the_bristles_bend():
    # analytic for slow motion one way: dz/dx = 1 - sigma_0 z/F_s, so k (OP - x) = F_s (1 - exp(-sigma_0 x/F_s))
    run = drive(LuGreStem(v_s=0.1), 30.0, every=3.0, OP=Ramp("OP", 0.001), **SHARP)
    for OP, MV in zip(run.log["OP"][1:], run.log["MV"][1:], strict=True):
        x = brentq(lambda x, OP=OP: K * (OP - x) - F_S * (1 - math.exp(-SIGMA * x / F_S)), 0.0, OP)
        assert pytest.approx(x, abs=2e-7) == MV
    assert run.log["MV"][1] == pytest.approx(K * 0.003 / (K + SIGMA), rel=0.05)  # a spring at first


@pytest.mark.parametrize("rate", [0.02, 0.1, 0.3, -0.1])
def test_friction_in_steady_sliding_is_the_stribeck_curve(rate):
    # analytic: dz/dt = 0 in eq. 1.  F_v > 0.86 (F_s - F_c)/v_s, so that sliding is stable at any speed
    valve = LuGreStem(v_s=0.1, F_v=1e4, **WIDE)
    run = drive(valve, 60.0, every=60.0, OP=Ramp("OP", rate), **SHARP)
    force = K * (run.log["OP"][-1] - run.log["MV"][-1])
    expected = math.copysign(F_C + (F_S - F_C) * math.exp(-((rate / 0.1) ** 2)), rate) + 1e4 * rate
    assert force == pytest.approx(expected, rel=1e-6)


def test_a_slow_ramp_breaks_it_away_at_the_static_friction():
    run = drive(LuGreStem(v_s=0.01), 600.0, every=0.1, OP=Ramp("OP", 0.0001))
    force = K * (run.log["OP"] - run.log["MV"])
    assert force.max() == pytest.approx(F_S, rel=1e-3)  # analytic in the limit of slow ramps
    first = int(np.argmax(force > 0.999 * force.max()))  # later peaks are as high
    assert run.log["MV"][-1] - run.log["MV"][first] > 0.009  # and then it slips


@given(z=st.floats(-1.0, 1.0), v=st.floats(-3.0, 3.0), op=st.floats(0.0, 1.0), sigma_1=st.floats(0.0, 765.0))
def test_friction_never_creates_energy(z, v, op, sigma_1):
    # analytic (Barabanov and Ortega 2000): |z| <= F_s/sigma_0, storage sigma_0 z^2/2, F_v >= sigma_1 (F_s/F_c - 1)
    valve = LuGreStem(sigma_1=sigma_1)
    assert valve.passive
    z *= F_S / SIGMA
    rate = valve.dynamics(0.0, [0.5, v, z], [op])
    friction = K * (op - 0.5) - M * rate[1]
    taken = friction * v - SIGMA * z * rate[2]
    assert taken >= -1e-6 * (1.0 + abs(friction * v))


def test_damping_beyond_the_passive_one_gives_energy_back():
    # analytic: at z = F_s/sigma_0, v = 1: g a^2 + F_v + sigma_1 (1 - a), a = F_s/g = 1.8, is negative
    valve = LuGreStem(sigma_1=1e5)
    assert not valve.passive
    rate = valve.dynamics(0.0, [0.5, 1.0, F_S / SIGMA], [0.5])
    taken = -M * rate[1] - SIGMA * F_S / SIGMA * rate[2]
    assert taken == pytest.approx(F_C * 1.8**2 + F_V - 0.8e5, rel=1e-9)


@given(st.floats(-1.0, 1.0), st.floats(-3.0, 3.0))
def test_bristles_never_bend_beyond_the_static_friction(z, v):
    z = math.copysign(F_S / SIGMA, z)
    rate = LuGreStem().dynamics(0.0, [0.5, v, z], [0.5])[2]
    assert rate * z <= 1e-12  # analytic: g(v) <= F_s


def test_its_limit_is_the_stick_slip_stem():
    op = Sine("OP", 0.1, 100.0, mean=0.5)
    theirs = drive(StickSlip(start=0.5), 200.0, every=0.05, OP=op).log["MV"]
    stiffer = ({"sigma_0": 1e6, "v_s": 1e-3}, {"sigma_0": 1e7, "v_s": 1e-4}, {"sigma_0": 1e8, "v_s": 1e-4})
    apart = []
    for bristles in stiffer:
        run = drive(LuGreStem(**bristles, start=0.5), 200.0, every=0.05, OP=op)
        assert run.ok and run.statistics.steps < 20_000
        apart.append(np.abs(run.log["MV"] - theirs).mean())
    assert apart[0] > 2 * apart[1] and apart[1] > 1.5 * apart[2] and apart[2] < 1e-3


def test_limit_cycle_of_the_integrating_loop():
    # analytic for the stick-slip stem with the same S: PV amplitude S/(2 K_p); soft bristles move earlier
    J, S = (F_S - F_C) / K, (F_S + F_C) / K
    valve = LuGreStem(sigma_0=1e8, v_s=1e-4, start=J / 2, **WIDE)
    loop = wire([Step("SP", 0.0), PI(K_p=0.2, T_i=400.0, **WIDE), valve, Integrator(3.0, 10.0)])
    run = simulate(loop, 2000.0, every=0.5)
    assert run.ok and run.statistics.steps < 25_000  # stiff: thousands of steps for some 40 slips
    assert np.ptp(run.log["PV"][run.log.t > 700.0]) / 2 == pytest.approx(S / 0.4, rel=0.03)


def test_the_reference_agrees():
    diagram = wire([Sine("OP", 0.1, 20.0, mean=0.5), LuGreStem(start=0.5)])
    ours = simulate(diagram, 20.0, every=0.2, rtol=1e-9, atol=1e-12)
    theirs = simulate_reference(diagram, 20.0, every=0.2, rtol=1e-8, atol=1e-12)
    np.testing.assert_allclose(ours.log["MV"], theirs.log["MV"], atol=1e-6)


def test_stops_hold_the_stem_and_let_it_go():
    OP = Recorded("OP", [0.0, 1.0, 2.0, 12.0], [0.5, 1.5, 1.5, 0.5])
    run = drive(LuGreStem(start=0.5), 12.0, every=0.1, OP=OP)
    assert [e.after for e in run.events] == ["at high limit", "free"]
    assert run.log["MV"].max() == 1.0 and run.log["MV"][-1] == pytest.approx(0.5 + F_C / K, abs=3e-3)


def test_python_control_sees_the_stem_held_by_its_bristles():
    poles = ct.poles(ct.linearize(LuGreStem(), [0.5, 0.0, 0.0], [0.5]))
    assert np.abs(poles).max() == pytest.approx(math.sqrt((K + SIGMA) / M), rel=1e-3)  # analytic


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: LuGreStem(1000.0), r"valve: F_s = 1000.0, but static friction is at least.*raise F_s"),
        (lambda: LuGreStem(F_c=0.0), "F_c = 0.0, but it must be positive"),
        (lambda: LuGreStem(sigma_0=0.0), "sigma_0 = 0.0, but it must be positive"),
        (lambda: LuGreStem(sigma_1=-1.0), "sigma_1 = -1.0, but it must be finite and not negative"),
        (lambda: LuGreStem(start=-0.5), "start = -0.5, but the stops"),
    ],
)
def test_misuse_is_explained(make, words):
    with pytest.raises(BlockError, match=words):
        make()

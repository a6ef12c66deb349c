"""Stribeck friction in the stem: breakaway, friction curve, energy, and the stick-slip stem as its limit."""

import math

import control as ct
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from stickslip.blocks.first_order import FirstOrder
from stickslip.blocks.integrator import Integrator
from stickslip.blocks.periodic import Sine
from stickslip.blocks.pi import PI
from stickslip.blocks.ports import BlockError
from stickslip.blocks.recorded import Recorded
from stickslip.blocks.sources import Ramp, Step
from stickslip.blocks.stick_slip import StickSlip
from stickslip.blocks.stribeck_stem import StribeckStem
from stickslip.diagram import drive, simulate, wire
from stickslip.diagram.reference import simulate_reference

K, M, F_V, F_C, F_S = 52500.0, 1.36, 612.0, 1250.0, 2250.0
SHARP = {"rtol": 1e-9, "atol": 1e-12}
WIDE = {"low": -math.inf, "high": math.inf}


@pytest.mark.parametrize("delta", [1.0, 2.0])
def test_it_breaks_away_at_the_static_friction(delta):
    rate = 0.001
    run = drive(StribeckStem(delta=delta), 60.0, OP=Ramp("OP", rate), **SHARP)
    assert run.ok
    assert run.events[0].t == pytest.approx(F_S / K / rate, rel=2e-6)  # analytic: k OP = F_s, a millionth later
    small = drive(StribeckStem(start=0.5), 500.0, OP=Sine("OP", 0.999 * F_S / K, 50.0, mean=0.5))
    assert small.events == () and np.all(small.log["MV"] == 0.5)  # analytic: F_s is never reached


@pytest.mark.parametrize("rate", [0.02, 0.1, 0.3, -0.1])
def test_friction_in_steady_sliding_falls_with_speed(rate):
    # analytic: eq. 1.  Damped so well that sliding is stable at any speed: F_v > 0.86 (F_s - F_c)/v_s
    valve = StribeckStem(v_s=0.1, F_v=1e4, **WIDE)
    run = drive(valve, 60.0, every=60.0, OP=Ramp("OP", rate), **SHARP)
    force = K * (run.log["OP"][-1] - run.log["MV"][-1])
    expected = math.copysign(F_C + (F_S - F_C) * math.exp(-((rate / 0.1) ** 2)), rate) + 1e4 * rate
    assert force == pytest.approx(expected, rel=1e-6) and valve.friction(rate) == pytest.approx(expected)


@given(mode=st.sampled_from(["sliding up", "sliding down"]), x=st.floats(-0.5, 1.5), v=st.floats(0.0, 3.0),
       op=st.floats(-0.5, 1.5), delta=st.floats(0.5, 3.0))  # fmt: skip
def test_friction_takes_energy_at_any_speed(mode, x, v, op, delta):
    valve = StribeckStem(delta=delta, v_s=0.2).in_mode(mode).as_it_starts()
    v = v if mode == "sliding up" else -v
    rate = valve.dynamics(0.0, [x, v], [op])
    stored = M * v * rate[1] + K * (x - op) * rate[0]  # d/dt (M v^2/2 + k (x - OP)^2/2) at held OP
    dry = F_C + (F_S - F_C) * math.exp(-((abs(v) / 0.2) ** delta))
    assert stored == pytest.approx(-dry * abs(v) - F_V * v * v, rel=1e-9, abs=1e-6)  # analytic
    assert stored <= 1e-6


def test_it_comes_to_rest_where_the_stick_slip_stem_creeps():
    run = drive(StribeckStem(), 5.0, every=0.01, OP=0.05)
    assert [e.after for e in run.events] == ["sliding up", "stuck"]
    assert run.events[1].t < 0.2 and np.ptp(run.log["MV"][50:]) == 0.0


def test_its_limit_is_the_stick_slip_stem():
    op = Sine("OP", 0.1, 100.0, mean=0.5)
    theirs = drive(StickSlip(start=0.5), 300.0, every=0.05, OP=op).log["MV"]
    apart = [
        np.abs(drive(StribeckStem(v_s=v_s, start=0.5), 300.0, every=0.05, OP=op).log["MV"] - theirs).mean()
        for v_s in (1e-3, 1e-4, 1e-5)
    ]
    assert apart[0] > 10 * apart[1] > 100 * apart[2] and apart[2] < 5e-6


def test_limit_cycle_of_the_integrating_loop():
    # analytic for the stick-slip stem, whose S it shares: PV amplitude S/(2 K_p)
    def loop(valve):
        return wire([Step("SP", 0.0), PI(K_p=0.2, T_i=400.0, **WIDE), valve, Integrator(3.0, 10.0)])

    J, S = (F_S - F_C) / K, (F_S + F_C) / K
    run = simulate(loop(StribeckStem(v_s=1e-4, start=J / 2, **WIDE)), 2000.0, every=0.5)
    assert run.ok
    assert np.ptp(run.log["PV"][run.log.t > 700.0]) / 2 == pytest.approx(S / 0.4, rel=0.01)


def loop(valve):
    return wire([Step("SP", 0.5), PI(0.4, 10.0, **WIDE), valve, FirstOrder(3.0, 10.0)])


def test_a_loop_costs_few_steps():
    plain = simulate(loop(StickSlip()), 600.0, method="explicit")
    run = simulate(loop(StribeckStem()), 600.0)
    assert run.ok and len(run.events) == len(plain.events) == 22
    assert run.statistics.steps < 4 * plain.statistics.steps


def test_the_reference_agrees():
    ours = simulate(loop(StribeckStem()), 130.0, every=1.0, rtol=1e-10, atol=1e-12)
    theirs = simulate_reference(loop(StribeckStem()), 130.0, every=1.0)
    np.testing.assert_allclose(ours.log["PV"], theirs.log["PV"], atol=1e-6)
    assert [e.after for e in ours.events] == [e.after for e in theirs.events]


def test_linearised_without_its_dry_friction():
    ideal = ct.linearize(StribeckStem().in_mode("ideal"), [0.0, 0.0], [0.0])
    np.testing.assert_allclose(np.sort(ct.poles(ideal).real), np.sort(np.roots([M, F_V, K])), rtol=1e-5)  # analytic
    np.testing.assert_allclose(ct.dcgain(ideal), 1.0, rtol=1e-6)


def test_stops_hold_the_stem():
    OP = Recorded("OP", [0.0, 1.0, 2.0, 12.0], [0.5, 1.5, 1.5, 0.5])
    run = drive(StribeckStem(start=0.5), 12.0, every=0.1, OP=OP, **SHARP)
    assert run.log["MV"].max() == 1.0  # analytic: the stop
    away = next(e.t for e in run.events if e.after == "sliding down")
    assert away == pytest.approx(2.0 + 10 * (0.5 + F_S / K), abs=1e-6)  # analytic: 1 - OP = F_s/k at 0.1 /s


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: StribeckStem(1000.0), r"valve: F_s = 1000.0, but static friction is at least.*raise F_s"),
        (lambda: StribeckStem(v_s=0.0), "v_s = 0.0, but it must be positive"),
        (lambda: StribeckStem(delta=-1.0), "delta = -1.0, but it must be positive"),
        (lambda: StribeckStem(start=2.0), "start = 2.0, but the stops"),
        (lambda: StribeckStem().with_params(F_v=-1.0), "F_v = -1.0"),
    ],
)
def test_misuse_is_explained(make, words):
    with pytest.raises(BlockError, match=words):
        make()

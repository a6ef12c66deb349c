"""A model whose controller is a SampledPID, held against a plant in plain numpy whose controller has a derivative."""

import math

import numpy as np
import pytest
from stickslip.blocks import PID, SampledPID
from stickslip.diagram import drive, simulate, wire
from stickslip.gap import diagnose
from stickslip.gap.effects import effect
from stickslip.gap.exact.operating import inside
from stickslip.gap.likelihood.framing import frame_of
from stickslip.gap.likelihood.hypothesis import Hypothesis
from stickslip.gap.records.model import read, silenced
from stickslip.gap.records.start import start_values

from tests.gap.plain_tank import SCAN, T_I, K, logged, model
from tests.gap.test_unlogged_ways import engine_log

FEW = [effect(name) for name in ("derivative_action", "controller_gain", "controller_integral_time", "process_gain")]
T_D = 10.0


def own(**keywords):
    """Return the model with a PID in the plant's form; the plant has N = 10 and takes back what lies beyond a limit."""
    start = {"start_op": 0.5, "start_SP": 1.0, "start_PV": 1.0, "inputs": ["SP", "PV"]}
    given = {"K_p": K, "T_i": T_I, "T_d": T_D, "dt": SCAN, "form": "velocity", **start, **keywords}
    return model(root=False).replace("controller", SampledPID(**given))


def with_derivative(T_d):
    """Return 40 minutes of the plant, whose controller has this derivative time [s], 0 for none."""
    kind = ("derivative_action", T_d) if T_d else ()
    return logged(*kind, root=False, duration=2400.0)


def test_a_right_model_has_no_gap_also_where_nobody_says_how_it_starts():
    found = [diagnose(own(**start), with_derivative(T_D), catalogue=FEW, limits=False) for start in (
        {}, {"start_SP": 0.0, "start_PV": 0.0}  # its derivative takes the first sample for a step into a limit
    )]  # fmt: skip
    for report in found:
        assert not report.causes
        assert "exact from row to row" in str(report)


@pytest.mark.parametrize(
    ("keywords", "T_d", "cause", "size", "within"),
    [
        ({}, 30.0, ("derivative_action", "T_d"), 30.0, 0.1),
        ({}, 0.0, ("derivative_action", "T_d"), 0.0, 0.02),
        ({"T_d": 0.0}, 30.0, ("derivative_action", "T_d"), 30.0, 0.1),
        ({"K_p": 1.5 * K}, T_D, ("controller_gain", "factor"), 1.0 / 1.5, 0.05),
    ],
    ids=["other T_d", "no derivative", "derivative that the model lacks", "other K_p"],
)
def test_another_tuning_is_named_with_its_size(keywords, T_d, cause, size, within):
    report = diagnose(own(**keywords), with_derivative(T_d), catalogue=FEW, limits=False)
    (found,) = report.causes
    name, key = cause
    assert (found.effect, found.place) == (name, "controller")
    assert found.parameters[key].value == pytest.approx(size, rel=within, abs=within)


def test_a_start_that_is_far_off_is_found():
    for b in (1.0, 0.0):
        quiet, record = read(own(b=b, start_SP=0.0, start_PV=0.0), with_derivative(T_D))
        found = start_values(silenced(quiet), record)
        assert found["controller.f"] == pytest.approx(-float(record.log["PV"][0]), rel=0.05)
        assert found["controller.z"] == pytest.approx(0.5 + K * (1.0 - b), abs=0.05)


def test_behind_a_limit_only_its_integral_part_is_unknown():
    slow = own(T_d=40.0, N=0.4)  # the filter of its derivative remembers for minutes what SP and PV were
    log = engine_log(slow, 3, 2.0, duration=2400.0, levels=(1.0, 1.3, 0.9))
    frame = frame_of(*read(slow, log))
    last, op = int(np.flatnonzero(frame.scans.limited[0])[-1]), frame.signals.index("OP")
    S = Hypothesis(frame).filtered({}).S[:, op]
    assert S[last + 3] < 2.0 * S[last - 20]  # 6 times as large if the filter's memory were unknown too


def test_far_from_its_start_it_is_linearised_between_its_limits():
    far = SampledPID(2.0, 30.0, 8.0, dt=1.0, b=0.0, c=1.0, high=100.0)  # as built OP is at a limit at 80 degrees
    near = {"SP": 80.0, "PV": 80.0, "OP": 40.0}
    ready = inside(far, near)
    assert far.output(0.0, far.d0, [80.0, 80.0])[0] == 0.0
    for u in ([80.1, 80.0], [80.0, 80.1]):
        moved = float(ready.output(0.0, ready.d0, u)[0]) - 40.0
        # analytic: D alone, T_d/(T_d/N + dt) of the error; P has no set point
        assert moved == pytest.approx(2.0 * (8.0 / 1.8 * (u[0] - u[1]) - (u[1] - 80.0)), rel=1e-9)


@pytest.mark.parametrize("b", [1.0, 0.4])
def test_effects_change_the_derivative_and_the_weight_that_a_controller_has(b):
    loop = own(b=b)
    derivative, weight = effect("derivative_action"), effect("setpoint_weight")
    assert derivative.insert(loop, "controller", T_d=T_D) is loop and weight.insert(loop, "controller", b=b) is loop
    changed = weight.insert(derivative.insert(loop, "controller", T_d=25.0), "controller", b=0.7)
    assert [block.name for block in changed.blocks] == [block.name for block in loop.blocks]
    now = changed["controller"].params
    assert (now["T_d"], now["N"], now["b"]) == (25.0, 10.0, 0.7)
    # a gain that depends on PV is put in as another error, which a weighted set point is not
    assert bool(effect("gain_schedule").places(loop)) == (b == 1.0)


def test_a_continuous_pid_that_scans_computes_the_difference_equations():
    pid = PID(2.0, 30.0, 8.0, N=5.0, b=0.6, c=0.5, low=-9.0, high=9.0, T_t=1e3, start_op=0.3)
    loop = wire([pid], inputs=["SP", "PV"])
    scans = effect("scan_time").insert(loop, "controller", period=2.0, present=0.0)
    assert isinstance(scans["controller"], SampledPID)
    times = 2.0 * np.arange(40)
    SP, PV = np.sign(np.sin(times / 9.0)), 0.4 * np.sin(times / 4.0)
    found = simulate(scans, 78.0, times=times, inputs={"SP": (times, SP), "PV": (times, PV)}).log["OP"]
    D, before, total, T_f = 0.0, 0.0, 0.3, 8.0 / 5.0
    for k in range(40):  # analytic: the page of sampled_pid, between the limits
        q = 0.5 * SP[k] - PV[k]
        D, before = T_f / (T_f + 2.0) * D + 8.0 / (T_f + 2.0) * (q - before), q
        assert found[k] == pytest.approx(2.0 * (0.6 * SP[k] - PV[k] + D) + total, abs=1e-9)
        total += 2.0 * 2.0 / 30.0 * (SP[k] - PV[k])
    tracks = effect("scan_time").insert(wire([PID(2.0, 30.0, 8.0)], inputs=["SP", "PV"]), "controller", period=2.0)
    assert tracks["controller"].params["T_t"] == pytest.approx(math.sqrt(30.0 * 8.0))


def test_a_wrong_scan_of_it_is_another_period():
    assert effect("scan_time").insert(own(), "controller", period=6.0)["controller"].period == 6.0
    assert drive(own()["controller"], 4.0, every=2.0, SP=1.0, PV=1.0).log["OP"].tolist() == [0.5] * 3

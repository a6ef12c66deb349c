"""Dead time is exact: against closed forms, breakpoints, delayed feedback, chains and loops of pure delays."""

import math

import numpy as np
import pytest
from stickslip.blocks import Constant, DeadTime, FirstOrder, Integrator, Ramp, SampledPI, Sine, Step, Sum
from stickslip.diagram import simulate, wire
from stickslip.diagram.reference import simulate_reference
from stickslip.engine import layout as at
from stickslip.engine.status import Status

from benchmarks.peers import c_coupled
from benchmarks.peers.c_library import NoCompiler

SHARP = {"rtol": 1e-11, "atol": 1e-13}


def delayed(source, theta, times, t_end, **settings):
    late = DeadTime(theta, inputs="in", outputs="late")
    return simulate(wire([source, late]), t_end, times=times, **settings).log["late"]


@pytest.mark.parametrize("theta", [0.1, 1.0 / 3.0, 2.5, 1000.0])
def test_sine_ramp_and_step(theta):
    t_end = theta + 9.0
    times = np.linspace(theta, t_end, 801)
    sine = delayed(Sine("in", 1.0, 4.0), theta, times, t_end)
    # analytic: 8 points a record at most period/24 long: (2 pi/24)^8/7^8 x max|s (s - 1) .. (s - 7)|/8! < 1e-11
    np.testing.assert_allclose(sine, np.sin(2.0 * np.pi * (times - theta) / 4.0), atol=1e-11)
    ramp = delayed(Ramp("in", 0.5, start=0.2), theta, times, t_end)
    np.testing.assert_allclose(ramp, np.maximum(0.0, 0.5 * (times - theta - 0.2)), atol=1e-12)
    step = delayed(Step("in", 1.0, at=0.7), theta, times, t_end)
    late = times - theta
    clear = np.abs(late - 0.7) > 1e-9
    np.testing.assert_allclose(step[clear], (late >= 0.7)[clear], atol=1e-14)


@pytest.mark.parametrize(("at", "theta"), [(0.1, 1000.0), (0.7, 0.3), (1e-3, 77.7), (0.1, 0.2)])
def test_a_step_leaves_at_the_instant_that_rounding_gives(at, theta):
    leaves = at + theta
    times = [leaves - 1e-9, leaves, leaves + 1e-9]
    late = delayed(Step("in", 1.0, at=at), theta, times, leaves + 1.0)
    np.testing.assert_allclose(late, [0.0, 1.0, 1.0], atol=1e-14)


def test_value_before_the_start():
    late = DeadTime(2.0, start=7.0, inputs="in", outputs="late")
    log = simulate(wire([Constant("in", 1.0), late]), 4.0, every=1.0, t0=100.0).log
    assert log["late"].tolist() == [7.0, 7.0, 1.0, 1.0, 1.0]


def negative_feedback(t):
    """Analytic: x' = -x(t - 1), x = 1 before 0, is sum over k of (-1)^k (t - k + 1)^k/k! for t >= k - 1."""
    return sum((-1.0) ** k * (t - k + 1.0) ** k / math.factorial(k) for k in range(int(t) + 2))


@pytest.mark.parametrize("method", ["auto", "explicit", "stiff"])
def test_delayed_feedback_by_the_method_of_steps(method):
    minus = Sum("rate", {"late": -1.0})
    loop = wire([Integrator(1.0, 1.0, inputs="rate", outputs="x", start=1.0), minus,
                 DeadTime(1.0, start=1.0, inputs="x", outputs="late")])  # fmt: skip
    times = np.linspace(0.0, 10.0, 101)
    settings = SHARP if method != "stiff" else {"rtol": 1e-9, "atol": 1e-11}
    run = simulate(loop, 10.0, times=times, method=method, **settings)
    assert run.ok
    np.testing.assert_allclose(run.log["x"], [negative_feedback(t) for t in times], atol=1e-8)


def test_two_dead_times_in_a_row_are_their_sum():
    times = np.linspace(0.0, 8.0, 1601)
    both = [DeadTime(0.3, inputs="in", outputs="a", name="a"), DeadTime(1.1, inputs="a", outputs="b", name="b")]
    log = simulate(wire([Step("in", 1.0, at=0.1), *both]), 8.0, times=times).log
    clear = np.abs(times - 1.5) > 1e-9
    np.testing.assert_allclose(log["b"][clear], (times > 1.5)[clear], atol=1e-14)


def test_loop_of_nothing_but_a_dead_time_keeps_its_edges():
    # analytic: y(t) = step(t - 0.1) - 0.9 y(t - 1): a staircase whose edges never get smoother
    loop = wire(
        [Step("in", 1.0, at=0.1), Sum("y", {"in": 1.0, "back": -0.9}), DeadTime(1.0, inputs="y", outputs="back")]
    )
    run = simulate(loop, 40.0, every=0.35)
    stairs = np.floor(run.log.t - 0.1 + 1e-12)
    expected = np.where(run.log.t < 0.1, 0.0, (1.0 - (-0.9) ** (stairs + 1)) / 1.9)
    np.testing.assert_allclose(run.log["y"], expected, atol=1e-13)


def test_breakpoints_lose_their_sharpness_behind_integrators_only():
    loop = wire([Step("SP", 1.0, at=0.5), Sum("e", {"SP": 1.0, "PV": -0.5}), FirstOrder(1.0, 2.0, 1.0, inputs="e")])
    run = simulate(loop, 60.0, **SHARP)
    assert run.ok and run.statistics.rejected < 5  # no step is ever tried across an edge


def test_a_long_history_grows_the_delay_line():
    # 24 steps a period, 500 periods under way: far more records than the line has at first
    times = np.linspace(1500.0, 1510.0, 200)
    late = delayed(Sine("in", 1.0, 3.0), 1500.0, times, 1510.0)
    np.testing.assert_allclose(late, np.sin(2.0 * np.pi * (times - 1500.0) / 3.0), atol=1e-11)


def test_dead_time_that_becomes_zero_feeds_through():
    loop = wire([DeadTime(1.0, inputs="in", outputs="late"), Sum("in", {"one": 1.0})], inputs=["one"])
    direct = loop.with_params({"dead_time.theta": 0.0})
    run = simulate(direct, 2.0, every=1.0, inputs={"one": ([0.0, 2.0], [0.0, 2.0])})
    assert run.log["late"].tolist() == [0.0, 1.0, 2.0]
    closed = wire([DeadTime(1.0, inputs="y", outputs="late"), Sum("y", {"late": 0.5})])
    with pytest.raises(ValueError, match="algebraic loop"):
        closed.with_params({"dead_time.theta": 0.0})


def test_tiny_dead_time_ends_with_a_status():
    run = simulate(wire([Sine("MV", 1.0, 7.0), FirstOrder(1.0, 1.0, theta=1e-9)]), 1.0, max_steps=1000)
    assert run.status is Status.TOO_MANY_STEPS and np.isnan(run.log["PV"][-1])


# --- several dead times -----------------------------------------------------------------------------------


def test_breakpoints_of_ten_dead_times_do_not_multiply():
    run = simulate(c_coupled.diagram(10), 200.0)
    assert run.ok and run.statistics.steps < 600  # 200 are needed for the shortest dead time alone; was 29,367
    held = [int(I[I[I[at.L_DELAYS] + k] + at.CAPACITY]) for _, I, _ in run.ends for k in range(I[at.N_DELAYS])]
    assert held == [2048] * 10  # records: no ring has grown


CONTROLLER = {"K_p": 0.2, "T_i": 10.0, "dt": 1.0}
SHORT = {
    "before the process": lambda: [
        SampledPI(**CONTROLLER), DeadTime(0.01, inputs="OP", outputs="MV"), FirstOrder(3.0, 10.0, 3.0),
    ],
    "behind the process": lambda: [
        SampledPI(**CONTROLLER, inputs=["SP", "late"]), FirstOrder(3.0, 10.0, 3.0, inputs="OP"),
        DeadTime(0.01, inputs="PV", outputs="late"),
    ],
}  # fmt: skip


@pytest.mark.parametrize("where", SHORT)
def test_a_short_dead_time_that_stands_still_or_is_only_sampled_does_not_limit_the_steps(where):
    loop = wire([Step("SP", 0.5), *SHORT[where]()])
    run = simulate(loop, 120.0, every=1.0)
    assert run.ok and run.statistics.steps < 600  # two to three instants a scan; were 12,056 and 1,321,279
    theirs = simulate_reference(loop, 6.0, every=0.53)
    ours = simulate(loop, 6.0, every=0.53, **SHARP)
    for signal in ours.log.names:
        np.testing.assert_allclose(ours.log[signal], theirs.log[signal], atol=1e-7, err_msg=signal)


def test_what_is_merged_and_forgotten_is_below_the_tolerance():
    loops = c_coupled.diagram(10)
    fine = simulate(loops, 30.0, rtol=1e-12, atol=1e-14)
    for rtol in (1e-3, 1e-6, 1e-9):
        run = simulate(loops, 30.0, rtol=rtol, atol=1e-3 * rtol)
        for signal in run.log.names:
            np.testing.assert_allclose(run.log[signal], fine.log[signal], atol=rtol, err_msg=signal)


def test_coupled_loops_equal_the_reference():
    loops = c_coupled.diagram(2)
    ours, theirs = simulate(loops, 8.0, every=0.13, **SHARP), simulate_reference(loops, 8.0, every=0.13)
    for signal in ours.log.names:
        np.testing.assert_allclose(ours.log[signal], theirs.log[signal], atol=1e-7, err_msg=signal)


def test_coupled_loops_are_what_the_c_program_converges_to():
    run = simulate(c_coupled.diagram(10), 30.0, every=1.0)
    ours = np.array([run.log[f"PV{i}"] for i in range(10)]).T
    try:
        errors = [np.abs(c_coupled.prepare(30, steps)() - ours).max() for steps in (40, 160, 640)]
    except NoCompiler as missing:
        pytest.skip(str(missing))
    assert errors[2] < 2e-5  # the program crosses jumps without locating them: first order
    assert 2.5 < errors[0] / errors[1] < 6.5 and 2.5 < errors[1] / errors[2] < 6.5

"""Variable dead time: closed forms for straight inputs, the exact dead time as a special case, plug flow."""

import math

import numpy as np
import pytest
from stickslip.blocks.dead_time import DeadTime
from stickslip.blocks.ports import BlockError
from stickslip.blocks.recorded import Recorded
from stickslip.blocks.sources import Constant
from stickslip.blocks.variable_delay import VariableDelay
from stickslip.diagram import drive, simulate, wire


def test_straight_inputs_arrive_as_old_as_theta_says():
    # analytic at the scans: y = u(t - theta) with u = 3 t and theta = 1 + 0.37 t, before the start u = -1
    late = VariableDelay("y", "u", "age", dt=0.1, longest=8.0, start=-1.0)
    t = np.array([0.0, 12.0])
    run = drive(late, 12.0, every=0.1, u=(t, 3.0 * t), age=(t, 1.0 + 0.37 * t))
    seen = run.log.t - (1.0 + 0.37 * run.log.t)
    far = seen > 0.1  # straight lines between samples: exact once both samples lie behind the start
    np.testing.assert_allclose(run.log["y"][far], 3.0 * seen[far], atol=1e-9)
    assert np.all(run.log["y"][seen < -0.1] == -1.0)


def test_a_constant_theta_is_the_dead_time_of_the_engine():
    u = Recorded("u", np.arange(21.0), np.random.default_rng(2).normal(size=21))
    age = Constant("age", 2.5)
    both = wire([u, age, VariableDelay("y", "u", "age", dt=0.5, longest=4.0), DeadTime(2.5, inputs="u", outputs="z")])
    log = simulate(both, 20.0, every=0.5).log
    np.testing.assert_allclose(log["y"][6:], log["z"][6:], atol=1e-9)


def test_theta_is_kept_within_its_range():
    t = np.array([0.0, 10.0])
    for age, seen in ((99.0, 4.0), (-3.0, 0.0)):
        run = drive(VariableDelay("y", "u", "age", dt=0.5, longest=4.0), 10.0, every=0.5, u=(t, t), age=age)
        np.testing.assert_allclose(run.log["y"][9:], run.log.t[9:] - seen, atol=1e-9)


def test_a_run_goes_on_where_it_stood():
    t = np.array([0.0, 20.0])
    loop = wire([Recorded("u", t, t), Constant("age", 3.0), VariableDelay("y", "u", "age", dt=0.5, longest=4.0)])
    half = simulate(loop, 10.0, every=0.5)
    rest = simulate(half.final, 10.0, every=0.5, t0=10.0)
    np.testing.assert_allclose(rest.log["y"], rest.log.t - 3.0, atol=1e-9)


def test_python_control_sees_a_wire():
    twin = VariableDelay("y", "u", "age", dt=0.5, longest=4.0).smooth()
    assert float(twin.output(0.0, [], [0.7, 3.0])[0]) == 0.7


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: VariableDelay("y", "u", "age", dt=0.0, longest=1.0), "dt = 0.0, but it must be positive"),
        (lambda: VariableDelay("y", "u", "age", dt=1.0, longest=0.5), "longest = 0.5, but from one to 10000 scans"),
        (lambda: VariableDelay("y", "u", "age", dt=1e-6, longest=1.0), "longest = 1.0, but from one to 10000 scans"),
        (lambda: VariableDelay("y", "u", "age", dt=1.0, longest=math.inf), "longest = inf"),
        (lambda: VariableDelay("y", "u", "age", dt=1.0, longest=4.0).with_params(longest=9.0), "make another Variable"),
    ],
)
def test_misuse_is_explained(make, words):
    with pytest.raises(BlockError, match=words):
        make()

"""A run that cannot go on says why: never NaN under OK, never a hang; stiff models are no reason to give up."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from stickslip.blocks import Constant, FirstOrder, Step
from stickslip.blocks.block import Block, Kernels
from stickslip.blocks.ports import Port
from stickslip.diagram import simulate, wire
from stickslip.engine.status import Status


def _x(t, x, d, u, p, y):
    y[0] = x[0]


def _power(t, x, d, u, p, dx):
    dx[0] = math.copysign(abs(x[0]) ** p[0], x[0])


class Power(Block):
    """x' = x^q from x = 1; for q > 1 infinite at t = 1/(q - 1)."""

    ports_out = (Port("x"),)
    kernels = Kernels(out=_x, der=_power, feeds=False)

    def __init__(self, q):
        super().__init__(name="power", params={"q": q}, states={"x": 1.0})


def _van_der_pol(t, x, d, u, p, dx):
    dx[0] = x[1]
    dx[1] = p[0] * ((1.0 - x[0] * x[0]) * x[1]) - x[0]


class VanDerPol(Block):
    ports_out = (Port("x"),)
    kernels = Kernels(out=_x, der=_van_der_pol, feeds=False)

    def __init__(self, mu):
        super().__init__(name="vdp", params={"mu": mu}, states={"x": 2.0, "v": 0.0})


def _root(t, x, d, u, p, dx):
    dx[0] = -1.0 / x[0]


class Root(Block):
    """x' = -1/x from x = 1: x = sqrt(1 - 2 t), no solution beyond t = 1/2."""

    ports_out = (Port("x"),)
    kernels = Kernels(out=_x, der=_root, feeds=False)

    def __init__(self):
        super().__init__(name="root", params={}, states={"x": 1.0})


@pytest.mark.parametrize("method", ["auto", "explicit", "stiff"])
@pytest.mark.parametrize("q", [2.0, 3.0])
def test_finite_escape_time(q, method):
    run = simulate(wire([Power(q)], outputs=["x"]), 3.0, every=0.01, method=method)
    assert run.status in (Status.NOT_FINITE, Status.STEP_TOO_SMALL)
    reached = np.isfinite(run.log["x"])
    escape = 1.0 / (q - 1.0)  # analytic, as is the solution before
    # local errors of 1e-6 move the escape by as much
    assert run.log.t[reached][-1] == pytest.approx(escape, abs=0.011)
    early = run.log.t < 0.9 * escape
    exact = (1.0 - (q - 1.0) * run.log.t[early]) ** (-1.0 / (q - 1.0))
    np.testing.assert_allclose(run.log["x"][early], exact, rtol=1e-3)
    assert "power" in run.hint and run.hint


@pytest.mark.parametrize("method", ["auto", "explicit", "stiff"])
def test_a_solution_that_ends(method):
    run = simulate(wire([Root()], outputs=["x"]), 1.0, every=0.01, method=method, max_steps=100_000)
    assert not run.ok and run.hint
    assert np.isnan(run.log["x"][-1])
    np.testing.assert_allclose(run.log["x"][:45], np.sqrt(1.0 - 2.0 * run.log.t[:45]), atol=1e-4)  # analytic


def test_step_budget():
    run = simulate(wire([VanDerPol(1.0)], outputs=["x"]), 1000.0, max_steps=100)
    assert run.status is Status.TOO_MANY_STEPS and run.statistics.steps == 100


def test_van_der_pol_switches_to_the_stiff_method():
    mu = 1000.0
    run = simulate(wire([VanDerPol(mu)], outputs=["x"]), 2000.0, every=1.0)
    assert run.ok and run.statistics.jacobians > 0
    assert run.statistics.steps < 5000  # an explicit method alone needs about mu t/3 = 7e5
    # published: x(2000) = 1.7061677321, test set for IVP solvers (Mazzia & Magherini 2008), there mu t = 2
    assert run.log["x"][-1] == pytest.approx(1.706167732, abs=1e-3)
    sharp = simulate(wire([VanDerPol(mu)], outputs=["x"]), 2000.0, every=2000.0, rtol=1e-9, atol=1e-11)
    assert sharp.log["x"][-1] == pytest.approx(1.706167732170469, abs=1e-6)


def test_stiff_chain_of_lags():
    chain = wire([Step("a", 1.0), FirstOrder(1.0, 1e-6, inputs="a", outputs="b", name="fast"),
                  FirstOrder(1.0, 10.0, inputs="b", outputs="c", name="slow")])  # fmt: skip
    run = simulate(chain, 100.0, every=1.0)
    exact = 1.0 - (10.0 * np.exp(-run.log.t / 10.0) - 1e-6 * np.exp(-run.log.t / 1e-6)) / (10.0 - 1e-6)  # analytic
    assert run.ok and run.statistics.steps < 1000
    np.testing.assert_allclose(run.log["c"], exact, atol=1e-5)


@settings(max_examples=40)
@given(
    q=st.floats(0.5, 4.0), t0=st.sampled_from([0.0, -5.0, 1e6, 1.7e9]), duration=st.floats(1e-3, 5.0),
    rtol=st.sampled_from([1e-3, 1e-6, 1e-10]),
)  # fmt: skip
def test_ok_means_every_row(q, t0, duration, rtol):
    run = simulate(wire([Power(q)], outputs=["x"]), duration, t0=t0, rtol=rtol, every=duration / 7.0, max_steps=200_000)
    assert run.ok == bool(np.isfinite(run.log["x"]).all())
    assert run.ok == (run.hint == "")


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        ({"duration": 0.0}, "positive number of seconds"),
        ({"duration": math.inf}, "positive number of seconds"),
        ({"every": 0.0}, "log interval"),
        ({"every": 11.0}, "at most the duration, 10.0 s"),
        ({"t0": math.nan}, "t0"),
        ({"times": [0.0, math.nan]}, "finite"),
        ({"times": [1.0, 0.5]}, "increase"),
        ({"times": [1.0, 11.0]}, "within"),
        ({"times": []}, "times"),
        ({"rtol": math.nan}, "rtol"),
        ({"rtol": 1e-14}, "rtol"),
        ({"atol": 0.0}, "atol"),
        ({"method": "stif"}, "did you mean 'stiff'"),
    ],
)
def test_requests_that_make_no_sense(asked, message):
    loop = wire([Constant("MV", 1.0), FirstOrder(1.0, 1.0)])
    with pytest.raises(ValueError, match=message):
        simulate(loop, **({"duration": 10.0} | asked))


def test_times_at_the_end_forgive_rounding():
    loop = wire([Constant("MV", 1.0), FirstOrder(1.0, 1.0)])
    run = simulate(loop, 0.3, times=[0.1, 0.1 + 0.2])  # 0.30000000000000004
    assert run.ok and np.isfinite(run.log["PV"]).all()

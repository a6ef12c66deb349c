"""Blocks and diagrams inside interconnections that python-control makes: every system keeps its own parameters.

Expected numbers are analytic: static gains of lags in series, in feedback and side by side.
"""

import warnings

import control as ct
import numpy as np
import pytest
from stickslip.blocks import PI, BlockError, FirstOrder
from stickslip.diagram import WiringError, wire


def foreign(name="other", **ports):
    """x' = -K x + u, y = x: a system of python-control's own, with a parameter called as one of ours; gain 1/K."""
    return ct.nlsys(
        lambda t, x, u, p: -p["K"] * x + u, lambda t, x, u, p: x, states=1, name=name, params={"K": 2.0},
        **({"inputs": 1, "outputs": 1} | ports),
    )  # fmt: skip


def lag(K=3.0, tau=10.0, name="process"):
    return FirstOrder(K, tau, name=name)


def at_rest(system, **given):
    """Return the outputs long after a unit step."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        t = np.linspace(0.0, 2000.0, 5)
        settings = {"solve_ivp_kwargs": {"rtol": 1e-9, "atol": 1e-12}}
        response = ct.input_output_response(system, t, np.ones((system.ninputs, 5)), **settings, **given)
    return np.reshape(response.outputs, (-1, 5))[:, -1]


def diagram(K=3.0, name="loop"):
    return wire([lag(K)], inputs=["MV"], name=name)


@pytest.mark.filterwarnings("ignore:duplicate")
@pytest.mark.parametrize("ours", [lag, diagram], ids=["block", "diagram"])
@pytest.mark.parametrize(
    ("join", "gain"),
    [
        (lambda one: ct.series(one, foreign()), 3.0 / 2.0),
        (lambda one: ct.series(foreign(), one), 3.0 / 2.0),
        (lambda one: ct.parallel(one, foreign()), 3.0 + 0.5),
        (lambda one: ct.feedback(one, foreign()), 3.0 / (1.0 + 3.0 / 2.0)),
        (lambda one: ct.feedback(foreign(), one), 0.5 / (1.0 + 3.0 / 2.0)),
        (lambda one: ct.series(one, lag(2.0)), 6.0),  # two blocks of ours with one name
        (lambda one: ct.series(lag(2.0), one), 6.0),
        (lambda one: ct.series(one, diagram(2.0)), 6.0),
        (lambda one: ct.series(one, one), 9.0),
        (lambda one: ct.series(ct.series(one, foreign("a")), foreign("b")), 0.75),
    ],
)
def test_systems_joined_by_python_control_keep_their_own_parameters(ours, join, gain):
    assert at_rest(join(ours())) == pytest.approx([gain], rel=1e-6)


def test_interconnect_by_signal_names():
    pi = PI(0.4, 10.0, low=-np.inf, high=np.inf)
    loop = ct.interconnect([pi, foreign(inputs=["OP"], outputs=["PV"])], inputs=["SP"], outputs=["PV"])
    assert at_rest(loop) == pytest.approx([1.0], rel=1e-6)  # analytic: integral action leaves no error


def test_append_of_linear_models():
    two = ct.append(ct.linearize(lag(), [0.0], [0.0]), ct.linearize(foreign(), [0.0], [0.0]))
    assert np.diag(two.dcgain()) == pytest.approx([3.0, 0.5], rel=1e-5)


def test_full_names_change_a_block_inside_an_interconnection_and_short_ones_are_told():
    both = ct.series(lag(), foreign())
    assert at_rest(both, params={"process.K": 5.0}) == pytest.approx([2.5], rel=1e-6)
    with pytest.warns(UserWarning, match="to change the block's write 'process.K'"):
        ct.input_output_response(both, [0.0, 1.0], [1.0, 1.0])
    assert at_rest(ct.series(diagram(), foreign()), params={"process.K": 5.0}) == pytest.approx([2.5], rel=1e-6)
    assert at_rest(lag(), params={"K": 5.0}) == pytest.approx([5.0], rel=1e-6)
    assert at_rest(lag(), params={"process.K": 5.0}) == pytest.approx([5.0], rel=1e-6)
    assert at_rest(lag()) == pytest.approx([3.0], rel=1e-6)  # the call before left nothing behind


@pytest.mark.parametrize(
    ("system", "params", "error"),
    [
        (lag, {"k": 1.0}, BlockError),
        (lag, {"process.k": 1.0}, BlockError),
        (lambda: ct.series(lag(), foreign()), {"process.k": 1.0}, BlockError),
        (diagram, {"K": 1.0}, WiringError),
        (diagram, {"process.k": 1.0}, WiringError),
        (lambda: ct.series(diagram(), foreign()), {"process.k": 1.0}, WiringError),
    ],
)
def test_a_misspelt_parameter_of_ours_is_refused(system, params, error):
    with pytest.raises(error, match=r"no parameter '(process\.)?[kK]'"):
        at_rest(system(), params=params)

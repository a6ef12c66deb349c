"""The compiled engine against the interpreted reference: other sweep, other event search, other integrators."""

import math
from functools import cache

import numpy as np
import pytest
from hypothesis import HealthCheck, given, note, settings
from hypothesis import strategies as st
from stickslip.blocks import (
    PI,
    Constant,
    DeadTime,
    FirstOrder,
    IdealValve,
    Integrator,
    QuasiStaticStem,
    Ramp,
    SampledPI,
    SecondOrder,
    Sine,
    Staircase,
    Step,
    StickSlip,
)
from stickslip.diagram import simulate, wire
from stickslip.diagram.reference import simulate_reference
from stickslip.engine.status import Status

SHARP = {"rtol": 1e-10, "atol": 1e-12}


@cache
def reference_run(kind, backend=()):
    """The reference's run of one of ``LOOPS``, made once for all tests that compare with it."""
    return simulate_reference(LOOPS[kind](), 60.0, every=0.6, **{"rtol": 1e-9, "atol": 1e-11} | dict(backend))


def compare(kind, tolerance, ours="auto", **backend):
    ours = simulate(LOOPS[kind](), 60.0, every=0.6, method=ours, **SHARP)
    theirs = reference_run(kind, tuple(backend.items()))
    assert ours.status is theirs.status is Status.OK
    for signal in ours.log.names:
        scale = 1.0 + np.abs(theirs.log[signal]).max()
        np.testing.assert_allclose(ours.log[signal], theirs.log[signal], atol=tolerance * scale, err_msg=signal)
    assert [(e.block, e.before, e.after) for e in ours.events] == [(e.block, e.before, e.after) for e in theirs.events]
    # a stem comes to rest exponentially slowly: when exactly is a matter of the last digits
    slips = [[e.t for e in run.events if e.before == "stuck"] for run in (ours, theirs)]
    np.testing.assert_allclose(*slips, atol=1e-5)


def loop(valve, controller=None, process=None):
    return wire(
        [Step("SP", 0.5, at=1.0), controller or PI(0.4, 10.0), valve, process or FirstOrder(3.0, 10.0)], name="loop"
    )


LOOPS = {
    "stem": lambda: loop(StickSlip()),
    "stem without mass, dead time": lambda: loop(QuasiStaticStem(0.06, 0.02), process=FirstOrder(3.0, 10.0, 1.0)),
    "sampled, second order": lambda: loop(
        StickSlip(v_stop=1e-4), SampledPI(0.2, 10.0, dt=0.7), SecondOrder(3.0, 0.3, 0.7, 0.7)
    ),
    "saturating, integrating": lambda: loop(IdealValve(), PI(2.0, 5.0, high=0.6), Integrator(1.0, 20.0)),
}


@pytest.mark.parametrize("kind", LOOPS)
@pytest.mark.parametrize(
    "backend",
    [{"method": "Radau"}, {"method": "DOP853", "max_step": 0.5}, {"method": "LSODA"}, {"backend": "cvode"}],
    ids=lambda b: next(iter(b.values())),
)
def test_loops(kind, backend):
    if backend.get("backend") == "cvode":
        pytest.importorskip("sksundae")
    compare(kind, 1e-7, **backend)


@pytest.mark.parametrize("kind", LOOPS)
def test_stiff_method(kind):
    compare(kind, 1e-6, ours="stiff", method="Radau")


SOURCES = st.sampled_from(
    [
        lambda: Step("SP", 0.4, at=1.3),
        lambda: Sine("SP", 0.3, 7.0, mean=0.4),
        lambda: Ramp("SP", 0.05, start=0.5, end=9.0),
        lambda: Staircase("SP", [0.1, 0.5, 0.3], dwell=5.0),
    ]
)


def rest(F_s=2250.0):
    """A stem that comes to rest at a speed: with v_stop = 0 its creep towards a held OP never ends, in theory."""
    return StickSlip(F_s, v_stop=1e-4)


@st.composite
def diagrams(draw):
    """A random loop: source, controller, valve, one or two processes, maybe a dead time in the feedback."""
    number = lambda low, high: draw(st.floats(low, high).map(lambda v: float(f"{v:.3g}")))  # noqa: E731
    K_p, T_i = number(0.05, 0.5), number(3.0, 20.0)
    controller = draw(
        st.sampled_from(
            [lambda: PI(K_p, T_i), lambda: SampledPI(K_p, T_i, dt=0.5), lambda: SampledPI(K_p, T_i, dt=0.3, offset=0.1)]
        )
    )()
    valve = draw(st.sampled_from([IdealValve, rest, lambda: rest(1750.0), lambda: QuasiStaticStem(0.06, 0.02)]))()
    theta = draw(st.sampled_from([0.0, 0.5, 1.7]))
    process = draw(
        st.sampled_from(
            [
                lambda: FirstOrder(number(0.5, 2.0), number(2.0, 10.0), theta, outputs="a"),
                lambda: SecondOrder(number(0.5, 2.0), number(0.2, 0.8), number(0.3, 1.5), theta, outputs="a"),
            ]
        )
    )()
    tail = draw(
        st.sampled_from(
            [
                lambda: FirstOrder(1.0, number(0.5, 2.0), name="lag", inputs="a", outputs="PV"),
                lambda: DeadTime(number(0.3, 2.0), inputs="a", outputs="PV"),
            ]
        )
    )()
    return wire([draw(SOURCES)(), controller, valve, process, tail])


@settings(max_examples=10, suppress_health_check=[HealthCheck.too_slow])
@given(diagram=diagrams())
def test_random_loops(diagram):
    # a stem at the edge of breaking away may decide either way on the last digits; friction events aside the runs agree
    note("\n".join(f"{type(b).__name__} {b.params}" for b in diagram.blocks))
    # the last source changes for the last time at 10 s
    ours = simulate(diagram, 12.0, every=0.2, **SHARP)
    theirs = simulate_reference(diagram, 12.0, every=0.2, rtol=1e-9, atol=1e-11)
    assert ours.status is theirs.status is Status.OK
    for signal in ours.log.names:
        np.testing.assert_allclose(ours.log[signal], theirs.log[signal], atol=2e-6, err_msg=signal)


def test_the_reference_stands_on_its_own():
    # analytic: 2 (1 - exp(-(t - 1)/5)) after a dead time of 1 s, whatever the engine does
    lag = wire([Constant("MV", 1.0), FirstOrder(2.0, 5.0, 1.0)])
    for backend in ({}, {"method": "LSODA"}, {"method": "BDF"}):
        run = simulate_reference(lag, 6.0, every=0.5, **backend)
        exact = 2.0 * (1.0 - np.exp(-np.maximum(0.0, run.log.t - 1.0) / 5.0))
        np.testing.assert_allclose(run.log["PV"], exact, atol=1e-7)


@pytest.mark.parametrize(("asked", "message"), [({"backend": "scip"}, "'scipy'"), ({"method": "Radu"}, "'Radau'")])
def test_unknown_backends(asked, message):
    with pytest.raises(ValueError, match=message):
        simulate_reference(loop(IdealValve()), 1.0, **asked)


def test_missing_backend(monkeypatch):
    import sys

    monkeypatch.setitem(sys.modules, "sksundae.cvode", None)
    with pytest.raises(ImportError, match="scikit-sundae"):
        simulate_reference(loop(IdealValve()), 1.0, backend="cvode")


def test_statuses_of_the_reference():
    run = simulate_reference(loop(StickSlip()), 60.0, max_steps=10)
    assert run.status is Status.TOO_MANY_STEPS and math.isnan(run.log["PV"][-1])


@pytest.mark.parametrize("rtol", [1e-6, 1e-8, 1e-10])
def test_rounding_at_breakpoints_is_no_jump(rtol):
    # a breakpoint leaving the dead time differs by rounding from what came before; a stem that watches the rate of OP
    # must not stop for it: here OP rises all the time, so there is one event only
    diagram = wire([Step("SP", 0.4, at=1.3), PI(0.5, 3.0), QuasiStaticStem(0.06, 0.02),
                    FirstOrder(1.0, 2.0, outputs="a"), DeadTime(1.0, inputs="a", outputs="PV")])  # fmt: skip
    run = simulate(diagram, 20.0, every=0.2, rtol=rtol, atol=1e-2 * rtol)
    assert np.all(np.diff(run.log["OP"][8:]) > 0.0)
    assert [(e.t, e.after) for e in run.events] == [(1.3, "sliding up")]


def test_the_reference_log_tells_units_and_spans_as_the_engine_does():
    ours, theirs = simulate(loop(StickSlip()), 5.0), simulate_reference(loop(StickSlip()), 5.0)
    assert ours.log.spans and theirs.log.spans == ours.log.spans and theirs.log.units == ours.log.units

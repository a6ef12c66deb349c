"""Sticky stems and whole plants under ``ct.input_output_response``, against our engine."""

import control as ct
import numpy as np
import pytest
from stickslip.blocks import PI, Deadband, FirstOrder, Positioner, QuasiStaticStem, Step, StickSlip, StribeckStem
from stickslip.cases import find
from stickslip.diagram import WiringError, interpolated, simulate, wire
from stickslip.logs import ReadError, read_log
from stickslip.plant import production_plant

CLOSE = {"rtol": 1e-6, "atol": 1e-9}


def rows_of(loop, t, method="RK45", **solver):
    """Return signal -> values of python-control's own simulation."""
    given = ct.input_output_response(loop, t, 0, loop.x0, solve_ivp_method=method, solve_ivp_kwargs=solver)
    return {name: given.outputs[i] for i, name in enumerate(loop.output_labels)}


@pytest.mark.parametrize(("method", "solver"), [("RK45", {}), ("RK45", CLOSE), ("LSODA", CLOSE)])
@pytest.mark.parametrize("mass", [True, False], ids=["with mass", "without"])
def test_the_thesis_loop(method, solver, mass):
    loop = find("ideal_high").build()
    loop = loop if mass else loop.replace("valve", loop["valve"].quasi_static())
    ours = simulate(loop, 300.0, every=0.1, rtol=1e-8).log  # some cycles of it
    theirs = rows_of(loop, ours.t, method, **solver)
    errors = (theirs["SP"] - theirs["PV"]) - (ours["SP"] - ours["PV"])
    for log in (ours, theirs):  # analytic: the stem stands at one of two places J apart; a massless one jumps at t = 0
        assert np.ptp(log["MV"][2:]) == pytest.approx(1000.0 / 52500.0, abs=1e-3)
    assert np.abs(errors).max() < 1e-3


@pytest.mark.parametrize(
    "valve",
    [
        [StickSlip.high()],
        [QuasiStaticStem()],
        [Deadband(0.05)],
        [StribeckStem(v_s=0.01)],
        [StribeckStem()],
        [Positioner(G=2.0, band=0.005), StickSlip(F_s=1750.0, inputs="p")],
    ],
    ids=["StickSlip", "QuasiStaticStem", "Deadband", "StribeckStem", "thin Stribeck peak", "Positioner"],
)
def test_stems_move(valve):
    loop = wire([Step("SP", 0.5), PI(0.4, 10.0), *valve, FirstOrder(3.0, 10.0)])
    ours = simulate(loop, 100.0, every=0.1, rtol=1e-8).log
    theirs = rows_of(loop, ours.t, "LSODA", **CLOSE)
    np.testing.assert_allclose(theirs["PV"], ours["PV"], rtol=0, atol=1e-3)
    assert np.ptp(theirs["MV"]) > 0.1


def test_a_stop_holds_the_stem():
    t = np.linspace(0.0, 4.0, 401)
    op = np.interp(t, [0.0, 1.0, 2.0, 4.0], [0.0, 1.3, 1.3, 0.5])
    for valve in (StickSlip.high(), QuasiStaticStem()):
        seen = ct.input_output_response(valve, t, op, valve.seen_start(), solve_ivp_kwargs=CLOSE).outputs
        assert 0.99 < seen.max() < 1.001
        assert seen[-1] == pytest.approx(0.5 + 1250.0 / 52500.0, abs=0.02)  # analytic: OP + F_c/k after sliding down


def test_the_plant_from_its_default_start():
    plant = production_plant()
    t = np.linspace(0.0, 20.0, 21)
    theirs = rows_of(plant, t, "LSODA", **CLOSE)
    ours = simulate(plant, 20.0, times=t, rtol=1e-8, method="stiff").log
    for name in plant.output_labels:
        np.testing.assert_allclose(theirs[name], ours[name], rtol=1e-5, atol=1e-5 * np.abs(ours[name]).max())


def test_a_run_is_a_response():
    run = simulate(find("ideal_high").build(), 10.0, every=1.0)
    response = run.response()
    assert isinstance(response, ct.TimeResponseData)
    np.testing.assert_array_equal(response.outputs[response.output_labels.index("PV")], run.log["PV"])
    assert response.time[-1] == 10.0 and response.sysname == "ideal_high"


def test_a_response_is_a_log_and_an_input():
    t = np.linspace(0.0, 10.0, 101)
    lag = wire([FirstOrder(3.0, 10.0)], inputs=["MV"])
    response = ct.input_output_response(lag, t, [np.sin(t)], lag.x0, solve_ivp_kwargs=CLOSE | {"max_step": 0.1})
    log = read_log(response)
    assert log.names == ("PV", "MV")
    np.testing.assert_array_equal(log["MV"], np.sin(t))
    np.testing.assert_array_equal(log["PV"], response.outputs)
    run = simulate(lag, 10.0, times=t, inputs=interpolated(response))  # the same straight lines
    np.testing.assert_allclose(run.log["PV"], response.outputs, rtol=0, atol=1e-4)
    assert np.ptp(run.log["PV"]) > 0.1


def test_a_response_of_many_traces_is_refused():
    two = ct.step_response(ct.ss([[-1.0]], [[1.0, 1.0]], [[1.0]], 0), [0.0, 1.0])
    with pytest.raises(ReadError, match="2 traces"):
        read_log(two)


def test_one_state_without_inputs_has_no_model_in_python_control():
    with pytest.raises(ValueError, match="B matrix"):  # published: python-control 0.10.2 itself
        ct.ss([[-0.1]], np.zeros((1, 0)), np.ones((2, 1)), np.zeros((2, 0)))
    lag = wire([Step("MV", 0.5), FirstOrder(3.0, 10.0)])
    with pytest.raises(WiringError, match=r"no open inputs.*diagram\.cut\('MV'\)"):
        ct.linearize(lag, lag.x0)
    assert ct.linearize(lag.cut("MV"), lag.x0, [0.5]).poles() == pytest.approx([-0.1])  # analytic: -1/tau

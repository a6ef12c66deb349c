"""Relays, switches and resets under python-control's solver: they keep their modes; numbers are analytic."""

import math

import control as ct
import numpy as np
import pytest
from stickslip.blocks import Constant, FirstOrder, Gain, Relay, ResetIntegrator, Sine, Switch
from stickslip.diagram import wire

FINE = {"max_step": 0.1}


def response(diagram, t, **kwargs):
    """Return signal -> values of a response of python-control."""
    found = ct.input_output_response(diagram, t, 0, diagram.x0, solve_ivp_kwargs=kwargs)
    return {name: found.outputs[i] for i, name in enumerate(diagram.output_labels)}


def thermostat():
    return wire([Relay("MV", "PV", 0.6, 0.4, high=0.0, low=1.0), FirstOrder(K=0.8, tau=10.0)])


@pytest.mark.parametrize("method", ["RK45", "Radau", "LSODA"])
def test_a_relay_in_a_loop_cycles_between_its_thresholds(method):
    t = np.linspace(0.0, 60.0, 601)
    loop = thermostat()
    found = ct.input_output_response(loop, t, 0, loop.x0, solve_ivp_method=method, solve_ivp_kwargs=FINE)
    MV, PV = (found.outputs[loop.output_labels.index(s)] for s in ("MV", "PV"))
    late = t > 20.0
    assert PV[late].min() == pytest.approx(0.4, abs=6e-3) and PV[late].max() == pytest.approx(0.6, abs=6e-3)
    falls = t[np.flatnonzero(np.diff(MV) < 0.0)]
    period = 10.0 * (math.log(0.6 / 0.4) + math.log((0.8 - 0.4) / (0.8 - 0.6)))  # down, and up towards 0.8
    assert np.diff(falls) == pytest.approx(period, abs=0.25)


def test_each_response_begins_anew():
    loop, t = thermostat(), np.linspace(0.0, 30.0, 101)
    first, second = response(loop, t, **FINE), response(loop, t, **FINE)
    np.testing.assert_array_equal(first["PV"], second["PV"])
    np.testing.assert_array_equal(first["MV"], second["MV"])


def test_a_switch_keeps_what_it_chose_within_its_hysteresis():
    choice = Switch("y", "c", above="a", below="b", switch_on=0.5, switch_off=-0.5)
    t = np.linspace(0.0, 20.0, 401)
    found = response(wire([Sine("c", 1.0, 10.0), Constant("a", 2.0), Constant("b", -1.0), choice]), t)
    up, down = 10.0 / 12.0, 10.0 * 7.0 / 12.0  # sin > 0.5 from there, sin < -0.5 from there
    expected = np.where((np.mod(t, 10.0) > up) & (np.mod(t, 10.0) < down), 2.0, -1.0)
    assert (found["y"] != expected).sum() <= 4  # rows at the instants themselves


def test_an_integral_is_reset_where_its_reset_rises():
    parts = [Constant("u", 1.0), Sine("r", 1.0, 10.0), ResetIntegrator("y", "u", "r", threshold=0.5, to=0.25)]
    t = np.linspace(0.0, 40.0, 401)
    found = response(wire(parts), t, **FINE)["y"]
    rise = 10.0 / 12.0
    expected = np.where(t < rise, t, 0.25 + np.mod(t - rise, 10.0))
    assert np.abs(found - expected).max() < 3e-3


def test_an_integral_that_resets_itself_is_a_saw():
    t = np.linspace(0.0, 40.0, 401) + 0.05  # no row at a reset
    saw = wire([Constant("u", 0.5), ResetIntegrator("y", "u", "y", threshold=2.0, to=-1.0)])
    expected = np.where(t < 4.0, 0.5 * t, -1.0 + np.mod(0.5 * t - 2.0, 3.0))
    assert np.abs(response(saw, np.append(0.0, t), **FINE)["y"][1:] - expected).max() < 3e-3


def test_a_reset_reaches_what_follows():
    parts = [Constant("u", 1.0), Sine("r", 1.0, 10.0), ResetIntegrator("y", "u", "r"), Gain("half", "y", 0.5)]
    found = response(wire(parts), np.linspace(0.0, 40.0, 401), **FINE)
    np.testing.assert_array_equal(found["half"], 0.5 * found["y"])

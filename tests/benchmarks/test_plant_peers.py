"""The peers of the plant's benchmark solve the same plant: flat equations, LSODA, CVODE, python-control's twins."""

import warnings

import numpy as np
import pytest
from stickslip.diagram import simulate
from stickslip.plant import SETS, kicked, production_plant, steady_state

from benchmarks.peers import production_control, production_equations, production_lsoda
from benchmarks.plant import largest, ratio
from benchmarks.report import in_turn

F_S = 2250.0


def flat(plant, name="B"):
    return production_lsoda.problem(plant, steady_state(SETS[name]), F_S, SETS[name].stem)


@pytest.fixture(scope="module")
def plant():
    return kicked(production_plant("B", F_s=F_S))


@pytest.fixture(scope="module")
def accurate(plant):
    return simulate(plant, 100.0, every=0.1, rtol=1e-9, atol=1e-12, method="stiff")


@pytest.mark.parametrize("name", ["A", "B"])
def test_flat_rates_are_those_of_the_wired_plant(name):
    """Independent: the equations written out flat; recycle, flare and speed control within their limits and beyond."""
    plant = production_plant(name, F_s=F_S)
    for block in plant.blocks:  # the equations written out keep a stuck stem where it stands, whatever pulls at it
        plant = plant.replace(block.name, block.as_it_starts())
    given = flat(plant, name)
    labels = [f"{b}[{s}]" for b, s in (key.split(".") for key in production_equations.ORDER)]
    at = [list(plant.state_labels).index(label) for label in labels]
    rng = np.random.default_rng(11)
    for size in (1e-4, 2e-3, 2e-2, 0.4):
        x = plant.x0.copy()  # the stems, which are no states of the flat equations, stay where they are
        x[at] *= 1.0 + size * rng.standard_normal(len(at))
        ours = plant.dynamics(0.0, x, [])[at]
        theirs = production_equations.compiled_rates(x[at], given.valves, given.c)
        np.testing.assert_allclose(theirs, ours, rtol=1e-9, atol=1e-9)
        s = tuple(x[at].tolist())
        plain = production_equations.rates(s, given.valves[1], given.valves[3], tuple(given.c.tolist()))
        np.testing.assert_allclose(theirs, plain, rtol=1e-9, atol=1e-9)


def test_the_analytic_slope_of_OP(plant):
    """Analytic against a small step along the flow."""
    given = flat(plant)
    s, h = production_equations.states(given.y), 1e-7
    r = production_equations.rates_at(given.y, given.valves, given.c)
    later = production_equations.openings(tuple(a + h * b for a, b in zip(s, r, strict=True)))
    before = production_equations.openings(tuple(a - h * b for a, b in zip(s, r, strict=True)))
    expected = [(b - a) / (2.0 * h) for a, b in zip(before, later, strict=True)]
    np.testing.assert_allclose(production_equations.slopes(s, r), expected, rtol=1e-4, atol=1e-8)


@pytest.mark.parametrize("method", [production_lsoda.run, production_lsoda.stepped])
def test_lsoda_follows_our_run(plant, accurate, method):
    run = method(flat(plant), 100.0, rtol=1e-8, atol=1e-11)
    p_1, V_1 = production_equations.pressure_and_level(run.y)
    assert largest(run.t, p_1, accurate.log["p_1"], 100.0) < 1e-5  # bar
    np.testing.assert_allclose(V_1, accurate.log["V_1"], rtol=0.0, atol=1e-6)
    slips = [e.t for e in accurate.events if e.block in ("VLCS1", "VPCS1") and e.before == "stuck" and e.t > 0.0]
    assert len(slips) >= 8
    for slip in slips:
        assert np.min(np.abs(run.events - slip)) < 1e-4


def test_cvode_follows_our_run(plant, accurate):
    pytest.importorskip("sksundae", reason="scikit-sundae is not installed: CVODE is SKIPPED")
    from benchmarks.peers import production_cvode

    run = production_cvode.run(flat(plant), 100.0, rtol=1e-8, atol=1e-11)
    p_1, V_1 = production_equations.pressure_and_level(run.y)
    assert largest(run.t, p_1, accurate.log["p_1"], 100.0) < 1e-5  # bar
    np.testing.assert_allclose(V_1, accurate.log["V_1"], rtol=0.0, atol=1e-6)


@pytest.mark.parametrize(("kind", "duration"), [("flat", 10.0), ("diagram", 0.5)])
def test_python_control_follows_the_plant_with_mass(plant, kind, duration):
    twin = production_control.flat(flat(plant), F_S) if kind == "flat" else production_control.diagram(plant, F_S)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # scipy's BDF, while its first steps are too long
        run = production_control.run(*twin, duration)
    mass = kicked(production_plant("B", F_s=F_S, stem="full"))
    ours = simulate(mass, duration, every=0.1, rtol=1e-9, atol=1e-12, method="stiff").log
    assert largest(run.t, run.p_1, ours["p_1"], duration) < 5e-5  # bar
    np.testing.assert_allclose(run.V_1, ours["V_1"], rtol=0.0, atol=5e-6)


def test_ratio_is_the_median_of_rounds():
    assert ratio({"ours": [1.0, 2.0, 4.0], "peer": [5.0, 20.0, 12.0]}, "peer") == 5.0
    order = []
    taken = in_turn(2, ours=lambda: order.append("o"), peer=lambda: order.append("p"))
    assert order == ["o", "p", "o", "p", "o", "p"]
    assert len(taken["ours"]) == len(taken["peer"]) == 2

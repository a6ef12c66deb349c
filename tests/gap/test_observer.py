"""A process as an observer: against closed forms, another matrix exponential, and simulations of the diagram itself."""

import numpy as np
import pytest
from scipy.linalg import expm
from stickslip.blocks import FirstOrder
from stickslip.diagram import drive, wire
from stickslip.gap.linearised.between import bends
from stickslip.gap.linearised.observer import observer, phis


def run(made, u, y, start, dt, **params):
    """Return what rows show beyond a prediction that nothing sets right; ``u`` (rows, inputs) along straight lines."""
    table = np.stack([u, u, np.zeros_like(u)])[None]
    K = np.zeros((1, len(made.states), y.shape[1]))
    return made.residuals(params, table, np.array([y] * len(table)), K, np.zeros(len(y), dtype=np.int64), start, {}, dt)


@pytest.mark.parametrize("size", [1e-3, 1.0, 50.0])
def test_functions_of_a_matrix(size):
    A = size * np.random.default_rng(1).normal(size=(4, 4)) - 2.0 * size * np.eye(4)
    one, two = phis(A)
    E, unit = expm(A), np.eye(4)
    np.testing.assert_allclose(A @ one + unit, E, rtol=1e-8, atol=1e-10)  # analytic
    np.testing.assert_allclose(A @ A @ two + A + unit, E, rtol=1e-6, atol=1e-9)  # analytic


def test_a_stiff_linear_process_is_exact():
    piece = wire(
        [
            FirstOrder(inputs="u", outputs="y", K=2.0, tau=5.0),
            FirstOrder(inputs="y", outputs="z", K=1.0, tau=1e-3, name="fast"),
        ],
        ["u"],
    )
    t = np.arange(0.0, 41.0, 2.0)
    shown = 2.0 * (t - 5.0 * (1.0 - np.exp(-t / 5.0)))  # analytic: the response to a ramp
    e = run(observer(piece, ["u"], ["y", "z"], {}), t[:, None], np.stack([shown, shown], axis=1), {}, 2.0)[0]
    assert np.abs(e[:, 0]).max() < 1e-9
    behind = 2.0 * (1.0 - np.exp(-t[1:] / 5.0)) * 1e-3  # analytic: the fast lag is one slope x its time behind
    np.testing.assert_allclose(e[1:, 1], behind, rtol=1e-3)


def test_parameters_differ_from_run_to_run():
    piece = wire([FirstOrder(inputs="u", outputs="y", K=2.0, tau=5.0)], ["u"])
    u, y = np.ones((11, 1)), np.zeros((11, 1))
    made = observer(piece, ["u"], ["y"], {})
    table = np.broadcast_to(np.stack([u, u, 0.0 * u])[None], (2, 3, 11, 1))
    K = np.zeros((1, 1, 1))
    e = made.residuals({"process.K": [2.0, 3.0]}, table, np.stack([y, y]), K, np.zeros(11, dtype=np.int64), {}, {}, 2.0)
    np.testing.assert_allclose(e[1], 1.5 * e[0], rtol=1e-9)
    np.testing.assert_allclose(
        -e[0, :, 0], 2.0 * (1.0 - np.exp(-np.arange(0.0, 22.0, 2.0) / 5.0)), rtol=1e-9
    )  # analytic


def test_a_process_that_bends_follows_its_simulation():
    from stickslip.diagram.changes import part
    from stickslip.plant.build import turbine_and_shaft  # speed follows torque over speed

    whole = turbine_and_shaft()
    piece = part(whole, ["shaft"], "shaft")
    inputs = piece.open_inputs
    t = np.arange(0.0, 201.0, 2.0)
    level = {"tau_d": 15600.0, "tau_2": 9000.0, "tau_3": 6600.0}
    u = np.stack([level[s] * (1.0 + 0.02 * np.sin(t / 9.0 + k)) for k, s in enumerate(inputs)], axis=1)
    log = drive(piece["shaft"], 200.0, every=2.0, **{s: (t, u[:, k]) for k, s in enumerate(inputs)}).log
    e = run(observer(piece, list(inputs), ["w"], {}), u, log["w"][:, None], {}, 2.0)[0]
    assert np.ptp(log["w"]) > 1.0 and np.abs(e).max() < 1e-4 * np.ptp(log["w"])


def test_a_load_is_a_state_of_its_own():
    piece = wire(
        [
            FirstOrder(inputs="w", outputs="D", K=1.0, tau=1e-6, name="load"),
            FirstOrder(inputs="D", outputs="y", K=1.0, tau=5.0),
        ],
        ["w"],
    )
    made = observer(piece, ["w"], ["y"], {"D": 60.0})
    t, u = np.arange(0.0, 41.0, 2.0), np.zeros((21, 1))
    shown = (np.exp(-t / 60.0) - np.exp(-t / 5.0)) / (1.0 - 5.0 / 60.0)  # analytic: the response to a load that decays
    e = run(made, u, shown[:, None], {"D[load]": 1.0}, 2.0)[0]
    assert "D[load]" in made.states and np.abs(e).max() < 1e-6


def test_bends_of_a_parabola_are_its_second_difference():
    t = np.arange(12.0)
    np.testing.assert_allclose(bends(t**2, np.array([], dtype=int)), 2.0)  # analytic
    both = np.concatenate([t**2, 5.0 - 3.0 * t**2])
    np.testing.assert_allclose(bends(both, np.array([11])), [2.0] * 11 + [0.0] + [-6.0] * 11)  # analytic

"""The filter of a linear model: from row to row by closed forms, its gain by another solver of Riccati's equation."""

import numpy as np
from scipy.linalg import expm, solve_discrete_are

from gap.linearised.kalman import gain, innovations, noise, sampled

RNG = np.random.default_rng(3)
A = np.array([[-0.5, 0.3], [0.0, -0.05]])
B, C = np.array([[0.0], [1.0]]), np.array([[1.0, 0.0]])
NONE = np.zeros((1, 1))


def test_inputs_go_along_straight_lines():
    one = sampled(np.array([[-0.5]]), np.eye(1), np.zeros(1), np.eye(1), NONE, np.zeros(1), 2.0)
    t = np.arange(0.0, 21.0, 2.0)
    x = np.zeros(1)
    for k in range(10):
        x = one.F @ x + one.G_0 @ t[k : k + 1] + one.G_1 @ t[k + 1 : k + 2]
    assert abs(x[0] - (2.0 * 20.0 - 4.0 * (1.0 - np.exp(-10.0)))) < 1e-12  # analytic: the response to a ramp


def test_a_constant_input_comes_to_rest():
    one = sampled(A, B, np.zeros(2), C, NONE, np.zeros(1), 2.0)
    rest = np.linalg.solve(np.eye(2) - one.F, (one.G_0 + one.G_1)[:, 0])
    np.testing.assert_allclose(rest, -np.linalg.solve(A, B[:, 0]), rtol=1e-12)  # analytic


def test_noise_that_fast_states_take_in():
    fast = np.diag([-2000.0, -0.01])  # analytic: q (1 - exp(-2 a h)) / (2 a)
    found = noise(fast, np.eye(2), 2.0)
    np.testing.assert_allclose(np.diag(found), [1.0 / 4000.0, (1.0 - np.exp(-0.04)) / 0.02], rtol=1e-9)


def test_the_gain_solves_riccatis_equation():
    F, Q, R = expm(2.0 * A), noise(A, np.diag([0.0, 0.1]), 2.0), np.array([[0.2]])
    K, S = gain(F, C, Q, R)
    P = solve_discrete_are(F.T, C.T, Q, R)  # an independent solver
    np.testing.assert_allclose(S, C @ P @ C.T + R, rtol=1e-8)
    np.testing.assert_allclose(K, P @ C.T @ np.linalg.inv(S), rtol=1e-8)


def test_innovations_of_the_right_model_are_white():
    one = sampled(A, B, np.zeros(2), C, NONE, np.zeros(1), 2.0)
    Q, R = noise(A, np.diag([0.0, 0.1]), 2.0), np.array([[0.2]])
    K, S = gain(one.F, C, Q, R)
    x, y, root = np.zeros(2), np.zeros((4000, 1)), np.linalg.cholesky(Q + 1e-15 * np.eye(2))
    u = np.zeros((4000, 1))
    for k in range(4000):
        y[k] = C @ x + np.sqrt(0.2) * RNG.normal(size=1)
        x = one.F @ x + root @ RNG.normal(size=2)
    e = innovations(one, K, u, u, y, np.zeros(2))[200:, 0] / np.sqrt(S[0, 0])
    assert abs(e.std() - 1.0) < 0.05 and abs(np.corrcoef(e[1:], e[:-1])[0, 1]) < 0.06
    y[500] = np.nan
    again = innovations(one, K, u, u, y, np.zeros(2))
    assert np.isnan(again[500, 0]) and np.isfinite(again[501:]).all()

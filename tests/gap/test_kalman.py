"""The gain of a filter: by another solver of Riccati's equation; row by row where inputs are known less than usual."""

import numpy as np
from scipy.linalg import expm, solve_discrete_are
from stickslip.gap.linearised.gains import FORGOTTEN, Linear, gains
from stickslip.gap.linearised.kalman import gain, noise, predicted

RNG = np.random.default_rng(3)
A = np.array([[-0.5, 0.3], [0.0, -0.05]])
B, C = np.array([[0.0], [1.0]]), np.array([[1.0, 0.0]])
Q, R = noise(A, np.diag([0.0, 0.1]), 2.0), np.array([[0.2]])


def test_noise_that_fast_states_take_in():
    fast = np.diag([-2000.0, -0.01])  # analytic: q (1 - exp(-2 a h)) / (2 a)
    found = noise(fast, np.eye(2), 2.0)
    np.testing.assert_allclose(np.diag(found), [1.0 / 4000.0, (1.0 - np.exp(-0.04)) / 0.02], rtol=1e-9)


def test_the_gain_solves_riccatis_equation():
    P = predicted(A, C, Q, R, 2.0)
    np.testing.assert_allclose(P, solve_discrete_are(expm(2.0 * A).T, C.T, Q, R), rtol=1e-8)  # an independent solver
    K, S = gain(P, C, R)
    np.testing.assert_allclose(S, C @ P @ C.T + R, rtol=1e-12)
    np.testing.assert_allclose(K, P @ C.T @ np.linalg.inv(S), rtol=1e-12)


def test_innovations_stay_of_unit_variance_where_an_input_is_known_less_than_usual():
    process = Linear(A, B, C, Q, R, 2.0, ("a", "b"), np.array([2.0, 3.0]))
    doubts = {k: np.array([4.0]) for k in range(50, 4000, 25)}
    found = gains(process, 4000, doubts)
    assert found.which[49] == 0 < found.which[50] and found.which[50 + FORGOTTEN] == 0
    F, root = expm(2.0 * A), np.linalg.cholesky(Q + 1e-15 * np.eye(2))
    G = np.linalg.solve(A, (F - np.eye(2))) @ B  # analytic: what a constant input comes to
    x, guess, e = np.zeros(2), np.zeros(2), np.zeros((4000, 1))
    for k in range(4000):
        if k in doubts:
            x = x + G[:, 0] * 4.0 * RNG.normal()
        e[k] = C @ x + np.sqrt(0.2) * RNG.normal(size=1) - C @ guess
        guess = F @ (guess + found.K[found.which[k]] / process.size[:, None] @ e[k])
        x = F @ x + root @ RNG.normal(size=2)
    white = found.white(e)[60:, 0]
    at = np.isin(np.arange(60, 4000), list(doubts))
    assert abs(white[at].std() - 1.0) < 0.25 and abs(white[~at].std() - 1.0) < 0.05
    assert abs(np.corrcoef(white[1:], white[:-1])[0, 1]) < 0.06
    assert e[60:][at].std() > 1.5 * e[60:][~at].std()

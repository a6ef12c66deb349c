"""The gain of a Kalman filter of a linear model between two rows of a log.

    dx/dt = A x + w,   y = C x + v          Q the density of w [1/s], R the covariance of v
    e_k = y_k - C x_k,   x_k <- x_k + K e_k     K the gain, S the covariance of e

The innovations e_k of the right model are white; its gain comes from the nuisances and the rounding of the log.
"""

import numpy as np
from scipy.linalg import expm
from stickslip.logs.arrays import Values

ROUNDS = 60  # of doubling, which is far more than any gain needs
SETTLED = 1e-10


def noise(A: Values, Q: Values, dt: float) -> Values:
    """Return the covariance that white noise of density ``Q`` [1/s] adds to the states in ``dt`` [s] (Van Loan 1978).

    >>> noise(np.zeros((1, 1)), np.eye(1), 3.0).round(9).tolist()
    [[3.0]]
    """
    n = len(A)
    parts = 1 << max(0, int(np.ceil(np.log2(max(np.abs(A).sum(axis=1).max() * dt, 1.0)))))
    h = dt / parts
    E = np.zeros((2 * n, 2 * n))
    E[:n, :n], E[:n, n:], E[n:, n:] = -A * h, Q * h, A.T * h
    found = expm(E)
    F = found[n:, n:].T
    S = F @ found[:n, n:]
    while parts > 1:  # doubling: fast states would overflow over the whole interval
        S = S + F @ S @ F.T
        F = F @ F
        parts //= 2
    return np.asarray(0.5 * (S + S.T))


def predicted(A: Values, C: Values, Q: Values, R: Values, dt: float) -> Values:
    """Return the steady covariance of predicted states, by doubling (Anderson and Moore 1979, ch. 6.7).

    ``A`` slopes of the rates [1/s], ``Q`` what noise adds to the states in ``dt`` [s] (``noise``).

    >>> P = predicted(np.zeros((1, 1)), np.eye(1), np.eye(1), np.eye(1), 1.0)  # a random walk: the golden section
    >>> round(float(P[0, 0]), 6)
    1.618034
    """
    n = len(A)
    a, b, P = expm(A * dt).T, C.T @ np.linalg.solve(R, C), Q.copy()
    for _ in range(ROUNDS):
        inner = np.linalg.inv(np.eye(n) + b @ P)
        new = P + a.T @ P @ inner @ a
        b = b + a @ inner @ b @ a.T
        a = a @ inner @ a
        new, b = 0.5 * (new + new.T), 0.5 * (b + b.T)
        done = np.abs(new - P).max() <= SETTLED * np.abs(new).max()
        P = new
        if done:
            break
    return P


def gain(P: Values, C: Values, R: Values) -> tuple[Values, Values]:
    """Return (K, S): gain and covariance of the innovations where predicted states have the covariance ``P``.

    >>> K, S = gain(np.array([[1.0]]), np.eye(1), np.array([[3.0]]))
    >>> float(K[0, 0]), float(S[0, 0])
    (0.25, 4.0)
    """
    S = C @ P @ C.T + R
    return P @ C.T @ np.linalg.inv(S), S

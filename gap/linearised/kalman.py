"""A filter of a linear model between two rows of a log: gain, prediction, innovations.

    dx/dt = A x + B u + c,   y = C x + D u + g          u goes along straight lines from row to row
    x_(k+1) = F x_k + G_0 u_k + G_1 u_(k+1) + h         exactly, by a matrix exponential (Van Loan 1978)
    e_k = y_k - C x_k - D u_k - g,   x_k <- x_k + K e_k     K the steady gain of Kalman's filter

The innovations e_k of the right model are white; its gain comes from the nuisances and the rounding of the log.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm

from engine.filtering import filtered

Floats = NDArray[np.float64]
ROUNDS = 60  # of doubling, which is far more than any gain needs
SETTLED = 1e-10


@dataclass(frozen=True, eq=False)
class Sampled:
    """The model from row to row: ``F`` (n, n), ``G_0``, ``G_1`` (n, inputs), ``h`` (n,), ``C``, ``D``, ``g``."""

    F: Floats
    G_0: Floats
    G_1: Floats
    h: Floats
    C: Floats
    D: Floats
    g: Floats


def sampled(A: Floats, B: Floats, c: Floats, C: Floats, D: Floats, g: Floats, dt: float) -> Sampled:
    """Return a model that is continuous in time from row to row, ``dt`` [s] apart; inputs go along straight lines.

    >>> one = sampled(np.array([[-1.0]]), np.eye(1), np.zeros(1), np.eye(1), np.zeros((1, 1)), np.zeros(1), 1.0)
    >>> round(float(one.F[0, 0]), 9), float((one.F + one.G_0 + one.G_1)[0, 0])
    (0.367879441, 1.0)
    """
    n, m = B.shape[0], B.shape[1] + 1
    E = np.zeros((n + 2 * m, n + 2 * m))
    E[:n, :n], E[:n, n : n + m - 1], E[:n, n + m - 1] = A * dt, B * dt, c * dt
    E[n : n + m, n + m :] = np.eye(m)
    whole = expm(E)
    held, ramp = whole[:n, n : n + m], whole[:n, n + m :]
    return Sampled(whole[:n, :n], (held - ramp)[:, :-1], ramp[:, :-1], held[:, -1], C, D, g)


def noise(A: Floats, Q: Floats, dt: float) -> Floats:
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


def gain(F: Floats, C: Floats, Q: Floats, R: Floats) -> tuple[Floats, Floats]:
    """Return (K, S): steady gain and covariance of the innovations, by doubling (Anderson and Moore 1979, ch. 6.7).

    >>> K, S = gain(np.eye(1), np.eye(1), np.eye(1), np.eye(1))  # a random walk: the golden section
    >>> round(float(K[0, 0]), 6), round(float(S[0, 0]), 6)
    (0.618034, 2.618034)
    """
    n = len(F)
    a, b, P = F.T.copy(), C.T @ np.linalg.solve(R, C), Q.copy()
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
    S = C @ P @ C.T + R
    return P @ C.T @ np.linalg.inv(S), S


def innovations(model: Sampled, K: Floats, u: Floats, ends: Floats, y: Floats, x: Floats) -> Floats:
    """Return e, (rows, outputs), of a log ``y`` (rows, outputs) from state ``x``.

    ``u`` inputs at each row, ``ends`` what they come to just before it, (rows, inputs).  Where ``y`` is NaN nothing is
    set right and e is NaN.  ``x`` is left where it ends.
    """
    drive = u[:-1] @ model.G_0.T + ends[1:] @ model.G_1.T + model.h
    shown = y - u @ model.D.T - model.g
    return np.asarray(filtered(model.F, model.C, K, np.ascontiguousarray(drive), shown, x))

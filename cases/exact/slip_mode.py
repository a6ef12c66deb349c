"""Closed form of the loop while the stem slips: four exponentials about a fixed point."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq
from stickslip.cases.exact.parameters import ExactLoop, ExactLoopError

Array = NDArray[np.float64]


class SlipMode:
    """The slipping loop from a state (y, z, x, 0) at t = 0, slipping in direction s = +-1.

    Fixed point: y = SP, x = -a SP / b, v = 0, z = OP = x + s F_c / k. About it the state is
    sum_i c_i u_i exp(l_i t), with l_i the roots of

        l (l - a) (l^2 + F_v/M l + k/M) + k/M b (K_p l + K_i) = 0

    and eigenvectors u = (b, -K_i b / l, l - a, l (l - a)), which stay well defined when the controller's zero
    cancels the process pole (l = a: the stem takes no part).
    """

    def __init__(self, loop: ExactLoop, state: Array, direction: int) -> None:
        self._direction = direction
        roots = _eigenvalues(loop)
        vectors = np.stack(
            [
                np.full(4, loop.b, dtype=complex),
                -loop.K_i * loop.b / roots,
                roots - loop.a,
                roots * (roots - loop.a),
            ]
        )
        x_rest = loop.x_rest
        self._rest = np.array([loop.SP, x_rest + direction * loop.f_c, x_rest, 0.0])
        # Rows scaled so that v (fast: up to |l| times x) does not spoil the solve.
        row_scale = np.array([1.0, 1.0, 1.0, 1.0 / float(np.abs(roots).max())])
        column_scale = 1.0 / np.abs(vectors * row_scale[:, None]).max(axis=0)
        balanced = vectors * row_scale[:, None] * column_scale
        weights = np.linalg.solve(balanced, (state - self._rest) * row_scale) * column_scale
        self._roots = roots
        self._terms = vectors * weights

    def at(self, t: Array) -> Array:
        """State at the times t [s] since the mode began, shape (4, n)."""
        modes = np.exp(np.multiply.outer(self._roots, t))
        signals: Array = (self._terms @ modes).real + self._rest[:, None]
        return signals

    def dwell(self, left: float) -> float | None:
        """Time [s] until v first returns to zero, or None if that is later than ``left``.

        A sum of real exponentials has few zeros; the scan is 1000 times finer than the fastest mode at first and
        20 points to the loop's natural time later, and the zero it brackets is then located exactly.
        """
        if left <= 0.0:
            return None
        rates = np.sort(np.abs(self._roots))
        first = min(1e-3 / float(rates[-1]), 0.5 * left)
        spacing = 0.05 / float(rates[1])
        coarse = np.arange(1, int(left / spacing) + 1) * spacing
        times = np.unique(np.concatenate([np.geomspace(first, left, 3000), coarse[coarse > first]]))
        forward = self._direction * self.at(times)[3]
        stopped = np.flatnonzero(forward <= 0.0)
        if stopped.size == 0:
            return None
        index = int(stopped[0])
        if index == 0:
            return float(times[0])
        return float(brentq(self._velocity, times[index - 1], times[index], xtol=1e-16, rtol=1e-15))

    def _velocity(self, t: float) -> float:
        return float((self._terms[3] @ np.exp(self._roots * t)).real)


def _eigenvalues(loop: ExactLoop) -> NDArray[np.complex128]:
    """Eigenvalues of the slipping loop [1/s], polished so that the slow ones are accurate in their own scale."""
    a, b, K_p, K_i = loop.a, loop.b, loop.K_p, loop.K_i
    damping, stiffness = loop.F_v / loop.M, loop.k / loop.M
    matrix = np.array(
        [
            [a, 0.0, b, 0.0],
            [-K_i, 0.0, 0.0, 0.0],
            [0.0, 0.0, 0.0, 1.0],
            [-stiffness * K_p, stiffness, -stiffness, -damping],
        ]
    )
    roots = np.linalg.eigvals(matrix).astype(complex)
    gaps = np.abs(roots[:, None] - roots[None, :]) + np.diag(np.full(4, np.inf))
    if float((gaps / np.abs(roots)[:, None]).min()) < 1e-6:
        raise ExactLoopError(
            f"two eigenvalues of the slipping loop coincide ({roots.round(9)} 1/s);"
            " change K_p, T_i or F_v by 1e-5 of its value"
        )
    for _ in range(3):
        process, stem = roots * (roots - a), roots * (roots + damping) + stiffness
        value = process * stem + stiffness * b * (K_p * roots + K_i)
        slope = (2.0 * roots - a) * stem + process * (2.0 * roots + damping) + stiffness * b * K_p
        roots = roots - value / slope
    polished: NDArray[np.complex128] = roots
    return polished

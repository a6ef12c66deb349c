"""The gain of a filter row by row: steady, but where something between two rows is known less than usual.

Right behind a row at which a set point jumps, a controller's output does not go along a straight line: what drives the
process there is known to a share of how far it moves only.  The rows behind trust the log more than the prediction,
until that is forgotten.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm
from stickslip.gap.linearised.kalman import gain, predicted
from stickslip.gap.linearised.observer import phis
from stickslip.logs.arrays import Values

FORGOTTEN = 15  # rows after which the gain is the steady one again


@dataclass(frozen=True, eq=False)
class Linear:
    """A process near a point, in sizes of its states: slopes ``A`` [1/s], ``B`` of its inputs, ``C`` of what is
    measured; ``Q`` what noise adds in ``dt`` [s], ``R`` covariance of what is measured; ``states`` and their ``size``.
    """

    A: Values
    B: Values
    C: Values
    Q: Values
    R: Values
    dt: float
    states: tuple[str, ...]
    size: Values


@dataclass(frozen=True, eq=False)
class Gains:
    """``K`` (kinds, states, outputs) in units of the states, ``root`` (kinds, outputs, outputs) that makes innovations
    white, and ``which`` kind each row has.
    """

    K: Values
    root: Values
    which: NDArray[np.int64]

    def white(self, e: Values) -> Values:
        """Return innovations (..., rows, outputs), each row in the unit of its own."""
        return np.asarray(np.einsum("...ri,rji->...rj", e, self.root[self.which]))

    def of(self, states: tuple[str, ...], known: tuple[str, ...]) -> Values:
        """Return the gains of other states by name; those that are not among the ``known`` ones have none."""
        place = {name: i for i, name in enumerate(known)}
        found = np.zeros((len(self.K), len(states), self.K.shape[2]))
        for i, name in enumerate(states):
            if name in place:
                found[:, i] = self.K[:, place[name]]
        return found


def gains(process: Linear, rows: int, doubts: Mapping[int, Values]) -> Gains:
    """Return the gains of each row; ``doubts``: row -> how far each input may have been off since the row before."""
    steady = predicted(process.A, process.C, process.Q, process.R, process.dt)
    F = expm(process.A * process.dt)
    G = process.dt * phis(process.A * process.dt)[0] @ process.B
    which, P, since = np.zeros(rows, dtype=np.int64), steady, FORGOTTEN
    kinds = [gain(steady, process.C, process.R)]
    for k in range(min(doubts, default=rows), rows):
        if k in doubts:
            pushed = G * doubts[k]
            P, since = P + pushed @ pushed.T, 0
        elif since >= FORGOTTEN:
            continue
        kinds.append(gain(P, process.C, process.R))
        which[k] = len(kinds) - 1
        K = kinds[-1][0]
        P = F @ (P - K @ process.C @ P) @ F.T + process.Q
        P, since = 0.5 * (P + P.T), since + 1
        if since >= FORGOTTEN:
            P = steady
    K = np.stack([K * process.size[:, None] for K, _ in kinds])
    return Gains(K, np.stack([np.linalg.inv(np.linalg.cholesky(S)) for _, S in kinds]), which)

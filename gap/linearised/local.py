"""A process near a point of its path: linear in deviations from it, its loads as states behind its own.

States are in units of their sizes there, loads in their standard deviations.
"""

from collections.abc import Mapping, Sequence

import numpy as np
from stickslip.diagram.diagram import Diagram
from stickslip.diagram.inputs import close
from stickslip.diagram.linear.slopes import Slopes, slopes
from stickslip.gap.linearised.gains import Linear
from stickslip.gap.linearised.kalman import noise
from stickslip.gap.linearised.observer import LEAST, load_state
from stickslip.gap.linearised.parts import Parts
from stickslip.logs.arrays import Values

MISSED = 1e-5  # of a state's size: what a model misses in one second
MOVES, NEAR = 3, 1e-3  # how often a process is moved to where the log is, and how near is enough, of each signal


def near(piece: Diagram, found: Parts, at: Mapping[str, float], shown: Values) -> Slopes:
    """Return the slopes of a process where it shows what the log shows on average, as little moved as that takes."""
    closed = close(piece, {s: at[s] for s in piece.open_inputs})
    local = slopes(closed)
    for _ in range(MOVES):
        rows = [local.signals.index(s) for s in found.measured]
        unit = np.maximum(np.abs(shown), LEAST)
        off = (shown - local.s[rows]) / unit
        if np.abs(off).max() < NEAR:
            break
        local = slopes(closed.at_state(local.x + back(local, found) @ (off * unit)))
    return local


def back(local: Slopes, found: Parts) -> Values:
    """Return how far the states of a process move, as little as that takes, for each of what is measured to move by
    one, (states, measured).
    """
    rows = [local.signals.index(s) for s in found.measured]
    unit = np.maximum(np.abs(local.s[rows]), LEAST)
    size = np.maximum(np.abs(local.x), LEAST)
    C = local.joined()[2][rows] * size / unit[:, None]
    return np.asarray(size[:, None] * np.linalg.pinv(C, rcond=1e-6) / unit)


def linear(
    local: Slopes, given: Sequence[str], measured: Sequence[str], loads: Mapping[str, tuple[float, float]], R: Values,
    dt: float,
) -> Linear:  # fmt: skip
    """Return a process near a point with its loads as states behind its own; ``R`` covariance of what is measured."""
    A, B, C, D = local.joined()
    place = {s: i for i, s in enumerate(local.signals)}
    size = np.maximum(np.abs(local.x), LEAST)
    v, w, rows = [place[s] for s in given], [place[s] for s in loads], [place[s] for s in measured]
    n, m = len(size), len(w)
    sd = np.array([spread for spread, _ in loads.values()])
    decay = np.array([1.0 / time for _, time in loads.values()])
    whole, density = np.zeros((n + m, n + m)), MISSED**2 * np.eye(n + m)
    whole[:n, :n] = A * size / size[:, None]
    whole[:n, n:] = B[:, w] * sd / size[:, None]
    whole[n:, n:] = -np.diag(decay)
    density[n:, n:] = np.diag(2.0 * decay)
    drives = np.vstack([B[:, v] / size[:, None], np.zeros((m, len(v)))])
    shows = np.hstack([C[rows] * size, D[np.ix_(rows, w)] * sd])
    states = (*local.states, *map(load_state, loads))
    return Linear(whole, drives, shows, noise(whole, density, dt), R, dt, states, np.concatenate([size, sd]))

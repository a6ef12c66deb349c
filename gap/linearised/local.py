"""A process near a point of its path: linear in deviations from it, its loads as states behind its own.

States are in units of their sizes there, loads in their standard deviations.
"""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from diagram.diagram import Diagram
from diagram.inputs import close
from diagram.linear.slopes import Slopes, slopes
from gap.linearised.kalman import Sampled, sampled
from gap.linearised.parts import Parts

Floats = NDArray[np.float64]
MISSED = 1e-5  # of a state's size: what a linear model misses in one second
MOVES, NEAR = 3, 1e-3  # how often a process is moved to where the log is, and how near is enough, of each signal
LEAST = 1e-3  # size of a state that starts at less


def near(piece: Diagram, found: Parts, at: Mapping[str, float], shown: Floats) -> Slopes:
    """Return the slopes of a process where it shows what the log shows on average, as little moved as that takes."""
    closed = close(piece, {s: at[s] for s in piece.open_inputs})
    local = slopes(closed)
    for _ in range(MOVES):
        rows = [local.signals.index(s) for s in found.measured]
        unit = np.maximum(np.abs(shown), LEAST)
        off = (shown - local.s[rows]) / unit
        if np.abs(off).max() < NEAR:
            break
        size = np.maximum(np.abs(local.x), LEAST)
        C = local.joined()[2][rows] * size / unit[:, None]
        local = slopes(closed.at_state(local.x + size * np.linalg.lstsq(C, off, rcond=1e-6)[0]))
    return local


def linear(
    local: Slopes, found: Parts, loads: Mapping[str, tuple[float, float]], dt: float
) -> tuple[Sampled, tuple[str, ...], Floats]:
    """Return a process from row to row, in deviations from where its slopes are, in sizes; its states, and these."""
    A, B, c, C, D, g, states, size = scaled(local, found.given, found.measured, loads)
    return sampled(A, B, c, C, D, g, dt), states, size


def scaled(
    local: Slopes, given: Sequence[str], measured: Sequence[str], loads: Mapping[str, tuple[float, float]]
) -> tuple[Floats, Floats, Floats, Floats, Floats, Floats, tuple[str, ...], Floats]:
    """Return A, B, c, C, D, g of a process with its loads as states behind its own; names and sizes of states."""
    A, B, C, D = local.joined()
    place = {s: i for i, s in enumerate(local.signals)}
    size = np.maximum(np.abs(local.x), LEAST)
    v, w = [place[s] for s in given], [place[s] for s in loads]
    rows = [place[s] for s in measured]
    n, m = len(size), len(w)
    whole = np.zeros((n + m, n + m))
    whole[:n, :n] = A * size / size[:, None]
    sd = np.array([spread for spread, _ in loads.values()])
    whole[:n, n:] = B[:, w] * sd / size[:, None]
    whole[n:, n:] = -np.diag([1.0 / time for _, time in loads.values()])
    drives = np.vstack([B[:, v] / size[:, None], np.zeros((m, len(v)))])
    shows = np.hstack([C[rows] * size, D[np.ix_(rows, w)] * sd])
    c = np.concatenate([local.rates / size, np.zeros(m)])
    states = (*local.states, *(f"{s}[load]" for s in loads))
    return whole, drives, c, shows, D[np.ix_(rows, v)], local.s[rows], states, np.concatenate([size, sd])


def spread(local: Slopes, loads: Mapping[str, tuple[float, float]]) -> tuple[Floats, Floats, Floats]:
    """Return A, the density of the noise that moves the states, and their sizes."""
    A, *_, states, size = scaled(local, (), (), loads)
    Q = MISSED**2 * np.eye(len(states))
    for k, (_, time) in enumerate(loads.values()):
        j = len(states) - len(loads) + k
        Q[j, j] = 2.0 / time
    return A, Q, size

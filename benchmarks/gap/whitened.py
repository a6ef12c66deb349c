"""The autoregression that makes the noise of a loop's logged signals white, fitted to long runs of ``physics``."""

from functools import lru_cache

import numpy as np
from stickslip.logs.arrays import Values

from benchmarks.gap.generator import autoregression
from benchmarks.gap.physics import run
from benchmarks.gap.settings import SETTINGS

ORDER = 24  # rows that whitening looks back
HOURS = 100  # of noise that it is fitted to
STEPS = 5  # of the integration a second
FIRST = 60  # rows that no diagnosis judges


def kept(setting: str, out: Values) -> Values:
    """Return what a log keeps of the loop at whole seconds, not rounded, (rows, signals); OP is the last signal."""
    loop = SETTINGS[setting]
    return np.asarray(out[:: loop.every][:, [5, 0, 1, 2] if "outer_K" in loop.numbers else [1, 2]])


def judged(d: Values, A: Values, W: Values) -> Values:
    """Return the whitened rows that a diagnosis judges."""
    return whitened(d, A, W)[max(FIRST, ORDER) :]


def whitened(d: Values, A: Values, W: Values) -> Values:
    """Return whitened rows, each signal of unit variance: W (d_k - sum A_j d_k-j)."""
    e = d.copy()
    for j, a in enumerate(A, start=1):
        e[j:] -= d[:-j] @ a.T
    return np.asarray(e @ W.T)


@lru_cache(maxsize=8)
def noise_of(setting: str, numbers: tuple[float, ...]) -> Values:
    """Return what the noise of a loop makes of its logged signals, always of the same random numbers."""
    loop = SETTINGS[setting]
    rng = np.random.default_rng([3, list(SETTINGS).index(setting)])
    n = 3600 * HOURS
    sp = np.full(n, round(float(np.mean(loop.levels)), 2))
    random = loop.noise * rng.normal(size=n), rng.normal(size=n), loop.load * autoregression(rng, n)
    out = run(np.array(numbers), sp, *random, np.zeros(n), STEPS, float(sp[0]))
    rows = kept(setting, out)[3600 // loop.every :]
    fine, coarse = loop.rounding
    steps = [fine, coarse, fine, coarse] if rows.shape[1] == 4 else [fine, coarse]
    rows = np.round(rows / steps) * steps
    return np.asarray(rows - rows.mean(axis=0))


@lru_cache(maxsize=8)
def whitening(setting: str, numbers: tuple[float, ...]) -> tuple[Values, Values]:
    """Return (A_j, W) that make the noise of a loop's logged signals white, of unit variance."""
    rows = noise_of(setting, numbers)
    scale = rows.std(axis=0)
    rows = rows / scale
    m = rows.shape[1]
    past = np.hstack([rows[ORDER - j : -j] for j in range(1, ORDER + 1)])
    C = np.linalg.lstsq(past, rows[ORDER:], rcond=None)[0]
    left = rows[ORDER:] - past @ C
    W = np.linalg.inv(np.linalg.cholesky(left.T @ left / len(left)))
    A = np.stack([scale[:, None] * C[m * j : m * (j + 1)].T / scale for j in range(ORDER)])
    return A, W / scale

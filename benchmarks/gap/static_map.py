"""The shape of a static non-linearity before a lag, found without naming one: a latent map between input and process.

    y = (1/(tau s + 1)) m(u),   m(u) = b + sum_j g_j r_j(u)        r_j rises by 1 between two nodes, quantiles of u

For each tau the rises g_j, all of one sign, are a least-squares fit; tau is the best of a grid.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import lsq_linear
from scipy.signal import lfilter
from stickslip.logs.arrays import Values

NODES = 8


@dataclass(frozen=True)
class StaticMap:
    """A map from ``u`` (nodes,) to the steady output ``y`` (nodes,); ``tau`` [s]; ``rms`` what is left of the output.

    ``linear_rms`` what is left with a straight map.
    """

    u: Values
    y: Values
    tau: float
    rms: float
    linear_rms: float

    @property
    def gains(self) -> Values:
        """Slope of the map between neighbouring nodes [unit of y per unit of u], (nodes - 1,)."""
        return np.diff(self.y) / np.diff(self.u)


def static_map(t: ArrayLike, u: ArrayLike, y: ArrayLike, nodes: int = NODES) -> StaticMap:
    """Return the static map between an input, held between rows, and an output behind one lag.

    >>> rng = np.random.default_rng(0)
    >>> t, u = np.arange(2000.0), np.repeat(rng.uniform(0.0, 2.0, 100), 20)
    >>> v = np.maximum(u - 1.0, 0.0)  # a dead zone up to 1
    >>> y = lfilter([0.0, 0.1], [1.0, -0.9], v)
    >>> found = static_map(t, u, y)
    >>> abs(round(float(found.gains[0]), 2)), round(float(found.gains[-1]), 1), bool(found.rms < 0.2 * found.linear_rms)
    (0.0, 1.0, True)
    """
    t, u, y = (np.asarray(v, dtype=float) for v in (t, u, y))
    dt = float(np.median(np.diff(t)))
    at = np.unique(np.quantile(u, np.linspace(0.0, 1.0, nodes)))
    rises = np.stack([np.clip((u - a) / (b - a), 0.0, 1.0) for a, b in pairwise(at.tolist())], axis=1)
    sign = 1.0 if np.corrcoef(u, y)[0, 1] >= 0.0 else -1.0
    best: StaticMap | None = None
    for tau in dt * np.geomspace(0.3, len(t) / 5.0, 40):
        a = float(np.exp(-dt / tau))
        start = a ** np.arange(len(t))
        X = np.column_stack([_lagged(sign * rises, a), _lagged(np.ones((len(t), 1)), a), start])
        free = [0.0] * rises.shape[1] + [-np.inf, -np.inf]
        h = lsq_linear(X, y, (free, np.inf)).x
        straight = np.column_stack([_lagged(np.column_stack([np.ones_like(u), u]), a), start])
        line = straight @ np.linalg.lstsq(straight, y, rcond=None)[0]
        rms = float(np.sqrt(np.mean((y - X @ h) ** 2)))
        if best is None or rms < best.rms:
            heights = h[-2] + sign * np.append(0.0, np.cumsum(h[:-2]))
            best = StaticMap(at, heights, float(tau), rms, float(np.sqrt(np.mean((y - line) ** 2))))
    if best is None:
        raise ValueError("the record has no rows; give at least some tens")
    return best


def _lagged(X: Values, a: float) -> Values:
    return np.asarray(lfilter([0.0, 1.0 - a], [1.0, -a], X, axis=0))

"""The Harris index: how far the loop is from the least variance that any controller could reach at its dead time.

    y(t) = sum psi(i) e(t - i),   from an AR model of y;   minimum variance = var(e) (psi(0)^2 + ... + psi(d - 1)^2)
    eta = minimum variance / var(y),    Harris index = 1 - eta

Feedback cannot touch what happens within the dead time of d samples, and nothing else has to remain: eta = 1 is a loop
at minimum variance, eta near 0 one whose error could be foretold d samples ahead. An oscillation is foretold well, so
that eta says that there is something to gain, not what: valve, tuning and outside waves look alike.

With the dead time unknown d is a horizon of one's own choice (the extended horizon index): compare like with like only.

Source: Harris 1989, Can. J. Chem. Eng. 67:856; Desborough and Harris 1992, ibid. 70:1186; Thornhill, Oettinger and
Fedenczuk 1999, J. Process Control 9:109 (horizon). Ours: the order of the AR model by Akaike's criterion
up to ``ORDER``.
"""

from dataclasses import dataclass

import numpy as np
from stickslip.logs.arrays import Values

ORDER = 30  # Desborough and Harris take 5 to 30


@dataclass(frozen=True)
class Harris:
    """eta [-], the dead time or horizon [samples], the order of the AR model, variance of y and its minimum."""

    eta: float
    horizon: int
    order: int
    variance: float
    minimum: float

    @property
    def index(self) -> float:
        """1 - eta [-]: 0 at minimum variance, near 1 where nearly all could be taken away."""
        return 1.0 - self.eta


def harris(y: Values, horizon: int) -> Harris | None:
    """The index of a control error y (n,) at a dead time of so many samples; None for a flat or too short signal.

    White noise cannot be foretold, so that no controller does better:

    >>> found = harris(np.random.default_rng(0).normal(size=2000), 5)
    >>> round(found.eta, 2)
    1.0
    """
    if horizon < 1:
        raise ValueError(f"horizon = {horizon} samples; give 1 or more, the dead time included")
    n = len(y)
    scale = float(np.max(np.abs(y))) if n else 0.0
    if not 1e-150 < scale < 1e150:
        return None  # squares of such numbers are none
    y = y - np.mean(y)
    variance = float(np.mean(y * y))
    most = min(ORDER, n // 10)
    if most < 1 or variance <= 0.0 or not np.isfinite(variance):
        return None
    r = np.array([y[: n - k] @ y[k:] for k in range(most + 1)]) / n
    a, noise, best = np.zeros(0), float(r[0]), (n * np.log(r[0]), np.zeros(0), float(r[0]))
    for k in range(1, most + 1):  # Levinson and Durbin
        reflection = float(r[k] - a @ r[k - 1 : 0 : -1]) / noise
        a = np.append(a - reflection * a[::-1], reflection)
        noise *= 1.0 - reflection**2
        if noise <= 1e-12 * variance:
            best = (-np.inf, a, max(noise, 0.0))
            break
        aic = n * np.log(noise) + 2.0 * k
        if aic < best[0]:
            best = (aic, a, noise)
    _, a, noise = best
    psi = np.zeros(horizon)
    psi[0] = 1.0
    for i in range(1, horizon):
        reach = min(i, len(a))
        psi[i] = a[:reach] @ psi[i - 1 : i - 1 - reach if i > reach else None : -1]
    minimum = noise * float(psi @ psi)
    return Harris(min(minimum / variance, 1.0), horizon, len(a), variance, minimum)

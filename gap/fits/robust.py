"""Linear steps against Student's loss: which change of a few parameters brings innovations down to the noise floor.

    min over d in bounds of  sum rho((e + J d) / s),    rho(z) = (nu + 1)/2 ln(1 + z^2/nu)

by reweighted least squares.  The scale s starts at the size of the innovations and shrinks to 1: far from the floor the
loss is flat almost everywhere and has a narrow trough, which a wide scale finds.
"""

import numpy as np
from numpy.typing import NDArray
from stickslip.gap.floors.floor import NU, UNIT, losses

Floats = NDArray[np.float64]
SHRINK = 0.4  # of the scale from round to round
ROUNDS = 30


def step(e: Floats, J: Floats, low: Floats, high: Floats) -> tuple[Floats, float]:
    """Return (d, F): the change within ``low`` to ``high``, (parameters,), and the loss that the line promises.

    ``e`` (n,) innovations, ``J`` (n, parameters) their slopes; unknown ones are left out.
    """
    known = np.isfinite(e) & np.isfinite(J).all(axis=1)
    e, J = e[known], J[known]
    p = J.shape[1]
    size = np.linalg.norm(J, axis=0)
    if len(e) == 0 or not (size > 0.0).all():
        return np.zeros(p), float(losses(e).sum())
    scaled = J / size
    d, left = np.zeros(p), e
    best, cost = d, float(losses(e).sum())
    s = max(1.0, float(np.median(np.abs(e))) * 3.0)
    for _ in range(ROUNDS):
        w = 1.0 / (1.0 + (left / (UNIT * s)) ** 2 / NU)
        G = scaled.T @ (scaled * w[:, None])
        change = np.linalg.lstsq(G, -scaled.T @ (w * left), rcond=1e-10)[0]
        d = np.clip(d + change, low * size, high * size)
        left = e + scaled @ d
        new = float(losses(left).sum())
        if new < cost:
            best, cost = d.copy(), new
        if s == 1.0 and np.linalg.norm(change) < 1e-3:
            break
        s = max(1.0, SHRINK * s)
    return best / size, cost

"""Where a plant rests: the state to which its own run leads back.

    z <- z + (I - A)^-1 (f(z) - z)        f: the run over the first rows,  A: its slopes, across runs

A sensor that has read high for long has moved a plant away from where its model starts, hidden slow states included.
"""

import numpy as np
from numpy.typing import NDArray
from stickslip.blocks.block import Block
from stickslip.engine.entry import advance_to
from stickslip.engine.restarts import put, standing
from stickslip.gap.exact.exact import LEAST
from stickslip.gap.likelihood.prepared import Prepared

Floats = NDArray[np.float64]
Whole = NDArray[np.int64]
ROUNDS = 4  # of Newton's method
ASIDE = 0.02  # share of its size by which a state is moved for its slope
STILL = 1e-5  # share of its size by which a state that rests may move
EVENTS = 4096


def resting(
    p: Prepared, blocks: tuple[Block, ...], places: Whole, noises: Whole, span: tuple[float, float]
) -> Floats | None:
    """Return the state (n,) that the run over a ``span`` of time leaves as it is; None where none is found.

    ``places`` (2, n) where states are set and read; ``noises`` (q,) where those are set that hold a noise.
    """
    I, W = p.fresh(span[0], blocks)
    z = standing(W, places[0])
    size, own = np.maximum(np.abs(z), LEAST), np.flatnonzero(~np.isin(places[0], noises))

    def left(z: Floats) -> Floats:
        run_I, run_W = I.copy(), W.copy()
        put(run_I, run_W, places[0], z)
        status = advance_to(run_I, run_W, np.empty((EVENTS, 4)), np.empty(0), np.empty((0, 1)), span[1], False)
        return standing(run_W, places[1]) - z if status == 0 else np.full(len(z), np.nan)

    for _ in range(ROUNDS):
        now = left(z)[own]
        if np.all(np.abs(now) <= STILL * size[own]):
            return z
        if not np.isfinite(now).all():
            return None
        slopes = np.empty((len(own), len(own)))
        for k, i in enumerate(own):
            ahead = z.copy()
            ahead[i] += ASIDE * size[i]
            slopes[:, k] = (left(ahead)[own] - now) / ASIDE
        if not np.isfinite(slopes).all():
            return None
        z = z.copy()
        z[own] -= np.linalg.lstsq(slopes, now, rcond=1e-9)[0] * size[own]
    return None

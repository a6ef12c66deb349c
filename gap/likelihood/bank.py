"""What a bank of stems leaves of a record: each stem has a hidden mode, and gains of a filter that knows the stem."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray
from stickslip.engine.bank import banked
from stickslip.engine.restarts import kept_sizes, standing
from stickslip.gap.likelihood.gains import gains_for
from stickslip.gap.likelihood.hypothesis import EVENTS, FAR, Hypothesis, Innovations, complain

Floats = NDArray[np.float64]
SEED = 1  # of the numbers that a bank draws: the same for all sizes, so that losses compare


def left_by_bank(one: Hypothesis, values: Mapping[str, float], near: Innovations, count: int) -> Innovations:
    """Return what a bank of ``count`` stems leaves, each with a hidden mode of its own; ``near`` knows the mode.

    Raises ``ArithmeticError`` where a run of the diagram fails.
    """
    f, p = one.frame, one.prepared
    full = {**one.nominal, **values}
    I, W = p.fresh(float(f.stops[0][0]), one.blocks_with(full))
    phi, sd = one.noise_with(full)
    z = standing(W, one.places[0])
    times, row_of = f.stops
    assert one.effect is not None
    b, c = p.diagram.block_index(one.effect.block(one.place)), p.component
    hidden = np.arange(c.memory[b], c.memory[b] + len(p.diagram.blocks[b].memory_names))
    rng = np.random.default_rng(SEED)
    drawn = rng.standard_normal((len(times), count, len(p.noise)))
    dither, shares = rng.random((len(f.Y), count, len(f.signals))), rng.random(len(f.Y))
    e, losses = np.full(f.Y.shape, np.nan), np.zeros(len(f.Y))
    stood, came = np.zeros((len(times), count)), np.zeros((len(f.Y), count), dtype=np.int64)
    gains = gains_for(one.labels, near.hypothesis.labels, near.gains)
    status = banked(
        I, W, np.empty((EVENTS, 4)), *kept_sizes(I), one.places, one.shown, one.places[0, one.where],
        hidden, times, row_of, phi, sd, f.anew, np.sqrt(12.0 * f.r), gains, near.S, FAR, z, drawn, dither,
        shares, losses, e, stood, came,
    )  # fmt: skip
    complain(status)
    return Innovations(one, full, e, near.S, near.gains, near.kinks, near.turns, near=near, mixed=losses,
                       stem=_path(stood, came, row_of))  # fmt: skip


def _path(stood: Floats, came: NDArray[np.int64], row_of: NDArray[np.int64]) -> Floats:
    """Return where the hidden block of one likely stem stood at each stop."""
    found, j = np.empty(len(stood)), 0
    for k in range(len(stood) - 1, -1, -1):
        found[k] = stood[k, j]
        if row_of[k] >= 0:
            j = int(came[row_of[k], j])
    return found

"""What a bank of stems leaves of a record: each stem has a hidden mode, and gains of a filter that knows the stem."""

from collections.abc import Mapping

import numpy as np
from scipy.special import ndtri
from stickslip.engine.bank import banked
from stickslip.engine.restarts import kept_sizes, standing
from stickslip.gap.exact.affine import NotAffine
from stickslip.gap.exact.stems import left_by_stems, likely_path
from stickslip.gap.insertion.inserted import percent_of_stem
from stickslip.gap.insertion.paths import given
from stickslip.gap.likelihood.gains import gains_for
from stickslip.gap.likelihood.hypothesis import EVENTS, FAR, Hypothesis, Innovations, bar_of
from stickslip.gap.likelihood.path import complain
from stickslip.gap.likelihood.threads import go_on
from stickslip.logs.arrays import Values

DRAWN = 8  # times as many stems where each draws what the controllers give
EARLY = 1e-6  # of a scan [s], by which a stop may come before it
SEED = 1  # of the numbers that a bank draws: the same for all sizes, so that losses compare


def left_by_bank(
    one: Hypothesis, values: Mapping[str, float], near: Innovations, count: int, best: Innovations | None = None
) -> Innovations:
    """Return what a bank of ``count`` stems leaves, each with a hidden mode of its own; ``near`` knows the mode.

    Raises ``ArithmeticError`` where a run of the diagram fails, or the ``best`` of the same rows is far ahead.
    """
    go_on()
    exactly = _in_linear_loop(one, {**one.nominal, **values}, count)
    if exactly is not None:
        return exactly
    f, p = one.frame, one.prepared
    full = {**one.nominal, **values}
    I, W = p.fresh(float(f.stops[0][0]), one.blocks_with(full), f.most_steps)
    phi, sd = one.noise_with(full)
    z = standing(W, one.places[0])
    times, row_of = f.stops
    assert one.effect is not None
    b, c = p.diagram.block_index(one.effect.block(one.place)), p.component
    hidden = np.arange(c.memory[b], c.memory[b] + len(p.diagram.blocks[b].memory_names))
    rng = np.random.default_rng(SEED)
    drawn = drawn_evenly(rng, len(times), len(p.noise), count)
    dither, shares = rng.random((len(f.Y), count, len(f.signals))), rng.random(len(f.Y))
    e, losses = np.full(f.Y.shape, np.nan), np.zeros(len(f.Y))
    stood, came = np.zeros((len(times), count)), np.zeros((len(f.Y), count), dtype=np.int64)
    near = near.followed
    assert near.gains is not None
    gains = gains_for(one.labels, near.hypothesis.labels, near.gains)
    reach = full[one.own[0]] * percent_of_stem(f.model, one.place)
    status = banked(
        I, W, np.empty((EVENTS, 4)), *kept_sizes(I), one.places, one.shown, one.places[0, one.where],
        hidden, times, row_of, phi, sd, f.anew, np.sqrt(12.0 * f.r), gains, near.S, FAR, bar_of(best), f.sure, reach, z,
        drawn, dither, shares, losses, e, stood, came,
    )  # fmt: skip
    complain(status)
    return Innovations(one, full, e, near.S, near.gains, near.kinks, near.turns, near=near, mixed=losses,
                       stem=likely_path(stood, came, row_of))  # fmt: skip


def drawn_evenly(rng: np.random.Generator, stops: int, noises: int, count: int) -> Values:
    """Return normal numbers for stems, (stops, stems, noises): at each stop one in each of as many equal parts."""
    parts = rng.permuted(np.broadcast_to(np.arange(count), (stops, noises, count)), axis=2)
    return np.asarray(ndtri((parts + rng.random(parts.shape)) / count)).swapaxes(1, 2).copy()


def _in_linear_loop(one: Hypothesis, values: Mapping[str, float], count: int) -> Innovations | None:
    """Return what a bank of stems leaves in a loop that is linear and scanned else; None in any other."""
    f, exact = one.frame, one.bare
    if exact is None or one.effect is None or not one.cheap:
        return None
    band, *jump = (one.settings(values)[f"{one.effect.block(one.place)}.{name}"] for name in one.own)
    try:
        params, sizes = one.stated_of(exact, values)
        loop = exact.scanned(params, sizes, cut=given(f.model, one.place))
    except NotAffine:
        return None
    again = np.full(f.anew.shape, -1)
    for c, unsure in enumerate(exact.scans.unsure):
        again[unsure, f.signals.index(exact.ops[c])] = c
    e, losses, path = left_by_stems(
        loop,
        exact.inputs(params),
        exact.scans.every,
        f.anew,
        np.median(f.r, axis=0),
        band,
        sum(jump),
        DRAWN * count,
        SEED,
        again,
    )
    at = np.clip(np.searchsorted(exact.scans.u[:, -2], f.stops[0] + EARLY) - 1, 0, len(path) - 1)
    nothing = np.zeros(len(e), dtype=np.bool_)
    return Innovations(one, values, e, np.where(np.isnan(e), np.nan, 1.0), None, nothing, np.zeros((0, 0)),
                       mixed=losses, stem=path[at])  # fmt: skip

"""A block as what it is between its limits: affine in its states, its inputs and the time.

    one scan later, or the rate    A x + B u + a_t t + a_0          outputs    C x + D u + c_t t + c_0

Differences are exact for such a block; one that is not says so, and has no filter.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from stickslip.blocks.block import Block
from stickslip.blocks.noise import seeded
from stickslip.blocks.role import Role
from stickslip.logs.arrays import Values

STEP = 1e-3  # of a state or an input
STRAIGHT = 1e-6  # by how much of what the step changes a block may bend
ROUNDED = 1e-13  # of the sizes that are summed: more cannot be told from rounding
NEARLY, TIMES = 1e-6, 7  # share of its terms by which a line may be missed; times at which it is asked
RANDOM = frozenset(seeded(0))


class NotAffine(ValueError):
    """A block is nonlinear, or at a limit, at the point of linearisation."""


@dataclass(frozen=True, eq=False)
class Affine:
    """``states`` that count; next states (or rates) and outputs, (rows, states + inputs + 2): columns x, u, t and 1."""

    states: tuple[str, ...]
    moved: Values
    given: Values


def affine(block: Block, u: Values) -> Affine:
    """Return a block near its start values and the inputs ``u``; without its dead time.

    Raises ``NotAffine`` for a block that bends there.
    """
    if block.kernels.n_events > 0 and block.role in (Role.ARITHMETIC, Role.PROCESS):
        raise NotAffine(f"'{block.name}' has kinks")
    return _affine(Alike(_at_once(block)), tuple(np.round(u, 9).tolist()))


def _at_once(block: Block) -> Block:
    """Return a block without its dead time."""
    late = block.dead_time_param and block.dead_time > 0.0
    return block.with_params(**{str(block.dead_time_param): 0.0}) if late else block


class Alike:
    """A block that is the same for a cache as one of its name, class, parameters and start values."""

    def __init__(self, block: Block) -> None:
        self.block = block
        self.key = type(block), block.name, block.p.tobytes(), block.x0.tobytes(), block.d0.tobytes()
        self.hashed = hash(self.key)

    def __hash__(self) -> int:
        return self.hashed

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Alike) and self.key == other.key


@lru_cache(maxsize=4096)
def _affine(alike: Alike, at: tuple[float, ...]) -> Affine:
    block, u = alike.block, np.array(at)
    names = block.seen_states()
    x = np.array(block.seen_start(), dtype=float)
    kept = [i for i, name in enumerate(names) if name not in RANDOM]

    def f(z: Values, t: float = 0.0) -> Values:
        full = x.copy()
        full[kept] = z[: len(kept)]
        rates = np.asarray(block.dynamics(t, full, z[len(kept) :]), dtype=float)
        return np.concatenate([rates[kept], np.asarray(block.output(t, full, z[len(kept) :]), dtype=float)])

    z = np.concatenate([x[kept], u])
    base = f(z)
    if not np.isfinite(base).all():
        raise NotAffine(f"'{block.name}' gives no number at the point of linearisation")
    slope, bend = np.empty((len(base), len(z))), np.empty((len(base), len(z)))
    for j in range(len(z)):
        up, down = z.copy(), z.copy()
        up[j] += STEP
        down[j] -= STEP
        rise, fall = f(up) - base, base - f(down)
        slope[:, j], bend[:, j] = (rise + fall) / (2.0 * STEP), np.abs(rise - fall)
    noise = ROUNDED * (np.abs(base) + np.abs(slope) @ (np.abs(z) + STEP))
    if np.any(bend > STRAIGHT * STEP * np.abs(slope) + noise[:, None]):
        raise NotAffine(f"'{block.name}' is not linear at the point of linearisation")
    for way in (1.0, -1.0):  # what is linear in each of two quantities alone may hold their product
        for j in range(1, len(z)):
            aside = np.where(np.arange(len(z)) <= j, STEP, 0.0)
            aside[j] *= way
            if np.any(np.abs(f(z + aside) - base - slope @ aside) > STRAIGHT * np.abs(slope) @ np.abs(aside) + noise):
                raise NotAffine(f"'{block.name}' multiplies what enters it or its states")
    in_time = f(z, 1.0) - base if block.kernels.timed else np.zeros(len(base))
    table = np.column_stack([slope, in_time, base - slope @ z])
    return Affine(tuple(names[i] for i in kept), table[: len(kept)], table[len(kept) :])


def straight_between(block: Block, middle: Values, ends: Sequence[Values], t: Values) -> None:
    """Raise ``NotAffine`` for a block that is not the same line at ``ends`` of what enters it as in the ``middle``, or
    not one in the time from the first to the last of ``t`` [s].
    """
    times = np.linspace(float(t[0]), float(t[-1]), TIMES).tolist() if block.kernels.timed else [0.0]
    if not _straight(Alike(_at_once(block)), tuple(tuple(u.tolist()) for u in (middle, *ends)), tuple(times)):
        raise NotAffine(f"'{block.name}' bends within what the log visits")


@lru_cache(maxsize=4096)
def _straight(alike: Alike, inputs: tuple[tuple[float, ...], ...], times: tuple[float, ...]) -> bool:
    """Return whether a block is the line that it is at the first of some ``inputs`` at all of them, at all times."""
    block = alike.block
    line, names = affine(block, np.array(inputs[0])), block.seen_states()
    x = np.array(block.seen_start(), dtype=float)
    kept = [names.index(s) for s in line.states]
    table = np.vstack([line.moved, line.given])
    asked = [(u, now) for u in map(np.array, inputs) for now in times]
    points = [np.concatenate([x[kept], u, [now, 1.0]]) for u, now in asked]
    # slopes are exact to rounding of the largest values, which is more than a line gives near zero
    size = np.max([np.abs(table * point).sum(axis=1) for point in points], axis=0)
    for (u, now), point in zip(asked, points, strict=True):
        rates = np.asarray(block.dynamics(now, x, u), dtype=float)[kept]
        found = np.concatenate([rates, np.asarray(block.output(now, x, u), dtype=float)])
        if np.any(np.abs(found - table @ point) > NEARLY * size + ROUNDED):
            return False
    return True

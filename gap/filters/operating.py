"""The points of linearisation of a diagram's blocks: usual values of all signals, controllers far beyond a limit."""

from collections.abc import Mapping, Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from stickslip.blocks.block import Block
from stickslip.blocks.role import Role
from stickslip.diagram.diagram import Diagram
from stickslip.gap.filters.affine import Affine, Alike, affine

Floats = NDArray[np.float64]
ONLOOKERS = (Role.HISTORIAN, Role.DETECTOR)
FAR = 50.0  # of OP's unit: how far beyond its limit a controller is looked at


def operating(
    diagram: Diagram, seen: Mapping[str, float], inputs: Sequence[str], controllers: Sequence[str]
) -> dict[str, float]:
    """Return the values of all signals at the point of linearisation: logged ones as seen, others as they follow.

    The errors of ``controllers`` are 0 there.
    """
    blocks = [b for b in diagram.blocks if b.role not in ONLOOKERS]
    found = {str(s): 0.0 for b in blocks for s in b.output_labels} | dict.fromkeys(inputs, 0.0) | dict(seen)
    for _ in range(len(blocks)):
        before = dict(found)
        for b in blocks:
            u = np.array([found.get(str(s), 0.0) for s in b.input_labels])
            out = np.asarray(b.output(0.0, b.seen_start(), u), dtype=float)
            found |= {str(s): float(y) for s, y in zip(b.output_labels, out, strict=True) if str(s) not in seen}
        if before == found:
            break
    for name in controllers:
        sp, pv = (str(diagram[name].loop_signal(part)) for part in ("SP", "PV"))
        found[pv] = found[sp]
    return found


def inside(block: Block, near: Mapping[str, float]) -> Block:
    """Return a controller with the memory that gives its usual output: a log may begin as if it were at a limit."""
    names = block.seen_states()
    if block.role is not Role.CONTROLLER or not block.sampled or not block.limit_params or not names:
        return block
    return block.starting_at(**{names[0]: near[str(block.output_labels[0])]})


def beyond_limit(block: Block, u: Floats, sign: float, push: float) -> Affine | None:
    """Return a controller far beyond its limit on one side, its error pushing upwards or downwards."""
    return _beyond(Alike(block), tuple(u.tolist()), sign, push)


@lru_cache(maxsize=256)
def _beyond(alike: Alike, here: tuple[float, ...], sign: float, push: float) -> Affine | None:
    block, u = alike.block, np.array(here)
    names = block.seen_states()
    if not block.sampled or not names:
        return None
    sp, pv = (list(block.input_labels).index(str(block.loop_signal(part))) for part in ("SP", "PV"))
    up, down = u.copy(), u.copy()
    up[sp], down[sp] = u[sp] + 0.01, u[sp] - 0.01
    x = np.asarray(block.seen_start(), dtype=float)
    way = 1.0 if block.output(0.0, x, up)[0] >= block.output(0.0, x, down)[0] else -1.0
    at = u.copy()
    at[sp] = at[pv] + way * push * 0.1
    return affine(block.starting_at(**{names[0]: sign * FAR}), at)

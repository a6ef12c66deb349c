"""A table among the parameters of a block: what its points must keep, and where a value lies between them.

See also: lookup_1d, lookup_2d, recorded.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from stickslip.blocks.block import Block, Floats
from stickslip.blocks.ports import BlockError, require


def passed(value: float, n: int, at: int, p: Any) -> int:
    """Return how many of the increasing points ``p[at]`` ... ``p[at + n - 1]`` lie at or below ``value``."""
    low = 0
    high = n
    while low < high:
        mid = (low + high) // 2
        if p[at + mid] <= value:
            low = mid + 1
        else:
            high = mid
    return low


def points(name: str, key: str, values: ArrayLike, least: int = 2) -> Floats:
    """Return the points of a table, shape (n,); raise ``BlockError`` unless they strictly increase and are finite."""
    found = np.asarray(values, dtype=float)
    rule = found.ndim == 1 and found.size >= least and bool(np.all(np.isfinite(found)))
    shown = found.tolist() if found.size <= 8 else f"{found.size} numbers"
    require(rule, name, key, shown, f"a table has {least} or more points, all finite", "correct the table")
    back = np.flatnonzero(np.diff(found) <= 0.0)
    if back.size:
        raise BlockError(
            f"{name}: {key}[{back[0]}] = {found[back[0]]} is followed by {found[back[0] + 1]}, but the points of a "
            "table must strictly increase; sort them and drop repeated ones"
        )
    return found


def same_size(block: Block, changes: Mapping[str, float], *keys: str) -> None:
    """Raise ``BlockError`` if a change of parameters would give the table of a block another size."""
    for key in keys:
        if key in changes:
            rule = changes[key] == block.p[block.param_index(key)]
            remedy = f"make another {type(block).__name__}"
            require(rule, block.name, key, changes[key], "it is the length of the table", remedy)

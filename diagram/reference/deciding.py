"""Which blocks decide at one instant what other blocks read then."""

from collections.abc import Sequence, Set

import numpy as np
from numpy.typing import NDArray
from stickslip.blocks.block import Block


def deciding(
    blocks: Sequence[Block], wires: Sequence[NDArray[np.intp]], places: Sequence[NDArray[np.intp]], dead: Set[int]
) -> NDArray[np.bool_]:
    """Return (blocks, blocks): whether what the first does at an instant changes what the second reads then.

    ``wires`` are the signals that each block reads, ``places`` those that it drives.  ``dead`` blocks have dead time.
    """
    n = len(blocks)
    above = np.zeros((n, n), dtype=bool)
    for b, read in enumerate(wires):
        for a, block in enumerate(blocks):
            at_once = a not in dead and (block.kernels.feeds or block.kernels.jumps)
            above[a, b] = at_once and bool(np.isin(places[a], read).any())
    for k in range(n):
        above |= np.outer(above[:, k], above[k])
    return above

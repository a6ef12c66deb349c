"""The signal that stands for the stem: MV where it is logged and moves, else PV, which only a flow loop allows."""

from typing import Literal

import numpy as np
from stickslip.detect.prepare.prepared import Grid
from stickslip.logs.arrays import Values


def stem_signal(grid: Grid) -> tuple[Literal["MV", "PV"], Values]:
    """Its name and values (n,) on the grid.

    >>> t = np.arange(3.0)
    >>> stem_signal(Grid(t, 1.0, t, t, t, None, None, 0.0))[0]
    'PV'
    """
    mv = grid.mv
    if mv is not None and np.all(np.isfinite(mv)) and np.ptp(mv) > 0.0:
        return "MV", mv
    return "PV", grid.pv

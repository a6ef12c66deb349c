"""The signal that stands for the stem: MV where it is logged and moves, else PV, which only a flow loop allows."""

from __future__ import annotations

from typing import Literal

import numpy as np
import numpy.typing as npt
from stickslip.detect.prepare.prepared import Grid

__all__ = ["stem_signal"]

Values = npt.NDArray[np.float64]


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

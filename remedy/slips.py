"""The bands of a stem from a likely path of it: where OP stood when it slipped, and where the stem came to rest.

    f_s = median |OP - x before|,   f_d = median |OP - x behind|,   r = their spread over f_s;   S, J = f_s +- f_d

With a large r the bank follows stems of other bands, so that bands and path settle in turns.  Who slips at a scan
broke away somewhere since the scan before: half of OP's move counts.
Source: expectation and maximisation with a drawn path (Celeux and Diebolt, Comput. Stat. Q. 2 (1985) 73-82).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from stickslip.logs.arrays import Values
from stickslip.logs.normal import spread
from stickslip.remedy.process import Day, Loop

__all__ = ["banded"]

FEWEST = 4  # slips


def banded(days: Sequence[Day], one: Loop, shown: Sequence[Values], least: float, most: float) -> Loop:
    """The loop with the bands that its likely path asks for, and r between ``least`` and ``most``."""
    before, behind = [], []
    for day, (x, _) in zip(days, shown, strict=True):
        u = day.op[: len(x)] - day.op[0]
        moved = np.flatnonzero(np.diff(x)) + 1
        moved = moved[moved > 1]
        if one.follows:
            moved = moved[x[moved - 1] == x[moved - 2]]
        way = np.sign(x[moved] - x[moved - 1])
        before.append(way * (0.5 * (u[moved] + u[moved - 1]) - x[moved - 1]))
        behind.append(way * (u[moved] - x[moved]))
    high, low = np.concatenate(before), np.concatenate(behind)
    f_s, f_d = (float(np.median(own)) if len(own) >= FEWEST else 0.0 for own in (high, low))
    if f_s <= 0.0:
        return one
    f_d = min(max(f_d, 0.0), f_s)
    off = spread(np.concatenate([high - f_s, low - f_d]))
    return replace(one, S=f_s + f_d, J=f_s - f_d, r=min(max(off / f_s, least), most))

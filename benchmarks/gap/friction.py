"""Friction of the benchmark's valves, and the S and J that their MV-OP figure shows.

The laws are not those of the diagnoser (``physics.rubbed``): a stem with mass and Stribeck friction after Karnopp, and
LuGre's bristles.  S and J are read off the figure of the stem alone under a slow triangle of OP: S is how far OP goes
back before the stem moves, J how far the stem then jumps.
"""

import numpy as np
from numpy.typing import NDArray

from benchmarks.gap.physics import KARNOPP, LUGRE, NAMES, NEUTRAL, rubbed

Floats = NDArray[np.float64]
SPEED = 0.002  # of OP in the figure [1/s]
SPRING = NEUTRAL["k"]


def with_friction(S: float, J: float, law: float) -> dict[str, float]:
    """Return the numbers of a stem meant to show S and J [fraction of OP]; ``figure`` says what it does show."""
    return {"friction": law, "F_c": SPRING * 0.5 * (S - J), "F_s": SPRING * 0.5 * (S + J)}


def figure(numbers: dict[str, float]) -> tuple[float, float]:
    """Return S and J [fraction of OP] read off the MV-OP figure of a stem with these numbers."""
    p = np.array([{**NEUTRAL, **numbers}[name] for name in NAMES])
    band = (numbers["F_s"] + numbers["F_c"]) / SPRING
    h = 0.005 if numbers["friction"] == KARNOPP else 0.01
    rise = np.arange(0.3, 0.3 + 6.0 * band, SPEED * h)
    OP = np.concatenate([rise, rise[::-1][: int(3.0 * band / (SPEED * h))]])
    stem = np.array([0.3, 0.0, 0.0])
    MV = np.empty(len(OP))
    for i, op in enumerate(OP):
        rubbed(op, stem, h, p)
        MV[i] = stem[0]
    down = len(rise)
    jump = MV[down - 1] - MV[down:]
    moved = np.flatnonzero(jump > 0.25 * (numbers["F_s"] - numbers["F_c"]) / SPRING)
    first = int(moved[0])
    S = float(OP[down] - OP[down + first])
    settled = min(first + int(0.5 / h), len(jump) - 1)  # the slip itself takes a few tenths of a second
    J = float(jump[settled] - (OP[down + first] - OP[down + settled]))
    return S, J


LAWS = (KARNOPP, LUGRE)

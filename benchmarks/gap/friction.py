"""Friction of the benchmark's valves, and the S and J that their MV-OP figure shows.

The laws are not those of the diagnoser (``physics.rubbed``): a stem with mass and Stribeck friction after Karnopp, and
LuGre's bristles.  S and J are read off the figure of the stem alone under a slow triangle of OP: the stem lags OP by
f_s when it breaks away and by f_c when it has slipped, S = f_s + f_c, J = f_s - f_c.
"""

import numpy as np

from benchmarks.gap.loop_numbers import KARNOPP, LUGRE, NAMES, NEUTRAL
from benchmarks.gap.physics import rubbed

SPEED = 0.001  # of OP in the figure [1/s]
STEP = 0.005  # [s]
SPRING = NEUTRAL["k"]
LAWS = (KARNOPP, LUGRE)
V_S = {KARNOPP: 1e-4, LUGRE: 5e-4}  # speed at which friction has fallen from F_s towards F_c [travel/s]


def with_friction(S: float, J: float, law: float) -> dict[str, float]:
    """Return the numbers of a stem meant to show S and J [fraction of OP]; ``figure`` says what it does show."""
    return {"friction": law, "F_c": SPRING * 0.5 * (S - J), "F_s": SPRING * 0.5 * (S + J), "v_s": V_S[law]}


def figure(numbers: dict[str, float]) -> tuple[float, float]:
    """Return S and J [fraction of OP] read off the MV-OP figure of a stem with these numbers."""
    p = np.array([{**NEUTRAL, **numbers}[name] for name in NAMES])
    band = (numbers["F_s"] + numbers["F_c"]) / SPRING
    rise = np.arange(0.3, 0.3 + 6.0 * band, SPEED * STEP)
    OP = np.concatenate([rise, rise[::-1][: int(3.0 * band / (SPEED * STEP))]])
    stem = np.array([0.3, 0.0, 0.0])
    MV = np.empty(len(OP))
    for i, op in enumerate(OP):
        rubbed(op, stem, STEP, p)
        MV[i] = stem[0]
    lag = (MV - OP)[len(rise) :]  # while OP falls: it grows while the stem sticks, and drops when it slips
    slip = int(np.argmax(lag < np.maximum.accumulate(lag) - 0.25 * (numbers["F_s"] - numbers["F_c"]) / SPRING))
    sticks = float(lag[: slip + 1].max())
    slides = float(lag[slip : slip + int(0.5 / STEP)].min())  # a slip takes a few tenths of a second
    return sticks + slides, sticks - slides

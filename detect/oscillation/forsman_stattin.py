"""Likeness of half periods, Forsman and Stattin 1999: does each resemble the one of the same sign before it?

    h = share of i with  alpha < A(i+2) / A(i) < 1 / alpha  and  gamma < d(i+2) / d(i) < 1 / gamma

A are the areas of |e| between zero crossings, d the lengths between them; alpha = 0.6, gamma = 0.75. Oscillating if
h > 0.4; above 0.8 it is very clear.

Source: Forsman and Stattin 1999, European Control Conference. Ours: a small band of hysteresis about zero, and ten half
periods at least.
"""

from dataclasses import dataclass, replace

import numpy as np
from stickslip.detect.oscillation.even import regularity
from stickslip.detect.oscillation.gate import GATE_CARD, Gate
from stickslip.detect.oscillation.lobes import lobes
from stickslip.logs import LoopRecord

CARD = replace(
    GATE_CARD,
    name="forsman_stattin", title="Likeness of half periods",
    source="Forsman and Stattin 1999, European Control Conference",
    assumes=("e is centred on zero",),
    finds="which share of the half periods resemble the one before them",
    index=(0.0, 1.0), cost="O(n)",
    pros=("unlike half waves above and below do no harm", "slow changes of period or amplitude pass"),
    cons=("noise adds crossings", "an offset or drift takes them away"),
)  # fmt: skip


@dataclass(frozen=True)
class Params:
    """Limits of the paper: alpha of areas, gamma of lengths, least h [-]; ``band`` in standard deviations."""

    alpha: float = 0.6
    gamma: float = 0.75
    h_min: float = 0.4
    band: float = 0.1
    half_periods: int = 10


def likeness(areas: np.ndarray, lengths: np.ndarray, alpha: float = 0.6, gamma: float = 0.75) -> float:
    """h [-] of areas (m,) and lengths (m,) of half periods in order of time; 0 for fewer than three.

    >>> likeness(np.array([1.0, 3.0, 1.1, 2.9]), np.array([5.0, 5.0, 5.0, 9.0]))
    0.5
    """
    if len(areas) < 3:
        return 0.0
    with np.errstate(divide="ignore", invalid="ignore"):
        area, length = areas[2:] / areas[:-2], lengths[2:] / lengths[:-2]
    alike = (area > alpha) & (area < 1.0 / alpha) & (length > gamma) & (length < 1.0 / gamma)
    return float(np.mean(alike))


def find(record: LoopRecord, p: Params = Params()) -> Gate:
    """Test the control error of the longest good stretch.

    >>> t = np.arange(0.0, 500.0)
    >>> gate = find(LoopRecord.from_arrays(t, pv=np.sin(2 * np.pi * t / 50), op=t))
    >>> gate.oscillating, round(gate.period)
    (True, 50)
    """
    found = lobes(record, p.band, p.half_periods)
    if isinstance(found, Gate):
        return found
    lengths, areas, dt, _, amplitude = found
    h, period = likeness(areas, lengths, p.alpha, p.gamma), 2.0 * float(np.median(lengths))
    oscillating = h > p.h_min and period >= 4.0 * dt
    reason = (
        f"{'Oscillating' if oscillating else 'Not oscillating'}: h = {h:.2f} (limit {p.h_min:g}) of {len(lengths)} "
        f"half periods resemble the one before them, period {period:.4g} s."
    )
    return Gate(oscillating, period, regularity(lengths), amplitude, len(lengths) / 2.0, reason)

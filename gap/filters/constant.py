"""Whether what an explanation says is the same along the whole record: in each stretch, level and direction of it.

    e . v / |v|      v = d g, less its projection on all d;  d the slope of the innovations in a parameter

g: 1 in a stretch, else 0; the level of a signal, the direction in which it moves, ...  Each figure is normal with mean
0 and standard deviation 1 if the explanation is right.
"""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray
from stickslip.gap.effects.scan_time import ScanTime
from stickslip.gap.filters.checks import CALM, known_of
from stickslip.gap.filters.filtering import Filtered
from stickslip.gap.filters.fitting import directions

Floats = NDArray[np.float64]
STRETCHES = 6
FRESH, FELT = 0.3, 1.0  # share of a direction that no parameter has already; its least length


def constancy(one: Filtered) -> dict[str, float]:
    """Return name -> figure of whether each parameter is constant; none where the filter has no slopes."""
    if one.explanation.sticks or isinstance(one.explanation.effect, ScanTime) or one.mixed is not None:
        return {}
    first = one.explanation.filtering.skipped
    slopes = {name: d[first:] for name, d in directions(one).items()}
    if not slopes:
        return {}
    e = np.clip(np.nan_to_num(one.judged), -CALM, CALM)
    return modulated(e, slopes, stretches(len(e)) | known_of(one))


def stretches(rows: int) -> dict[str, Floats]:
    """Return name -> 1 in one of six stretches of the record, else 0."""
    parts = np.array_split(np.arange(rows), STRETCHES)
    return {
        f"stretch {k + 1} of {STRETCHES}": np.isin(np.arange(rows), part).astype(np.float64)
        for k, part in enumerate(parts)
    }


def modulated(e: Floats, slopes: Mapping[str, Floats], known: Mapping[str, Floats]) -> dict[str, float]:
    """Return the figures of whether what each parameter does goes with anything ``known`` of the rows, by name.

    ``e`` and ``slopes`` (rows, signals), ``known`` (rows,).
    """
    basis, _ = np.linalg.qr(np.stack([d.ravel() for d in slopes.values()], axis=1))
    found = {}
    for what, g in known.items():
        scale = float(np.sqrt(np.mean(g**2)))
        if scale == 0.0:
            continue
        for name, d in slopes.items():
            v = (d * (g / scale)[:, None]).ravel()
            own = v - basis @ (basis.T @ v)
            length = float(np.sqrt(own @ own))
            if length > max(FRESH * float(np.sqrt(v @ v)), FELT):
                found[f"{name} with {what}"] = float(e.ravel() @ own) / length
    return found

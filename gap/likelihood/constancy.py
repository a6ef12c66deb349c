"""Whether what a hypothesis says is the same along the whole record: in each stretch, level and direction of it.

    e . v / |v|      v = d g, less its projection on all d;  d the slope of the innovations in a parameter

g: 1 in a stretch, else 0; the level of a signal, the direction in which it moves, ...  Each figure is normal with mean
0 and standard deviation 1 if the hypothesis is right.
"""

from collections.abc import Mapping

import numpy as np
from stickslip.gap.likelihood.checks import known_of
from stickslip.gap.likelihood.fit import Fit
from stickslip.gap.likelihood.scores import trusted
from stickslip.logs.arrays import Values

STRETCHES = 6
FRESH, FELT = 0.3, 1.0  # share of a direction that no parameter has already; its least length


def constancy(fit: Fit) -> list[tuple[str, Values]]:
    """Return name and direction, (rows, signals), of each change of a parameter that the record would show."""
    one, first = fit.hypothesis, fit.hypothesis.frame.skipped
    weight = trusted(fit)
    own = {n: d * weight for n, d in zip(fit.names, fit.slopes, strict=True) if n not in one.noise_keys}
    if not own or fit.best.mixed is not None:
        return []
    rows = len(fit.best.e) - first
    found = changes({n: d[first:] for n, d in own.items()}, stretches(rows) | known_of(fit.best))
    return [(name, np.concatenate([np.zeros((first, v.shape[1])), v])) for name, v in found.items()]


def stretches(rows: int) -> dict[str, Values]:
    """Return name -> 1 in one of six stretches of the record, else 0."""
    parts = np.array_split(np.arange(rows), STRETCHES)
    return {
        f"stretch {k + 1} of {STRETCHES}": np.isin(np.arange(rows), part).astype(np.float64)
        for k, part in enumerate(parts)
    }


def changes(slopes: Mapping[str, Values], known: Mapping[str, Values]) -> dict[str, Values]:
    """Return the directions, (rows, signals) of unit length, in which what each parameter does goes with anything
    ``known`` of the rows, (rows,), beside what all parameters do, ``slopes`` (rows, signals).
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
                found[f"{name} with {what}"] = (own / length).reshape(d.shape)
    return found

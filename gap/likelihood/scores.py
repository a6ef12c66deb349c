"""What a change of a model's innovations promises, in a score that far rows do not decide.

gain of a size  =  (e . d)^2 / (2 |d|^2)       d: what the size changes in the innovations, less its projection on
                                               what the free parameters of the model change
"""

import math

import numpy as np
from stickslip.gap.likelihood.fit import Fit
from stickslip.gap.likelihood.hypothesis import Innovations
from stickslip.logs.arrays import Values

AT_BOUND = 0.01  # share of a bound, within which a parameter stands at it
CALM = 4.0  # standard deviations from which on innovations count less


def at_bound(fit: Fit) -> tuple[str, ...]:
    """Return which noise or load wants to be larger or slower than every fit lets it, or smaller or faster."""
    one, values = fit.hypothesis, fit.best.values
    known = {name: (values[name], *one.bounds[name]) for name in sorted(one.noise_keys & values.keys())}
    return tuple(name for name, (now, low, high) in known.items() if min(now / low, high / now) < 1.0 + AT_BOUND)


def score(null: Fit, found: Innovations) -> tuple[float, Values, float] | None:
    """Return the gain that the score promises [nats], the direction of the change, and its length [standard
    deviations]; None where nothing is felt.
    """
    weight = trusted(null)
    with np.errstate(invalid="ignore"):  # in the variances of the model, whatever another filter has
        d = np.nan_to_num((found.missed - null.best.missed) / np.sqrt(null.best.S)) * weight
    for slope in basis(null):
        d = d - slope * float(np.sum(slope * d))
    with np.errstate(over="ignore"):  # gains of one model may drive another away
        length = float(np.linalg.norm(d))
    if not 1e-6 < length < math.inf:
        return None
    direction = d / length
    along = -float(np.sum(np.nan_to_num(null.best.e) * weight * direction))
    return 0.5 * max(along, 0.0) ** 2, direction, length


def trusted(fit: Fit) -> Values:
    """Return the weight of each innovation, (rows, signals): 1, less far from usual, 0 in rows that do not count.

    It is that of Student's law, so that the score of a model that is far from the log is not that of a few rows.
    """
    e = np.nan_to_num(fit.best.e)
    rows = fit.hypothesis.frame.counted
    return np.asarray(rows[:, None] * _less_far_from_usual(e))


def _less_far_from_usual(e: Values) -> Values:
    return np.asarray(1.0 / np.sqrt(1.0 + (e / CALM) ** 2))


def basis(fit: Fit) -> Values:
    """Return an orthonormal basis of what the free parameters of a fit change, (k, rows, signals)."""
    if not len(fit.slopes):
        return fit.slopes
    flat = (fit.slopes * trusted(fit)).reshape(len(fit.slopes), -1)
    flat = flat[np.sqrt(np.sum(flat**2, axis=1)) > 1e-3]
    q, _ = np.linalg.qr(flat.T)
    return np.asarray(q.T.reshape(-1, *fit.slopes.shape[1:]))

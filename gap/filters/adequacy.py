"""Whether an explanation of a filter is good enough to be named: its innovations, and its likeliest generic rival."""

from functools import lru_cache

import numpy as np
from stickslip.gap.effects.quantisation import Quantisation
from stickslip.gap.effects.sensor_noise import SensorNoise
from stickslip.gap.filters import laws
from stickslip.gap.filters.checks import checks
from stickslip.gap.filters.constant import constancy
from stickslip.gap.filters.digits import few_levels
from stickslip.gap.filters.filtering import Filtered
from stickslip.gap.filters.fitting import Found
from stickslip.gap.filters.rivals import Rival, beside, either_way, likeliest

LIMIT = 4.7  # largest check of an explanation that is right
LIMIT_STEMS = 9.0  # of a bank of stems, or of a stem that is slow, which are not exact
EXPLAINED = 0.97  # an explanation of so much of a gap may fail its checks a little: no law is exact
SMALL, LIMIT_LARGEST = 0.012, 25.0  # of the largest check of the model as it is: so much may be left then


@lru_cache(maxsize=16)
def worst(one: Filtered) -> tuple[str, float]:
    """Return the check that an explanation passes least, and by how much."""
    found = checks(one)
    if one.explanation.effect:
        found |= constancy(one) | beside(one) | either_way(one)
        if not isinstance(one.explanation.effect, Quantisation):
            found |= few_levels(one.explanation.filtering)
    name = max(found, key=lambda key: abs(found[key]))
    return name, abs(found[name])


def passes(one: Filtered) -> bool:
    """Return whether innovations are as they should be."""
    return worst(one)[1] <= _limit(one)


def _limit(one: Filtered) -> float:
    """Return the largest check of an explanation that may be right.

    Of a slow stem a filter knows mean and variance only, not what it has to do with the rest of the loop.
    """
    explanation = one.explanation
    return LIMIT_STEMS if explanation.sticks or explanation.law == laws.SLOW else LIMIT


@lru_cache(maxsize=16)
def rival(one: Filtered) -> Rival:
    """Return the likeliest generic rival of an explanation."""
    return likeliest(one)


def adequate(plain: Found, one: Found) -> bool:
    """Return whether an explanation passes its checks, or nearly does where it explains nearly all of a large gap.

    And no generic rival is likelier by more than chance makes it.
    """
    limit = _limit(one.best)
    if explained(plain, one) >= EXPLAINED and not isinstance(one.best.explanation.effect, SensorNoise):
        limit = max(limit, min(SMALL * worst(plain.best)[1], LIMIT_LARGEST))
    return worst(one.best)[1] <= limit and not rival(one.best).likelier


def explained(plain: Found, one: Found) -> float:
    """Return the share of the gap that an explanation explains, counted above the noise floor of its own filter."""
    removable = plain.nll - (white(one.best) if one.best.mixed is None else min(one.nll, plain.nll))
    return (plain.nll - one.nll) / removable if removable > 1.0 else 1.0


def white(one: Filtered) -> float:
    """Return the negative log likelihood that a filter would leave if its innovations were of unit variance."""
    return one.nll - 0.5 * float(np.nansum(one.judged**2 - 1.0))

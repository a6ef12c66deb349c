"""How a probability is said: no estimate from a finite number of loops is certain."""

from __future__ import annotations

__all__ = ["chance"]

CERTAIN = 0.995  # from here on rounding would say 100 %


def chance(probability: float | None) -> str:
    """Return a probability [-] in words: whole percent, but never 0 % or 100 %; a dash for none.

    >>> chance(0.123), chance(0.9971), chance(0.0004), chance(None)
    ('12 %', 'over 99 %', 'below 1 %', '-')
    """
    if probability is None:
        return "-"
    if probability >= CERTAIN:
        return "over 99 %"
    if probability < 1.0 - CERTAIN:
        return "below 1 %"
    return f"{100.0 * probability:.0f} %"

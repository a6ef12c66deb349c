"""Why the model says what it says: the kinds of evidence that moved its log odds most, in words with their numbers.

    weight of a kind of evidence = sum of the shares of its features in the log odds (``model.Model.shares``)

The kinds are the families of features.  What the record is like (sampling, noise) is no evidence, and is left out.
Where stiction is called the three kinds that speak most for it are said, where it is cleared those most against it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

__all__ = ["MOST", "grounds"]

MOST = 3  # reasons
Found = Mapping[str, float]


def grounds(found: Found, shares: Mapping[str, float], sticks: bool) -> tuple[str, ...]:
    """The reasons for a verdict, the weightiest first: up to ``MOST`` of the kinds that moved the log odds its way.

    ``found`` features by name [-]; ``shares`` of them in the log odds [-]; ``sticks`` what the verdict says.

    >>> said = grounds({"new_top_share": 0.5, "stand_share": 0.2}, {"new_top_share": 1.0, "stand_share": 2.0}, True)
    >>> [reason.split(",")[0].split(":")[0] for reason in said]
    ['PV stands while OP travels in 20 % of the time', 'PV moves in few large steps']
    """
    sign = 1.0 if sticks else -1.0
    weights = {
        kind: sign * math.fsum(share for name, share in shares.items() if name.startswith(starts))
        for kind, starts in KINDS.items()
    }
    first = sorted((kind for kind, weight in weights.items() if weight > 0.0), key=lambda kind: -weights[kind])
    return tuple(f"{kind(found, sticks)} (log odds {sign * weights[kind]:+.1f})." for kind in first[:MOST])


def _learnt(found: Found, sticks: bool) -> str:
    like = "with a sticky valve" if sticks else "whose valve does not stick"
    return f"PV laid along OP has the pattern of simulated loops {like}, by the learnt convolutions"


def _new(found: Found, sticks: bool) -> str:
    share = f"5 % of the samples hold {_percent(found, 'new_top_share')} of what is new in PV"
    return (
        f"PV moves in few large steps: {share}, as slips do"
        if sticks else f"PV has no slips of its own: {share}"
    )  # fmt: skip


def _play(found: Found, sticks: bool) -> str:
    ratio = found.get("play_ratio", math.nan)
    told = f"the error of PV predicted from OP is {ratio:.2f} times as large without a stick as with one"
    return f"{told}, and the same stick fits all parts of the record" if sticks else f"A stick predicts little: {told}"


def _stands(found: Found, sticks: bool) -> str:
    share = _percent(found, "stand_share")
    if sticks:
        return f"PV stands while OP travels in {share} of the time, and its steps are those of a valve that slips"
    return f"PV goes with OP: it stands while OP travels in {share} of the time"


def _shape(found: Found, sticks: bool) -> str:
    sine, triangle = (_percent(found, f"op_mean_{name}") for name in ("sine", "triangle"))
    misfit = f"OP's mean half wave misses a sine by {sine} and a triangle by {triangle}"
    return f"The half waves are those of a stick: {misfit}" if sticks else f"The half waves are not a stick's: {misfit}"


def _regular(found: Found, sticks: bool) -> str:
    peak, lag = found.get("op_acf_peak", math.nan), found.get("ccf_best", math.nan)
    told = f"OP repeats itself by {peak:.2f}, and the largest correlation of PV with OP is {lag:.2f}"
    return f"Rhythm and delay of PV behind OP are a stick's: {told}" if sticks else f"Rhythm and delay are not: {told}"


def _cycle(found: Found, sticks: bool) -> str:
    third = _percent(found, "fold_slope_h3")
    told = f"the third harmonic of PV's pace is {third} of the first, where a sine has none"
    return f"The mean cycle has corners: {told}" if sticks else f"The mean cycle has no corners of a stick: {told}"


def _percent(found: Found, name: str) -> str:
    value = found.get(name, math.nan)
    return f"{100.0 * value:.0f} %" if math.isfinite(value) else "an unknown share"


KINDS: Mapping[Callable[[Found, bool], str], tuple[str, ...]] = {
    _learnt: ("network_", "pattern_"),
    _new: ("arx_", "new_", "slip_"),
    _play: ("play_", "linear_"),
    _stands: ("stand_", "rho", "pv_step", "pv_wide", "pv_bend", "op_step", "op_wide", "op_bend_k"),
    _shape: tuple(f"{signal}_{part}" for signal in ("op", "e", "slope") for part in (
        "area", "bend", "exponential", "gain", "halves", "lateness", "length", "mean", "rough", "sine", "square", "top",
        "triangle")),
    _regular: ("ccf_", *(f"{signal}_{part}" for signal in ("op", "e") for part in (
        "acf", "entropy", "line", "h2", "h3", "c3"))),
    _cycle: ("fold_",),
}  # fmt: skip
"""What says each kind of evidence, and with what the names of its features start."""

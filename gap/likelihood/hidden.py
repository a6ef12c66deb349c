"""How large an effect may be without being seen in a record that has no gap, checked by putting it in.

What a first size changes in the innovations, |d| standard deviations in all, says from which size on ``needed`` nats
are gained:  size = neutral + (first - neutral) sqrt(2 needed) / |d|.  A size is said only if runs of the model with it
do gain as much; if they do not, twice that size is tried.
"""

import math
from collections.abc import Sequence
from dataclasses import replace

from stickslip.gap.answers.seen import Seen
from stickslip.gap.insertion.about import FactorAbout
from stickslip.gap.insertion.effect import Parameter
from stickslip.gap.likelihood.bank import left_by_bank
from stickslip.gap.likelihood.candidates import Candidate
from stickslip.gap.likelihood.fit import Fit, tried
from stickslip.gap.likelihood.hypothesis import Hypothesis
from stickslip.gap.likelihood.relevance import least, moved
from stickslip.gap.likelihood.scores import score
from stickslip.gap.likelihood.threads import in_threads
from stickslip.gap.null_model.null_model import without_gap

FEW = 6  # effects that are asked of a large diagram: each takes about ten seconds there
RUNS, DOUBLED = 2, 3  # with each size; times that a size is doubled
STEMS = 4  # of a bank, times eight
WIDTHS = (0.25, 0.5, 1.0, 2.0, 4.0, 8.0)  # [%] of plays that are tried
NEEDED, FIRST = 6.0, 0.02  # nats that make a gap, and share of a range that is tried, where the least size is asked
BEYOND, SLIGHT = 1.05, 1e-6  # of a size that moves as much as is relevant; share of a movement that is none
MOST = 0.8  # of the range of a size, beyond which nothing is said of it


def hidden(null: Fit, found: Sequence[Candidate], needed: float, seed: int) -> list[Seen]:
    """Return the sizes from which on effects would have shown, of those that have a single size.

    Of a large diagram, whose runs take long, only the likeliest few are asked.
    """

    def shown(one: Candidate) -> Seen | None:
        p, hypothesis = _only_size(one), one.hypothesis
        assert p is not None and hypothesis.effect is not None  # candidates are effects
        size = _of_play(null, hypothesis, p, needed, seed) if hypothesis.hides else _of(null, one, p, needed, seed)
        if size is None:
            return None
        return Seen(hypothesis.effect.name, hypothesis.place, p.name, size, p.unit, hypothesis.nominal[p.name])

    single = [one for one in _least_seen(found) if _only_size(one) is not None]
    asked = single if null.hypothesis.frame.record.filter is None else single[:FEW]
    return [size for size in in_threads(shown, asked) if size is not None]


def _least_seen(found: Sequence[Candidate]) -> list[Candidate]:
    """Return candidates without factors on all of a signal, if factors that leave its level are there: these show
    less.
    """
    each = [(one, (one.hypothesis.effect, one.hypothesis.place)) for one in found]
    about = {at for one, at in each if one.hypothesis.level and isinstance(one.hypothesis.effect, FactorAbout)}
    return [one for one, at in each if one.hypothesis.level == (at in about)]


def _only_size(one: Candidate) -> Parameter | None:
    """Return the parameter of an effect that has a single size with a slope, else None."""
    effect = one.hypothesis.effect
    assert effect is not None
    p, *more = (p for p in effect.parameters if not p.nuisance and p.name != effect.level)
    return None if more or not p.smooth else p


def _others(null: Fit, one: Candidate) -> dict[str, float]:
    """Return all values but the size: those of the model alone, and where the effect leaves the level."""
    effect = one.hypothesis.effect
    kept = {effect.level: one.values[effect.level]} if effect is not None and one.hypothesis.level else {}
    return {**null.best.values, **kept}


def least_shown(null: Fit, one: Hypothesis, p: Parameter, needed: float = NEEDED) -> float | None:
    """Return how far a size has to be from neutral to show, by what a small one changes; None: that says nothing."""
    nominal, (_, high) = one.nominal[p.name], one.bounds[p.name]
    if not (math.isfinite(nominal) and p.smooth) or one.hides:
        return None
    first = nominal + FIRST * (high - nominal)
    changed = tried(one, {**null.best.values, p.name: first}, null.best)
    scored = None if changed is None else score(null, changed)
    return None if scored is None else (first - nominal) * math.sqrt(2.0 * needed) / scored[2]


def _of(null: Fit, one: Candidate, p: Parameter, needed: float, seed: int) -> float | None:
    """Return the size that would have shown, None where none within its range does."""
    hypothesis = one.hypothesis
    nominal, first = hypothesis.nominal[p.name], one.values[p.name]
    low, high = hypothesis.bounds[p.name]
    if not (math.isfinite(nominal) and math.isfinite(first)) or first == nominal:
        return None
    others = _others(null, one)
    changed = tried(hypothesis, {**others, p.name: first}, null.best)
    scored = None if changed is None else score(null, changed)
    if scored is None:
        return None
    by = (first - nominal) * math.sqrt(2.0 * needed) / scored[2]
    for _ in range(DOUBLED):
        by = max(abs(by), low - nominal) if by > 0.0 else by
        values = {**others, p.name: nominal + by}
        by = _of_relevance(hypothesis, values, by, seed) if low <= nominal + by <= high else by
        if not low <= nominal + by <= high or abs(by) > MOST * max(high - nominal, nominal - low):
            return None
        values[p.name] = nominal + by
        if _shows(null, hypothesis, values, needed, seed):
            return nominal + abs(by)
        by *= 2.0
    return None


def _of_relevance(one: Hypothesis, values: dict[str, float], by: float, seed: int) -> float:
    """Return how far a size has to be from neutral to move a signal by what is relevant, at least ``by``."""
    share = moved(one, {**one.nominal, **values}, seed)
    relevant = least(one.frame)
    return by if share >= relevant else by * BEYOND * relevant / max(share, SLIGHT)


def _shows(null: Fit, one: Hypothesis, values: dict[str, float], needed: float, seed: int) -> bool:
    """Return whether runs with these values are likelier with them than without by as much as a gap needs."""
    f = one.frame
    for log in without_gap(one.model(values), f.record, RUNS, seed):
        run = replace(f, record=replace(f.record, log=log))
        apart = tried(null.hypothesis.of(run), null.best.values), tried(one.of(run), values)
        if apart[0] is None or apart[1] is None or apart[0].nll - apart[1].nll < needed:
            return False
    return True


def _of_play(null: Fit, one: Hypothesis, p: Parameter, needed: float, seed: int) -> float | None:
    """Return the width of a play that would have shown, of those that are tried."""
    f = one.frame
    if null.best.gains is not None:  # a bank across runs takes too long
        return None
    for width in WIDTHS:
        values = {**null.best.values, p.name: width}
        gained = []
        for log in without_gap(one.model({**one.nominal, **values}), f.record, RUNS, seed):
            run = one.of(replace(f, record=replace(f.record, log=log)))
            with_play, none = (left_by_bank(run, {**values, p.name: w}, null.best, STEMS) for w in (width, 1e-3))
            gained.append(none.nll - with_play.nll)
        if gained and min(gained) >= needed:
            return width
    return None

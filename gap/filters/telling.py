"""What a diagnosis by filters says: its report, in words first."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from stickslip.gap.answers.report import UNKNOWN, Cause, GapReport, Rank, Shrinkage, Size, Where, listed
from stickslip.gap.answers.sureness import OUTSIDE, Sureness
from stickslip.gap.effects.controller_limits import ControllerLimits
from stickslip.gap.filters.adequacy import explained, rival, worst
from stickslip.gap.filters.diagnosing import CLEAR, Outcome
from stickslip.gap.filters.explaining import STEPPED, free_names, total
from stickslip.gap.filters.filtering import Filtered
from stickslip.gap.filters.fitting import Found, refined
from stickslip.gap.filters.hysteresis import followed_on, left
from stickslip.gap.filters.limiting import reach
from stickslip.gap.filters.reading import Filtering
from stickslip.gap.insertion.effect import Effect
from stickslip.gap.records.given import SURE
from stickslip.gap.telling.causes import named_cause, said_of
from stickslip.gap.telling.nuisances import stated_wrongly
from stickslip.gap.telling.segment import abnormal_segment
from stickslip.gap.telling.sizes import SEEN, shrinkage_of_losses
from stickslip.gap.telling.structure import by_wiring
from stickslip.gap.telling.words import LISTED

Floats = NDArray[np.float64]
FELT = 3.6  # standard deviations of a size that a gap of 6.5 nats needs
STEM_SPREAD = {"S": 0.05, "J": 0.2, "width": 0.06}  # share by which sizes of a bank of stems are off (tuning records)
DIGITS_SPREAD = {"step": 0.01, "deviation": 0.15}
PRIOR_OF_UNKNOWN = f"Of all gaps {100.0 * OUTSIDE:.0f} % are taken to have a cause that is in no catalogue."


def told(outcome: Outcome, sureness: Sureness) -> GapReport:
    """Return the report of an outcome; ``sureness`` gives how often such answers are right."""
    if not outcome.gap:
        return _no_gap(outcome, sureness)
    return _named(outcome, sureness) if outcome.same else _unknown(outcome, sureness)


def _no_gap(o: Outcome, sureness: Sureness) -> GapReport:
    name, size = worst(o.plain.best)
    words = [
        "No gap of relevance: the model with its stated noise gives the same log "
        f"(the innovations of its filter are white; its largest check is {size:.1f} standard deviations, {name})."
    ]
    words += _limits(o)
    return _report(o, sureness, words, o.plain.best)


def _limits(o: Outcome) -> list[str]:
    """Return in words how large effects may be without being seen here."""
    said = [f"deadband at {one.place} of up to {one.hidden:.2g} % OP" for one in o.looked]
    for one in o.found:
        effect = one.best.explanation.effect
        if effect is None or not one.names:
            continue
        for p in effect.parameters:
            nominal = one.best.explanation.nominal[p.name]
            sd = one.sd.get(p.name, np.inf)
            if p.nuisance or not np.isfinite(sd) or len(effect.parameters) > 1 or not np.isfinite(nominal):
                continue
            reach = max(abs(one.best.values[p.name] - nominal), FELT * sd)
            low, high = one.best.explanation.bounds[p.name]
            if reach < 0.8 * max(high - nominal, nominal - low):
                change = f"{nominal:g} +- {reach:.2g}" if nominal else f"up to {reach:.2g}"
                unit = "" if p.unit == "-" else f" {p.unit}"
                said.append(f"{effect.name} at {one.best.explanation.place}, {p.name} {change}{unit}")
    told = "; ".join(said)
    return [f"Possible all the same, since smaller ones do not show in this record: {told}."] if said else []


def _unknown(o: Outcome, sureness: Sureness) -> GapReport:
    elsewhere = o.stem is not None and not o.stem.follows
    plain = o.plain.best
    near = (o.stem.place,) if o.stem and elsewhere else abnormal_segment(plain.explanation.filtering, plain.judged)
    best = o.found[0] if o.found else None
    place = best.best.explanation.place if best and best.best.explanation.place in near else near[0]
    words = [f"There is a gap, and nothing in the catalogue explains it: an unknown effect at {listed(near)}."]
    if best is not None:
        part = 100.0 * float(np.clip(explained(o.plain, best), 0.0, 1.0))
        effect = best.best.explanation.effect
        name, size = worst(best.best)
        other = rival(best.best)
        left = (
            f"its log likelihood is {-other.behind:.1f} lower than that of {other.name}, no effect of the catalogue"
            if other.likelier
            else f"it fails the check of {name}, by {size:.1f} standard deviations"
        )
        words.append(
            f"Nearest is {effect.name if effect else ''} at {best.best.explanation.place}, which explains {part:.0f} % "
            f"of it; {left}."
        )
    name, size = worst(o.plain.best)
    words.append(f"The model without an effect fails most in the check of {name}, by {size:.1f} standard deviations.")
    shares, sure = _shares(o), sureness.probability(o.evidence)
    where = Where(place, sure / len(near), near, {one: shares.get(one, 0.0) for one in near})
    return _report(o, sureness, words, o.best, where, (Cause(UNKNOWN, place, sure),), _ranking(o, 1.0 - sure))


def _named(o: Outcome, sureness: Sureness) -> GapReport:
    best = o.same[0]
    found = [named_cause([_whose(x) for x in o.same], _sizes(best))]
    if o.firsts:
        found.insert(0, named_cause([_whose(x) for x in o.firsts], _sizes_of_part(best)))
    places = tuple(dict.fromkeys(x.best.explanation.place for x in (*o.firsts, *o.same)))
    sure, shrunk = sureness.probability(o.evidence), held_out(o)
    words = said_of(found, places)
    part = 100.0 * float(np.clip(explained(o.plain, best), 0.0, 1.0))
    words.append(
        f"{'Together they explain' if o.firsts else 'It explains'} {part:.1f} % of the gap"
        + (f"; {shrunk}." if shrunk else ".")
    )
    if not o.textured and rival(best.best).behind < CLEAR:
        other = rival(best.best)
        less = other.behind
        how = (
            f"Nearly as well (log likelihood {less:.1f} lower)"
            if less > 0.0
            else f"As well (log likelihood {-less:.1f} higher)"
        )
        words.append(f"{how} the record is explained by {other.name}.")
    shares = _shares(o)
    where = Where(found[0].place, sure, places, {place: shares.get(place, 0.0) for place in places})
    causes = tuple(one.stated(sure) for one in found)
    return _report(o, sureness, words, best.best, where, causes, _ranking(o, sure), shrunk)


def _name(one: Found) -> str:
    effect = one.best.explanation.effect
    return effect.name if effect else ""


def _whose(one: Found) -> tuple[Effect, str]:
    """Return the effect of a fit and its place."""
    explanation = one.best.explanation
    assert explanation.effect is not None
    return explanation.effect, explanation.place


def _sizes_of_part(one: Found) -> dict[str, Size]:
    """Return the sizes of the effect that is part of the model."""
    part = one.best.explanation.filtering.given.part
    assert part is not None
    return part.sizes(one.best.values, one.sd)


def _sizes(one: Found) -> dict[str, Size]:
    """Return the sizes of an effect with intervals of 90 %."""
    explanation = one.best.explanation
    effect = explanation.effect
    found: dict[str, Size] = {}
    for p in effect.parameters if effect else ():
        value = float(one.best.values[p.name])
        if p.nuisance or not np.isfinite(value):
            continue
        if isinstance(effect, ControllerLimits):
            found[p.name] = Size(value, *reach(one.best, p.name), p.unit)
            continue
        spread = {**STEM_SPREAD, **DIGITS_SPREAD}.get(p.name)
        if spread is not None and (explanation.sticks or p.name in DIGITS_SPREAD):
            wide = SURE * spread * (value if p.name != "J" else one.best.values["S"] * 0.5)
        elif isinstance(effect, STEPPED):
            wide = 0.0
        else:
            wide = SURE * one.sd.get(p.name, np.inf)
        low, high = explanation.bounds.get(p.name, (p.low, p.high))
        found[p.name] = Size(value, max(value - wide, min(low, value)), min(value + wide, max(high, value)), p.unit)
    return found


def _shares(o: Outcome) -> dict[str, float]:
    """Return place -> share of the gap that the best effect there explains, the largest first."""
    found: dict[str, float] = {}
    first = explained(o.plain, o.firsts[0]) if o.firsts else 0.0
    for one, before in (*((one, 0.0) for one in o.firsts), *((one, first) for one in o.found)):
        place = one.best.explanation.place
        found[place] = max(found.get(place, 0.0), float(np.clip(explained(o.plain, one) - before, 0.0, 1.0)))
    return dict(sorted(found.items(), key=lambda x: -x[1]))


def _ranking(o: Outcome, sure: float) -> tuple[Rank, ...]:
    """Return explanations in order; those that cannot be told apart share the probability of the first."""
    if not o.found:
        return ()
    lag = np.array([total(one) - total(o.found[0]) for one in o.found])
    same = np.array([one in o.same for one in o.found])
    weight = np.where(same, 1.0, np.minimum(np.exp(-np.minimum(lag, 500.0) / 6.0), 0.5 if o.same else 1.0))
    weight = sure * weight / weight.sum()
    return tuple(
        Rank(_name(one), one.best.explanation.place, float(w))
        for one, w in zip(o.found[:LISTED], weight[:LISTED], strict=True)
    )


def held_out(o: Outcome) -> Shrinkage | None:
    """Return how far the gap shrinks behind the part of the record on which model and effect are fitted again."""
    best = o.same[0].best
    if best.explanation.effect is None or best.explanation.effect.of_log:
        return None
    f = best.explanation.filtering
    first = round(SEEN * len(f.Y))
    before = _ahead(o.plain.best, first)
    after = _ahead(best, first)
    return shrinkage_of_losses(before.losses, after.losses, after.e, first)


def _ahead(one: Filtered, first: int) -> Filtered:
    """Return what values that were fitted on the rows up to ``first`` leave of the whole record."""
    f = one.explanation.filtering
    explanation = replace(one.explanation, filtering=f.head(first))
    if explanation.sticks:
        near = Filtered(explanation, one.values, one.e, one.S, one.OP)
        return left(one.explanation, followed_on(near).values)
    fitted = refined(explanation.filtered(one.values), free_names(explanation), 5)
    return one.explanation.filtered(fitted.best.values)


def _report(
    o: Outcome,
    sureness: Sureness,
    words: Sequence[str],
    after: Filtered,
    where: Where | None = None,
    causes: tuple[Cause, ...] = (),
    ranks: tuple[Rank, ...] = (),
    shrunk: Shrinkage | None = None,
) -> GapReport:
    f = o.plain.best.explanation.filtering
    if o.stem is not None:
        way = "follows" if o.stem.follows else "does not follow"
        words = [*words, f"The logged stem {o.stem.signal} {way} the input of {o.stem.place}."]
    both = np.stack([o.plain.best.judged, after.judged])
    shown = {s: both[:, :, j] for j, s in enumerate(f.signals)}
    t = f.record.log.t[f.skipped :]
    given = after.explanation.filtering.given
    notes = (*_notes(f), *stated_wrongly(f.model, given.settings(after.values)), PRIOR_OF_UNKNOWN, str(sureness))
    return GapReport(bool(causes), where, causes, ranks, shrunk, tuple(words), notes, t, shown, f.model, o.evidence)


def _notes(f: Filtering) -> tuple[str, ...]:
    log, steps = f.record.log, np.sqrt(12.0 * f.r)
    rounded = [f"{s} rounded to {step:g}" for s, step in zip(f.signals, steps, strict=True) if step > 1e-9]
    free = [f"{key} {low:.4g} to {high:.4g}" for key, (low, high) in f.unsure.items()]
    return (
        f"Logged: {', '.join(log.names)}; {len(log)} rows, {log.dt:g} s apart, the model scans every {f.period:g} s"
        + (f"; {', '.join(rounded)}." if rounded else "."),
        "Noise and loads that the model states: " + "; ".join(map(str, f.noise)) + ".",
        *(["Known within tolerances only, and fitted: " + "; ".join(free) + "."] if free else []),
        "Innovations of a Kalman filter of the model, exact from scan to scan: loads are not measured.",
        by_wiring(f.quiet, log.names),
        *log.notes,
    )

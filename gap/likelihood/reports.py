"""What a diagnosis by one likelihood says: its report, in words first."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from stickslip.gap.answers.evidence import Evidence
from stickslip.gap.answers.hit_rates import OUTSIDE, HitRates
from stickslip.gap.answers.report import UNKNOWN, Cause, GapReport, Rank, Shrinkage, Size, Where, listed
from stickslip.gap.insertion.effect import Effect
from stickslip.gap.likelihood.explained import Outcome, needed
from stickslip.gap.likelihood.fit import Fit
from stickslip.gap.likelihood.held_out import held_out
from stickslip.gap.likelihood.hidden import hidden
from stickslip.gap.likelihood.judge import MOST_LEFT
from stickslip.gap.likelihood.relevance import least
from stickslip.gap.likelihood.replay import Replays
from stickslip.gap.likelihood.search import price
from stickslip.gap.likelihood.separating import next_test
from stickslip.gap.likelihood.swapping import swapped
from stickslip.gap.likelihood.unmeasured import said_of_rival
from stickslip.gap.records.given import sizes
from stickslip.gap.records.record import rounding
from stickslip.gap.reporting.causes import named_cause, said_of
from stickslip.gap.reporting.creep import about_creep, creeps, least_sizes
from stickslip.gap.reporting.nuisances import stated_wrongly
from stickslip.gap.reporting.segment import abnormal_segment
from stickslip.gap.reporting.structure import by_wiring

LISTED = 12  # explanations in the ranking
MOST_SAID = 1000  # standard deviations
SEVERAL = 0.99  # of the interval between two rows: scans that follow sooner are more than one a row
LEAST_DOUBT = 0.1  # of the limit: what leaves less than runs leave on average is not certain either


def report_for(o: Outcome, limits: bool = True, seed: int = 0, counted: HitRates | None = None) -> GapReport:
    """Return the report of an outcome; ``limits``: whether it says, without a gap, what would have shown; ``counted``
    how often such answers were right in runs of this model, if any were made.
    """
    report = _as_found(o, limits, seed)
    if counted is None or not counted.runs or not report.gap:
        return report
    assert report.evidence is not None
    sure = counted.probability(report.evidence)
    causes = tuple(replace(cause, probability=sure) for cause in report.causes)
    where = None if report.where is None else replace(report.where, probability=sure / _shared(report))
    return replace(report, causes=causes, where=where, notes=(*report.notes, str(counted)))


def _shared(report: GapReport) -> int:
    """Return among how many places an unknown effect is shared."""
    unknown = report.causes and report.causes[0].effect == UNKNOWN and report.where is not None
    return len(report.where.confidence_set) if unknown and report.where is not None else 1


def _as_found(o: Outcome, limits: bool, seed: int) -> GapReport:
    if not o.gap:
        words = [
            "No gap of relevance: the log is as the model with its nuisances would write it (the largest of its checks "
            f"is {deviations(o.alone.size)}, {o.alone.name}; {o.alone.limit:.1f} are usual)."
        ]
        if o.alone.limit > MOST_LEFT:
            words.append(
                f"Runs of the model itself leave up to {deviations(o.alone.limit)}: the filter loses its "
                "way near a kink, as a selector has one, so only a large gap shows."
            )
        relevant = least(o.null.hypothesis.frame)
        if o.fits and o.share < relevant:
            near = o.fits[0]
            words = [
                f"No gap of relevance: {near.hypothesis} would explain the log best, but it "
                f"moves no signal by more than {o.share:.2g} of its movement; less than {relevant:g} is no gap."
            ]
        would = hidden(o.null, o.candidates, needed(o.candidates), seed + 1) if limits else []
        if would:
            words.append(
                "Possible all the same, since smaller ones do not show in this record; what would have shown, as runs "
                f"with it say: {'; '.join(map(str, would))}."
            )
        return replace(_report(o, words, o.null), seen=tuple(would))
    return _named(o) if o.named else _unknown(o)


def _named(o: Outcome) -> GapReport:
    best = o.named[0]
    whose = [([_whose(fit) for fit in o.named], _sizes(best))]
    if o.firsts:
        part = best.hypothesis.frame.given.part
        sizes = _sizes(o.firsts[0]) if part is None else part.sizes(best.best.values, best.sd)
        whose.insert(0, ([_whose(fit) for fit in o.firsts], sizes))
    odd = isinstance(best.hypothesis.frame, Replays) and o.best is not None and o.best.unusual
    creeping = [odd and creeps(same[0][0], shown) for same, shown in whose]
    found = [
        named_cause(same, least_sizes(same[0][0], shown) if creep else shown)
        for (same, shown), creep in zip(whose, creeping, strict=True)
    ]
    places = tuple(dict.fromkeys(fit.hypothesis.place for fit in (*o.firsts, *o.named)))
    words = said_of(found, places)
    for one, (same, _), creep in zip(found, whose, creeping, strict=True):
        words += about_creep(same[0][0], one.sizes, creep)
    if any(one.others for one in found):
        further = next_test(best.hypothesis.frame, o.named)
        words.append(f"{further[0].upper()}{further[1:]}.")
    if o.textured:
        words.append("The digits of the log show it, which no other effect leaves.")
    else:
        assert o.best is not None
        words.append(_how_well(o, best))
    if o.textured:
        sure = HitRates().probability(Evidence("digits", o.null.nll - best.nll))
    else:
        shares = _posterior(o, o.fits)
        sure = float((1.0 - OUTSIDE * _doubt(o)) * sum(shares[fit] for fit in o.named))
    where = Where(found[0].place, sure, places, _by_place(o))
    causes = tuple(one.stated(sure) for one in found)
    if o.rival is not None and not o.textured:
        words.append(said_of_rival(o.rival, o.null.nll - price(best)))
    if isinstance(o.null.hypothesis.frame, Replays) and not o.firsts and not o.textured:
        swap = swapped(o.null.hypothesis.frame, found[0].place)
        words += [str(swap)] if swap is not None else []
    shrunk = None if o.textured else held_out(o.null, best)
    if shrunk is not None:
        words.append(f"{str(shrunk).capitalize()}.")
    return _report(o, words, best, where, causes, _ranking(o, sure), shrunk)


def deviations(size: float) -> str:
    """Return how unusual something is, in words; a log without noise has no scale that would tell more.

    >>> deviations(4.21), deviations(2.9e10)
    ('4.2 standard deviations', 'over 1,000 standard deviations')
    """
    return f"over {MOST_SAID:,} standard deviations" if size > MOST_SAID else f"{size:.1f} standard deviations"


def _how_well(o: Outcome, best: Fit) -> str:
    """Return in words how well the named effects fit the log."""
    assert o.best is not None
    them = "both" if o.firsts else "it"
    if o.best.limit > MOST_LEFT:
        fits = f"Runs of the model with {them} leave up to {deviations(o.best.limit)}: the fit is not tested"
    elif o.best.size <= o.best.limit:
        fits = f"With {them} the model fits the log as well as it fits its own runs"
    else:
        fits = (
            f"With {them} the model fits the log nearly as well as it fits its own runs; without, its largest figure "
            f"is {deviations(o.alone.size)}"
        )
    return (
        f"{fits} (largest figure: {o.best.name}, {deviations(o.best.size)}; the log is "
        f"{o.null.nll - best.nll:,.0f} nats likelier)."
    )


def _unknown(o: Outcome) -> GapReport:
    elsewhere = o.stem is not None and not o.stem.follows
    f = o.null.hypothesis.frame
    changing = f.changing if isinstance(f, Replays) else None
    several = 0.0 < f.scanned < SEVERAL * f.record.log.dt
    near = (o.stem.place,) if o.stem and elsewhere else abnormal_segment(f, o.null.best.judged, changing, several)
    best = o.fits[0] if o.fits else None
    place = best.hypothesis.place if best and best.hypothesis.place in near else near[0]
    words = [f"There is a gap, and nothing in the catalogue explains it: an unknown effect at {listed(near)}."]
    if best is not None and o.best is not None and best.nll < o.null.nll:
        words.append(
            f"Nearest is {best.hypothesis}, with which the log is {o.null.nll - best.nll:,.0f} "
            f"nats likelier, but it leaves {deviations(o.best.size)} in: {o.best.name}."
        )
    words.append(f"What the model alone leaves shows most in: {o.alone.name}, {deviations(o.alone.size)}.")
    if o.rival is not None:
        words.append(said_of_rival(o.rival))
        if o.rival.explains:
            place, near = o.rival.place, (o.rival.place, *(name for name in near if name != o.rival.place))
    sure = 1.0 - OUTSIDE
    where = Where(place, sure / len(near), near, _by_place(o))
    return _report(o, words, best or o.null, where, (Cause(UNKNOWN, place, sure),), _ranking(o, OUTSIDE))


def _doubt(o: Outcome) -> float:
    """Return how near the named effect comes to not being enough, from 0 to 1."""
    return min(1.0, max(LEAST_DOUBT, o.best.size / o.best.limit)) ** 2 if o.best else 1.0


def _name(fit: Fit) -> str:
    effect = fit.hypothesis.effect
    return effect.name if effect else ""


def _whose(fit: Fit) -> tuple[Effect, str]:
    """Return the effect of a fit and its place."""
    assert fit.hypothesis.effect is not None
    return fit.hypothesis.effect, fit.hypothesis.place


def _sizes(fit: Fit) -> dict[str, Size]:
    """Return the sizes of an effect with intervals of 90 %; a factor of what the model states is as unsure as that."""
    one, values, sd = fit.hypothesis, fit.best.values, dict(fit.sd)
    effect, base = one.effect, one.frame.given.base
    assert effect is not None
    own = {name: values[name] for name in one.own}
    shared = effect.settings(one.frame.model, one.place, **own).keys() & base.unsure.keys()
    for low, high in (base.unsure[key] for key in shared if "factor" in own):  # anywhere in it is as likely
        beside = own["factor"] * (high - low) / abs(high + low) / math.sqrt(3.0)
        sd["factor"] = math.hypot(sd.get("factor", 0.0), beside)
    return sizes(effect.parameters, values, sd, one.bounds)


def _posterior(o: Outcome, fits: Sequence[Fit]) -> dict[Fit, float]:
    """Return how probable each fit is among all, by Schwarz's criterion."""
    lag = np.array([min(price(fit) - price(fits[0]), 700.0) for fit in fits])
    weight = np.exp(-lag)
    return dict(zip(fits, (weight / weight.sum()).tolist(), strict=True))


def _by_place(o: Outcome) -> dict[str, float]:
    """Return place -> share of the gap that the best effect there explains, from 0 to 1, the largest first."""
    found: dict[str, float] = {}
    whole = max((o.null.nll - fit.nll for fit in o.fits), default=0.0)
    beside = o.firsts[0].nll if o.firsts else o.null.nll
    for fit, before in (*((fit, o.null.nll) for fit in o.firsts), *((fit, beside) for fit in o.fits)):
        part = float(np.clip((before - fit.nll) / whole, 0.0, 1.0)) if whole > 0.0 else 0.0
        found[fit.hypothesis.place] = max(found.get(fit.hypothesis.place, 0.0), part)
    return dict(sorted(found.items(), key=lambda x: -x[1]))


def _ranking(o: Outcome, sure: float) -> tuple[Rank, ...]:
    if not o.fits:
        return ()
    shares = _posterior(o, o.fits)
    first = tuple(Rank(_name(fit), fit.hypothesis.place, sure) for fit in o.firsts[:1])
    return first + tuple(Rank(_name(fit), fit.hypothesis.place, sure * shares[fit]) for fit in o.fits[:LISTED])


def _report(
    o: Outcome, words: Sequence[str], after: Fit, where: Where | None = None, causes: tuple[Cause, ...] = (),
    ranks: tuple[Rank, ...] = (), shrunk: Shrinkage | None = None,
) -> GapReport:  # fmt: skip
    f = o.null.hypothesis.frame
    if o.stem is not None:
        way = "follows" if o.stem.follows else "does not follow"
        words = [*words, f"The logged stem {o.stem.signal} {way} the input of {o.stem.place}."]
    both = np.stack([o.null.best.judged, after.best.judged])
    shown = {s: both[:, :, j] for j, s in enumerate(f.signals)}
    gained = max(o.null.nll - after.nll, 0.0)
    rests = "digits" if o.textured else "pair" if o.firsts else "white"
    kind = "none" if not o.gap else (rests if o.named else "unknown")
    evidence = Evidence(kind, gained)
    t, notes = f.record.log.t[f.skipped :], _notes(o, after)
    return GapReport(bool(causes), where, causes, ranks, shrunk, tuple(words), notes, t, shown, f.model, evidence)


def _notes(o: Outcome, after: Fit) -> tuple[str, ...]:
    f = o.null.hypothesis.frame
    log, known = f.record.log, {s: f.record.known(s) for s in f.signals}
    digits = [f"{s} rounded to {rounding(values):.3g}" if np.ptp(values) > 0.0 else f"{s} constant"
              for s, values in known.items() if np.ptp(values) == 0.0 or rounding(values) > 0.0]  # fmt: skip
    free = [f"{key} {low:.4g} to {high:.4g}" for key, (low, high) in f.given.unsure.items()]
    exactly = o.null.best.gains is None
    return (
        f"Logged: {', '.join(log.names)}; {len(log)} rows, {log.dt:g} s apart; {', '.join(digits) or 'not rounded'}.",
        f"Nuisances of the model: {'; '.join(map(str, f.noise)) or 'none'}.",
        *stated_wrongly(f.model, after.best.values),
        *(["Known within tolerances only, and fitted: " + "; ".join(free) + "."] if free else []),
        _way(f)
        if isinstance(f, Replays)
        else "Innovations of a Kalman filter of the model, exact from row to row."
        if exactly
        else "Innovations of an extended Kalman filter whose prediction is the run of the model itself.",
        by_wiring(f.quiet, log.names),
        *log.notes,
    )


def _way(frame: Replays) -> str:
    """Return in a sentence what the residuals of a replay are."""
    if frame.null_model.coloured:
        return "Residuals of a pinned replay, less what earlier ones foretell: loads are not measured."
    return "Residuals of a pinned replay: with the stated noise they are white."

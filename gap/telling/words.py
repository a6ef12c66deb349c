"""What a diagnosis says: its report, in words first."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from stickslip.blocks.role import Role
from stickslip.gap.answers.evidence import Evidence
from stickslip.gap.answers.report import UNKNOWN, Cause, GapReport, Rank, Shrinkage, Size, Where, listed
from stickslip.gap.explanations.isolability import classes
from stickslip.gap.explanations.pair import Pair
from stickslip.gap.explanations.unmeasured import UnmeasuredLoad
from stickslip.gap.fits.adequacy import EXPLAINED, EXPLAINED_HIDDEN, needed, proven, scored_alone, share
from stickslip.gap.fits.noise import is_noise
from stickslip.gap.fits.search import Candidate, Fit, best_of, refined
from stickslip.gap.fits.sensitivity import seen
from stickslip.gap.floors.floor import losses
from stickslip.gap.floors.problem import Problem
from stickslip.gap.records.model import nuisances
from stickslip.gap.telling.creep import about_creep, coarse, creeps, least_sizes
from stickslip.gap.telling.residual_shape import shape
from stickslip.gap.telling.segment import NO_PLACE
from stickslip.gap.telling.separating import staircase_separates, tags
from stickslip.gap.telling.sizes import SEEN, shares, shrinkage, sizes
from stickslip.gap.telling.structure import by_wiring
from stickslip.gap.telling.swapping import swapped

Floats = NDArray[np.float64]
TIE = 6.0  # nats between explanations that the record does not separate
ABNORMAL = 0.05  # share by which the loss of a signal exceeds the usual one where its segment is wrong
BOTH = 0.03  # share of the gap that two effects explain beyond what one must, where none of them is a stem
LISTED = 12  # explanations in the ranking


def no_gap(problem: Problem, legal: Sequence[Candidate]) -> GapReport:
    """Return the report of a record that the model explains, with the sizes of effects that would have shown."""
    least = seen(legal, needed(problem))
    words = [
        "No gap of relevance: the model with its stated noise gives the same log "
        f"(score {problem.score:.0f}; runs without a gap: {problem.level:.0f} on average, {problem.limit:.0f} at most)."
    ]
    if least:
        words.append(f"This record would have shown these effects from these sizes on: {', '.join(map(str, least))}.")
    blind = sorted({one.effect.name for one in legal if one.effect} - {one.effect for one in least})
    if blind:
        words.append(f"It cannot show these effects, or only in the last digits: {', '.join(blind)}.")
    same = ["; ".join(f"{c.effect.name} at {c.place}" for c in group if c.effect) for group in classes(legal)]
    if same:
        words.append(f"These signals cannot separate small effects of one group: {' | '.join(same)}.")
    rests = Evidence("none", problem.score - problem.level)
    return replace(_report(problem, words, problem.as_it_is, rests=rests), seen=least)


def unknown(problem: Problem, fits: Sequence[Fit], rival: UnmeasuredLoad | None = None) -> GapReport:
    """Return the report of a gap that nothing in the catalogue explains: its segment, and what comes nearest.

    ``rival``: the load that nobody measures which suits the record best.
    """
    best = fits[0] if fits else None
    near = abnormal_segment(problem)
    place = best.place if best is not None and best.place in near else near[0]
    if rival is not None and rival.explains:
        place, near = rival.place, (rival.place, *(name for name in near if name != rival.place))
    words = [f"There is a gap, and nothing in the catalogue explains it: an unknown effect at {listed(near)}."]
    if best is not None:
        part = 100.0 * share(problem, best)
        words.append(f"Nearest is {best.effect.name} at {best.place}, which explains {part:.0f} % of it.")
    words += shape(problem) + disturbance_only(problem, rival)
    explained = shares(fits, problem.score, problem.level)
    rests = evidence(problem, "unknown", fits[:1], fits)
    sure = problem.sureness.probability(rests)
    where = Where(place, sure / len(near) if near else sure, near, {name: explained.get(name, 0.0) for name in near})
    return _report(
        problem, words, best.e if best else problem.as_it_is, where, (Cause(UNKNOWN, place, sure),),
        ranking(fits, [], 1.0 - sure), None, rests,
    )  # fmt: skip


def named(
    problem: Problem,
    same: Sequence[Fit],
    fits: Sequence[Fit],
    kind: str = "complete",
    rival: UnmeasuredLoad | None = None,
) -> GapReport:
    """Return the report of a gap with one cause; ``same`` are the fits that the log cannot separate, the best first.

    ``rival``: the load that nobody measures which suits the record best.
    """
    best = same[0]
    places = tuple(dict.fromkeys(fit.place for fit in same))
    others = tuple(dict.fromkeys(fit.effect.name for fit in same if fit.effect.name != best.effect.name))
    found = found_sizes(best)
    creeping = kind == "adequate" and creeps(best.effect, found)
    found = least_sizes(best.effect, found) if creeping else found
    explained = shares(fits, problem.score, problem.level)
    shrunk = held_out(problem, [best])
    words = [f"There is a gap. Place: {listed(places)}. Cause: {best.effect.name} at {best.place}, {_sizes(found)}."]
    if creeping or coarse(problem.model, problem.record):
        words += about_creep(best.effect, found, creeping)
    if others:
        words.append(f"These signals cannot separate it from {listed(others)}; {next_test(problem, same)}.")
    words.append(f"It explains {_share(problem, best)} of the gap" + _shrunk(shrunk))
    words += disturbance_only(problem, rival, best.total)
    swap = swapped(problem, best.place)
    if swap is not None:
        words.append(str(swap))
    rests = evidence(problem, kind, same, fits)
    sure = problem.sureness.probability(rests)
    cause = Cause(best.effect.name, best.place, sure, others, found)
    where = Where(best.place, sure, places, {name: explained.get(name, 0.0) for name in places})
    return _report(problem, words, best.e, where, (cause,), ranking(fits, same, sure), shrunk, rests)


def named_pair(
    problem: Problem,
    pair: Pair,
    same: tuple[Sequence[Fit], Sequence[Fit]],
    fits: Sequence[Fit],
    rival: UnmeasuredLoad | None = None,
) -> GapReport:
    """Return the report of a gap with two causes; ``same`` what each could be as well, given the other.

    ``rival``: the load that nobody measures which suits the record best.
    """
    both = (pair.first, pair.second)
    others = [
        tuple(dict.fromkeys(one.effect.name for one in also if one.effect is not also[0].effect)) for also in same
    ]
    rests = Evidence(
        _kind(problem, "pair"), problem.score - problem.level, share(problem, pair.second), fits[0].total - pair.total
    )
    sure = problem.sureness.probability(rests)
    whole = scored_alone(pair.second) <= problem.limit + needed(problem)
    found = [found_sizes(fit) for fit in both]
    creeping = [not whole and creeps(fit.effect, its) for fit, its in zip(both, found, strict=True)]
    found = [least_sizes(fit.effect, its) if yes else its for fit, its, yes in zip(both, found, creeping, strict=True)]
    causes = tuple(
        Cause(fit.effect.name, fit.place, sure, other, its) for fit, other, its in zip(both, others, found, strict=True)
    )
    places = tuple(dict.fromkeys(fit.place for also in same for fit in also))
    explained = shares(fits, problem.score, problem.level)
    shrunk = held_out(problem, both)
    words = ["There is a gap with two causes."]
    words += [
        f"{cause.effect} at {cause.place}, {_sizes(cause.parameters)}"
        + (f" (or {listed(cause.ambiguous_with)})." if cause.ambiguous_with else ".")
        for cause in causes
    ]
    for fit, its, yes in zip(both, found, creeping, strict=True):
        words += about_creep(fit.effect, its, yes) if yes else []
    words.append(f"Together they explain {_share(problem, pair.second)} of the gap" + _shrunk(shrunk))
    words += disturbance_only(problem, rival, pair.total)
    where = Where(both[0].place, sure, places, {name: explained.get(name, 0.0) for name in places})
    return _report(problem, words, pair.second.e, where, causes, ranking(fits, [], sure), shrunk, rests)


def disturbance_only(problem: Problem, rival: UnmeasuredLoad | None, total: float | None = None) -> list[str]:
    """Return in words how the rival of every effect does, a load that nobody measures.

    ``total`` score and price [nats] of what is named, None if nothing is.
    """
    if rival is None:
        return []
    if total is not None:
        more, close = rival.F - total, rival.explains and rival.F - total <= needed(problem)
        if close:
            return [
                f"A disturbance alone may explain it: {rival}, leaves nothing; its log likelihood is {more:.0f} lower."
            ]
        return [f"A disturbance alone is excluded: {rival}, has a log likelihood that is {more:.0f} lower."]
    if rival.explains:
        return [f"A disturbance alone may explain it: {rival}, leaves nothing of the gap."]
    part = float(np.clip((problem.score - rival.left) / max(problem.score - problem.level, 1e-9), 0.0, 1.0))
    return [
        f"A disturbance alone does not explain it: the best, {rival}, leaves {100.0 * (1.0 - part):.1f} % of the gap."
    ]


def next_test(problem: Problem, same: Sequence[Fit]) -> str:
    """Return in words which tag or which move of the set point would separate some effects."""
    found = tags(problem, same)
    if found:
        return f"a log of {listed(found[:3])} would separate them"
    for k in range(2, len(same)):  # not all of them, but some
        found = tags(problem, same[:k])
        if found:
            return f"a log of {listed(found[:3])} would separate some of them"
    if staircase_separates(problem, same):
        return "steps of the set point over a wider range would separate them"
    return "neither another signal of the model nor a wider range of the set point would separate them"


def evidence(problem: Problem, kind: str, same: Sequence[Fit], fits: Sequence[Fit]) -> Evidence:
    """Return what a name rests on; ``same`` the fits that it stands for, the best first."""
    others = [fit.total for fit in fits if fit not in same]
    margin = min(others) - same[0].total if others and same else 0.0
    return Evidence(
        _kind(problem, kind), problem.score - problem.level, share(problem, same[0]) if same else 0.0, margin
    )


def _kind(problem: Problem, kind: str) -> str:
    """Return the kind of an answer: a name that rests on the segments of a large diagram is of its own kind."""
    return kind if problem.record.filter is None else f"segments, {kind}"


def tied(fits: Sequence[Fit]) -> list[Fit]:
    """Return the fits that the record does not separate from the best one, which comes first.

    Equal scores and equally many parameters that the record feels: a step before the first row is a bias.
    """
    best = fits[0]
    return [fit for fit in fits if fit.F <= best.F + TIE and abs(fit.total - best.total) <= TIE]


def adequate_pair(problem: Problem, pair: Pair, best: Fit) -> bool:
    """Return whether two effects explain the gap, which the best single one does not."""
    if pair.second.candidate.noisy and not is_noise(pair.second):
        return False
    left = scored_alone(pair.second)
    hidden = pair.first.effect.hidden or pair.second.effect.hidden
    enough = EXPLAINED_HIDDEN if hidden else EXPLAINED + BOTH
    return left <= problem.limit + needed(problem) or (
        share(problem, pair.second) >= enough
        and share(problem, best) < EXPLAINED
        and proven(problem, pair.first)
        and proven(problem, pair.second)
    )


def found_sizes(fit: Fit) -> dict[str, Size]:
    """Return the sizes of an effect with intervals; one of the historian has none."""
    if fit.effect.of_log:
        return {p.name: Size(v, 0.9 * v, 1.1 * v, p.unit) for p in fit.effect.parameters for v in [fit.values[p.name]]}
    return sizes(fit)


def held_out(problem: Problem, fits: Sequence[Fit]) -> Shrinkage | None:
    """Return how far the gap shrinks behind the part of the record on which the last effect is fitted again."""
    fit = fits[-1]
    if fit.effect.of_log:
        return None
    candidate = fit.candidate
    head = replace(candidate.problem, record=problem.record.first_part(SEEN))
    again = best_of(replace(candidate, problem=head).tried([fit.values]))
    if again is not None and not fit.effect.hidden:
        again = refined(again, rounds=3)
    after = candidate.tried([again.values if again else fit.values])[0].e
    first = len(head.record.log) - problem.floor.skipped
    return shrinkage(problem.as_it_is, after, problem.floor.mean / len(problem.record.pinned), first)


def abnormal_segment(problem: Problem) -> tuple[str, ...]:
    """Return the blocks between logged signals where the gap lies, those at which an effect can be.

    The level of a measurement is wrong only if what drives it is, and so is a stem, which is held to the OP of each
    row; the change of a controller's output also feels how its measurement has moved since the last row.  So signals
    that keep their level, and stems, come first.
    """
    floor, e = problem.floor, problem.as_it_is
    usual = max(floor.mean / e.shape[1], float(np.finfo(float).tiny))
    shown = [e[np.isfinite(e[:, k]), k] for k in range(e.shape[1])]
    excess = np.array([float(losses(one).mean()) / usual - 1.0 if len(one) else -np.inf for one in shown])
    drivers = [problem.quiet.blocks[problem.quiet.driven[s][0]] for s in problem.record.pinned]
    levels = np.where(floor.changes & [one.role is not Role.VALVE for one in drivers], -np.inf, excess)
    k = int(np.argmax(levels if levels.max() > ABNORMAL else excess))
    driver = drivers[k].name
    logged = [s for s in problem.record.log.names if s in problem.quiet.signals]
    blocks = next(one.blocks for one in problem.quiet.segments(logged) if driver in one.blocks)
    places = tuple(name for name in blocks if problem.quiet[name].role not in NO_PLACE and ":" not in name)
    return places or (driver,)


def ranking(fits: Sequence[Fit], same: Sequence[Fit], sure: float) -> tuple[Rank, ...]:
    """Return the explanations in order; those that the log cannot separate share the probability of the first."""
    if not fits:
        return ()
    weight = np.exp(-np.minimum(np.array([fit.total - fits[0].total for fit in fits]) / 20.0, 50.0))
    top = [fit in same for fit in fits]
    weight = np.where(top, 1.0, np.minimum(weight, 0.5)) if same else weight
    return tuple(
        Rank(fit.effect.name, fit.place, float(w))
        for fit, w in zip(fits[:LISTED], (sure * weight / weight.sum())[:LISTED], strict=True)
    )


def _sizes(found: Mapping[str, Size]) -> str:
    return ", ".join(f"{name} {s.value:.4g} {s.unit} ({s.low:.4g} to {s.high:.4g})" for name, s in found.items())


def _share(problem: Problem, fit: Fit) -> str:
    """Return in words how much of the gap a fit explains: what it leaves may be less than usual."""
    return f"{100.0 * min(share(problem, fit), 1.0):.1f} %"


def _shrunk(found: Shrinkage | None) -> str:
    return "." if found is None else f"; {found}."


def _report(
    problem: Problem,
    words: Sequence[str],
    after: Floats,
    where: Where | None = None,
    causes: tuple[Cause, ...] = (),
    ranks: tuple[Rank, ...] = (),
    shrunk: Shrinkage | None = None,
    rests: Evidence | None = None,
) -> GapReport:
    both = np.stack([problem.as_it_is, after])
    shown = {s: both[:, :, k] for k, s in enumerate(problem.record.pinned)}
    t = problem.record.log.t[problem.floor.skipped :]
    return GapReport(
        bool(causes), where, causes, ranks, shrunk, tuple(words), notes(problem), t, shown, problem.model, rests
    )


def notes(problem: Problem) -> tuple[str, ...]:
    """Return what was read off the log and assumed of the model."""
    record = problem.record
    told = [f"{s} rounded to {step:g}" for s, step in record.steps.items() if step]
    told += [f"{s} in multiples of {record.lattice(s):g} that the controller sees too" for s in record.lattices]
    found = nuisances(problem.model)
    way = (
        "Residuals of a pinned replay, minus their prediction from earlier ones as in a Kalman filter: "
        "loads are not measured."
        if problem.floor.coloured
        else "Residuals of a pinned replay: with the stated noise they are white."
    )
    return (
        f"Logged: {', '.join(record.log.names)}; {len(record.log)} rows, {record.log.dt:g} s apart"
        + (f"; {', '.join(told)}." if told else "."),
        "Noise and loads that the model states: " + ("; ".join(map(str, found)) if found else "none") + ".",
        way,
        by_wiring(problem.quiet, record.log.names),
        *record.log.notes,
        str(problem.sureness),
    )

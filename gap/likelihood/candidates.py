"""A first size of every effect: by its score near the model, by a race of filters far from it.

Near the model each size costs one run with the gains of the model's own filter, or with gains of its own where an
effect adds a state.  Far from it these gains say nothing, so each effect is fitted to a first part of the record.
"""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from stickslip.blocks.role import Role
from stickslip.diagram.progress import Progress
from stickslip.gap.fits.loads import is_load
from stickslip.gap.likelihood.fit import Fit, all_at_once, refined, tried
from stickslip.gap.likelihood.frame import Frame
from stickslip.gap.likelihood.hypothesis import FAR, Hypothesis, Innovations
from stickslip.gap.likelihood.scores import score
from stickslip.gap.likelihood.settling import free_names
from stickslip.gap.likelihood.sizes import sizes
from stickslip.gap.likelihood.switches import most_by_switches, with_switches
from stickslip.gap.likelihood.threads import in_threads
from stickslip.logs.arrays import Values

CLOSE = 1.0  # nats of scores between which the likelier size counts
RACED, PART = 500, 0.2  # rows of a race, at least, and the share of what the model alone leaves that they hold
SWITCHED = 8  # limits of a controller that are looked at with switches of their own
UNMOVED = 1e-6  # standard deviations to which an innovation is the same
SPRINT = 3  # rounds of a fit there
FIRST_SHARE, SHARE = 0.03, 0.15  # of the best gain, from which on first sizes and later ones go on
FAINTER = 0.1  # of the best gain, that an effect has to have to be fitted
WIDER, NARROWER = 1.3, 1.03  # factors by which a size is changed there, first and last
FIRST_RUNS = 300_000  # for slopes of a first look: a far size may bend a loop at every stop, and tell nothing


@dataclass(frozen=True, eq=False)
class Candidate:
    """The best first ``values`` of a ``hypothesis`` and the ``gain`` that they promise [nats].

    ``direction`` (rows, signals), of unit length, is what they change with the gains of the model; None where these
    gains do not hold.
    """

    hypothesis: Hypothesis
    values: Mapping[str, float]
    gain: float
    direction: Values | None

    def __str__(self) -> str:
        return str(self.hypothesis)

    @property
    def races(self) -> bool:
        """Whether first rows say how well it does: a load may begin behind them, a limit may be met there, and a stem
        has a bank of its own.
        """
        return _races(self.hypothesis)


def by_score(null: Fit, hypotheses: Sequence[Hypothesis], progress: Progress = None) -> list[Candidate]:
    """Return the best first size of every hypothesis that the record feels, the highest score first."""
    return _each(hypotheses, lambda one: _scored(null, one), progress)


def by_race(null: Fit, rough: Fit, hypotheses: Sequence[Hypothesis], progress: Progress = None) -> list[Candidate]:
    """Return sizes of every hypothesis that are fitted to first rows, each with filters of its own, the best first.

    The gains of a model that is far from the log say nothing of other models.  One of which no first size is likelier
    than the model as it is stated goes no further.
    """
    short = first_rows(null)
    start = tried(Hypothesis(short), null.best.values)
    if start is None:
        return by_score(rough, hypotheses, progress)
    alone = refined(with_switches(start), tuple(short.free), SPRINT)
    still = tried(Hypothesis(replace(short, apart=True)), short.stated)
    whole = null.hypothesis.frame  # a limit is met behind a switch
    racing = [one for one in hypotheses if _races(one)]
    others = [one for one in hypotheses if not _races(one)]
    raced = _raced(short, still, rough, racing, progress)
    found = [_as_candidate(alone, still, rough, one, best) for one, best in raced.items()]
    least = FAINTER * max((one.gain for one in found), default=0.0)

    def look(one: Hypothesis) -> Candidate | None:
        return _at_limits(null, one.of(whole), least) if one.bends else _tried(rough, one)

    return _ranked(found + _each(others, look, progress))


def _each(
    hypotheses: Sequence[Hypothesis], look: Callable[[Hypothesis], Candidate | None], progress: Progress
) -> list[Candidate]:
    found = in_threads(look, hypotheses, progress, "effects")
    return _ranked(best for best in found if best is not None)


def _ranked(found: Iterable[Candidate]) -> list[Candidate]:
    return sorted(found, key=lambda c: -c.gain)


def _scored(null: Fit, one: Hypothesis) -> Candidate | None:
    """Return the size of the highest score; None if none is felt."""
    best: Candidate | None = None
    least = math.inf
    at = {key: null.best.values[key] for key in one.frame.free}
    if one.bends:
        return _at_limits(null, one)
    alone = one.adds_to(null.hypothesis) and not one.hides
    near = None if alone else null.best
    tries = sizes(null, one)
    few = tries[1::2] if alone else tries  # along one direction, where each costs a filter
    many = [{**at, **size} for size in few]
    bar = null.best if alone else None
    for found in all_at_once(one, many) if one.frame.replays else (tried(one, x, near, FIRST_RUNS, bar) for x in many):
        scored = None if found is None else score(null, found)
        if found is None or scored is None:
            continue
        gain, direction, _ = scored
        # other noise may have taken its place, which the likelihood weighs and the score does not
        if alone or one.frame.replays:
            gain = max(gain, null.nll - found.nll)
        if best is None or gain > best.gain + CLOSE or (gain > best.gain - CLOSE and found.nll < least):
            best, least = Candidate(one, found.values, gain, None if alone else direction), found.nll
    return best


def _races(one: Hypothesis) -> bool:
    return not (one.hides or one.bends or (one.effect is not None and is_load(one.effect)))


def _at_limits(null: Fit, one: Hypothesis, least: float = -math.inf) -> Candidate | None:
    """Return the likeliest limit, each with a filter of its own: where it is met other gains hold; None if none is met,
    or none can gain the ``least`` [nats].
    """
    at = {key: null.best.values[key] for key in one.frame.free}
    still = tried(null.hypothesis, null.best.values, null.best)
    asked = [{**at, **size} for size in sizes(null, one)]
    near = [(values, tried(one, values, null.best, FIRST_RUNS)) for values in asked]
    met = sorted((trial for trial in near if _is_met(still, trial[1])), key=lambda trial: _nll(trial[1]))
    # inputs have switched where it suits a loop without a limit: what a controller makes of them is felt most
    several = SWITCHED if one.frame.model[one.place].role is Role.CONTROLLER else 1
    likely: list[Innovations] = []
    for values, _ in met:  # the best comes early, and others are given up as soon as they are far behind
        ahead = tried(one, values, None, FIRST_RUNS, likely[0] if likely and several == 1 else None)
        likely = sorted([*likely, *([ahead] if ahead is not None else [])], key=_nll)
    best: Innovations | None = None
    for x in likely[:several]:
        most = null.nll - x.nll + most_by_switches(x)
        if most >= least and (best is None or most > null.nll - best.nll):
            best = _likeliest((best, with_switches(x)))
    if best is None:
        return None
    scored = score(null, best)
    return Candidate(one, best.values, null.nll - best.nll, None if scored is None else scored[1])


def _nll(found: Innovations | None) -> float:
    return math.inf if found is None else found.nll


def _is_met(still: Innovations | None, near: Innovations | None) -> bool:
    """Return whether a limit changes what the mean of the model leaves, ``still``; one that is never met does not."""
    return still is None or near is None or not np.allclose(near.e, still.e, rtol=0.0, atol=UNMOVED, equal_nan=True)


def _tried(rough: Fit, one: Hypothesis) -> Candidate | None:
    """Return the likeliest first size of what shows in no first rows alone, in all rows."""
    best = _likeliest(tried(one, {**rough.best.values, **size}, rough.best) for size in sizes(rough, one))
    return None if best is None else _directed(rough, one, best, rough.nll - best.nll)


def _as_candidate(alone: Fit, still: Innovations | None, rough: Fit, one: Hypothesis, best: Innovations) -> Candidate:
    """Return the candidate of a race: it gains as much in all rows as in its own, where ``alone`` is the model fitted,
    and ``still`` that as it is stated.
    """
    share = len(alone.hypothesis.frame.record.log) / len(rough.hypothesis.frame.record.log)
    model = still if still is not None and best.hypothesis.frame.apart else alone
    return _directed(rough, one, best, (model.nll - best.nll) / share)


def _directed(rough: Fit, one: Hypothesis, best: Innovations, gain: float) -> Candidate:
    """Return the candidate of a size that promises a gain, with what it changes in all rows."""
    own = {name: best.values[name] for name in one.own}
    near = tried(one, {**rough.best.values, **own}, rough.best)  # its gains fit its own noise only
    scored = None if near is None else score(rough, near)
    return Candidate(one, {**one.frame.stated, **own}, gain, None if scored is None else scored[1])


def _raced(
    short: Frame, still: Innovations | None, rough: Fit, racing: Sequence[Hypothesis], progress: Progress
) -> dict[Hypothesis, Innovations]:
    """Return what each effect leaves of first rows: first sizes without rows behind switches, sizes on the way from
    there, then a fit in all of these rows.

    Without are those of which no first size is likelier than ``still``, the model as it is stated.  After each step
    only those go on that gain a share of what the best does.
    """

    def first(one: Hypothesis) -> Innovations | None:
        part, best = one.of(replace(short, apart=True)), still
        for size in sizes(rough, one):
            ahead = tried(part, {**one.frame.stated, **size}, None, FIRST_RUNS, best)
            best = ahead if ahead is not None and (best is None or ahead.nll < best.nll) else best
        return best

    firsts = zip(racing, in_threads(first, racing, progress, "effects"), strict=True)
    found = {one: best for one, best in firsts if best is not None and best is not still}
    found = _where_gained(found, still, FIRST_SHARE, _all_further, progress)
    return _where_gained(found, still, SHARE, lambda best: _sprinted(best, short), progress)


def _where_gained(
    found: Mapping[Hypothesis, Innovations], still: Innovations | None, share: float,
    on: Callable[[Innovations], Innovations], progress: Progress,
) -> dict[Hypothesis, Innovations]:  # fmt: skip
    """Return what is left once effects have gone on that gain a share of the best gain; others stay where they are."""
    gains = {one: math.inf if still is None else still.nll - best.nll for one, best in found.items()}
    least = share * max((gain for gain in gains.values() if math.isfinite(gain)), default=0.0)
    likely = [one for one in found if gains[one] >= least]
    ahead = in_threads(lambda one: on(found[one]), likely, progress, "effects")
    return {**found, **dict(zip(likely, ahead, strict=True))}


def _all_further(best: Innovations) -> Innovations:
    for name in free_names(best.hypothesis):
        best = _further(best, name) if name in best.hypothesis.own else best
    return best


def _sprinted(best: Innovations, short: Frame) -> Innovations:
    """Return a fit in all first rows, with switches of its own."""
    whole = tried(best.hypothesis.of(short), best.values)
    return best if whole is None else refined(with_switches(whole), free_names(best.hypothesis), SPRINT).best


def _further(best: Innovations, name: str) -> Innovations:
    """Return the likeliest of sizes of one parameter, the best of the first and others on the way from there.

    Far from the log a small change of a size changes the likelihood by chance, and its slope says nothing.
    """
    one, by = best.hypothesis, WIDER
    low, high = one.bounds[name]
    while by > NARROWER:
        for factor in (by, 1.0 / by):
            start = best
            while low < (size := best.values[name] * factor) < high:
                ahead = tried(one, {**best.values, name: size}, None, FIRST_RUNS, best)
                if ahead is None or ahead.nll > best.nll - CLOSE:
                    break
                best = ahead
            if best is not start:
                break
        by = math.sqrt(by)
    return best


def _likeliest(trials: Iterable[Innovations | None]) -> Innovations | None:
    return min((x for x in trials if x is not None), key=lambda x: x.nll, default=None)


def first_rows(null: Fit) -> Frame:
    """Return the frame of the first rows that hold a ``PART`` of what the model alone leaves."""
    frame = null.best.hypothesis.frame
    left = np.cumsum(np.nansum(np.minimum(np.abs(null.best.e), FAR) ** 2, axis=1))
    rows = max(int(np.searchsorted(left, PART * left[-1])), min(RACED, len(left)))
    return replace(frame, record=frame.record.first_part(rows / len(left)))

"""Which effect explains a record: the likeliest candidates get filters of their own, and all that is free is fitted."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np
from stickslip.diagram.progress import Progress
from stickslip.gap.effects.stiction import SampledStiction, Stiction
from stickslip.gap.fits.loads import is_load
from stickslip.gap.insertion.effect import Effect
from stickslip.gap.likelihood.candidates import FAINTER, Candidate
from stickslip.gap.likelihood.checks import checks
from stickslip.gap.likelihood.fit import Fit, refined, tried, unfitted
from stickslip.gap.likelihood.frame import Frame
from stickslip.gap.likelihood.hypothesis import Hypothesis, Innovations
from stickslip.gap.likelihood.phase import in_phase
from stickslip.gap.likelihood.replayed_stems import replayed_stem
from stickslip.gap.likelihood.sampled_stems import sampled_stem
from stickslip.gap.likelihood.scores import at_bound
from stickslip.gap.likelihood.settling import FIRST, free_names, settled
from stickslip.gap.likelihood.stems import fitted_stem, other_law, resting, settled_stem
from stickslip.gap.likelihood.threads import in_threads

NOISE = "sensor_noise"
BY_DIGITS = ("quantisation",)  # effects that the digits of a log show, and no likelihood of rows does
TRIED = 10  # effects that are fitted
LAGGING = 25.0  # nats by which a first fit may lag behind the best to be fitted to the end
BAND_NATS, BAND_SHARE = 3.0, 0.25  # that a play has to gain, or of the best gain, before a jump is looked for
AWAY, LATER = (1, 2, 4, 8, 16, 32), 1.0  # rows by which a time is moved, and nats that another must gain
APPROACH = 4  # rounds of a fit with the gains of the model before it
STARTS = (0.3, 1.0, 3.0)  # of what the model states of a load, from which its fit begins
SLOWER = 0.3  # of the best gain in a race, that an effect has to have to be fitted
LAG_SHARE = 0.02  # of the best gain, by which a first fit may lag behind as well, where a race was needed
CLEAN = 4.5  # largest check of a fit that leaves nothing unusual
REACH, FAR_REACH = 0.3, 0.02  # shares of its gain, and of any other fit's, that a stem has to have at first


def model_alone(frame: Frame) -> Fit:
    """Return the model without an effect, all that is free in it fitted.

    Raises ``ArithmeticError`` where the model cannot be run along the record.
    """
    best = with_likelier_loads(Hypothesis(frame).filtered({}))
    return refined(best, tuple(frame.free))


def with_likelier_loads(known: Innovations) -> Innovations:
    """Return a filter of the same values, but for sizes of random loads about the stated ones that are likelier."""
    one, stated, best = known.hypothesis, known.hypothesis.frame.stated, known
    for load in (n for n in one.frame.noise if n.correlation_time > 0.0):
        near = best.values
        for by_sd in STARTS:
            for by_time in STARTS:
                sd, time = f"{load.block}.sd", f"{load.block}.correlation_time"
                found = one.noisier(known, {**near, sd: stated[sd] * by_sd, time: stated[time] * by_time})
                best = found if found.nll < best.nll else best
    return best if best is known else best.again()


def legal(null: Fit, catalogue: Iterable[Effect]) -> list[Hypothesis]:
    """Return the hypotheses that a catalogue has for a record.

    Noise within the bounds of every fit is no effect: more noise is one where the model alone wants more than that.
    """
    frame = null.hypothesis.frame
    left_out: tuple[str, ...] = BY_DIGITS if at_bound(null) else (*BY_DIGITS, NOISE)
    return [
        resting(Hypothesis(frame, effect, place, level))
        for effect in catalogue if not effect.of_log and effect.name not in left_out
        for place in frame.given.places(effect)
        for level in (False, True)[: 1 + bool(effect.level)]
        if not _at_rest(frame, effect, place) and (not frame.record.suspects or place in frame.record.suspects)
    ]  # fmt: skip


def _at_rest(frame: Frame, effect: Effect, place: str) -> bool:
    """Return whether all that an effect changes for a controller is inputs that never move."""
    log, read = frame.record.log, [frame.model[place].loop_signal(signal) for signal in effect.reads]
    return bool(read) and all(s in frame.record.played and float(np.ptp(log[s])) == 0.0 for s in read)


def fitted(
    null: Fit, found: Sequence[Candidate], raced: bool, within: float = math.inf, progress: Progress = None
) -> list[Fit]:
    """Return the fits of the candidates of the highest scores, the likeliest first; ``raced``: how they were found.

    ``within``: the nll that first sizes of a stem have to come to, or it is not fitted; infinite where there is a gap.
    """
    first, done = tuple[Fit, ...](), list[Fit]()
    most = max((c.gain for c in found if c.races), default=0.0)
    chosen = [c for c in found[:TRIED] if _promises(c, most, raced)]
    if null.hypothesis.frame.record.filter is None:  # a large diagram has too many stems, and their scores do say much
        chosen += [c for c in found[TRIED:] if c.hypothesis.sticks]
    for rank in range(3):  # a stem is fitted where nothing else is enough, one that jumps where one without gains
        alike = [c for c in chosen if _rank(c.hypothesis) == rank]
        fits = in_threads(partial(_first_fit, null, first, raced, within), alike, progress, "fits")
        first = tuple(sorted((*first, *(fit for fit in fits if fit is not None)), key=price))
        if raced and rank == 0 and first:  # what is enough to the end leaves stems little to look for
            done = [_ended(first[0])]
            first = (*done, *first[1:])
    lag = max(LAGGING, LAG_SHARE * (null.nll - price(first[0]))) if raced and first else LAGGING
    near = [fit for fit in first if price(fit) < price(first[0]) + lag]

    def end(fit: Fit) -> Fit:
        return settled_stem(fit) if fit.hypothesis.hides else fit if fit in done else _ended(fit)

    return _once(_in_phase_of_best(sorted(in_threads(end, near), key=price), lag))


def _promises(one: Candidate, most: float, raced: bool) -> bool:
    """Return whether a candidate may come near the one that gains ``most``; a score says little of stems and loads."""
    effect = one.hypothesis.effect
    if one.hypothesis.hides or (effect is not None and is_load(effect)):
        return True
    return one.gain >= (SLOWER if raced and one.races else FAINTER) * most


def _once(found: Sequence[Fit]) -> list[Fit]:
    """Return the likeliest fit of each effect at each place."""
    best: dict[tuple[Effect | None, str], Fit] = {}
    for fit in found:
        best.setdefault((fit.hypothesis.effect, fit.hypothesis.place), fit)
    return list(best.values())


def _rank(one: Hypothesis) -> int:
    """Return how many kinds of effects are fitted before: those that hide no mode, and stems that do not jump."""
    return int(one.hides) + int(one.hides and bool(one.nests))


def _ended(fit: Fit) -> Fit:
    """Return a fit in all rows; a load that begins at some time has other times tried, which have no slope far off."""
    fit = settled(fit)
    one = fit.hypothesis
    while one.frame.replays and one.effect is not None and "time" in one.own:
        dt, best = one.frame.record.log.dt, fit.best
        times = [best.values["time"] + way * rows * dt for rows in AWAY for way in (1.0, -1.0)]
        ahead = [x for x in one.replayed([{**best.values, "time": time} for time in times]) if x is not None]
        likeliest = min(ahead, key=lambda x: x.nll, default=best)
        if likeliest.nll > best.nll - LATER:
            break
        fit = refined(likeliest, free_names(one))
    return fit


def _in_phase_of_best(found: list[Fit], lag: float) -> list[Fit]:
    """Return the fits with rows behind the scans where the best has them: a wrong model finds them elsewhere.

    Fits that lag behind the best there, by more than ``lag``, are left out.
    """
    if not found or found[0].hypothesis.hides:
        return found
    best = in_phase(found[0].best)
    if best is found[0].best:
        return found
    stems, others = ([fit for fit in found[1:] if fit.hypothesis.hides == hides] for hides in (True, False))
    there = [tried(fit.hypothesis.of(best.hypothesis.frame), fit.best.values) for fit in others]
    near = [one for one in (best, *there) if one is not None and one.nll <= best.nll + lag]
    return sorted([*in_threads(lambda one: settled(unfitted(one)), near), *stems], key=price)


def _first_fit(null: Fit, found: Sequence[Fit], raced: bool, within: float, one: Candidate) -> Fit | None:
    """Return the first fit of a candidate; ``found`` those before it."""
    mine = one.hypothesis.of(null.best.hypothesis.frame)  # the same rows for all, or no two compare
    if mine.hides:
        band = next((f for f in found if _is_without_jump(f.hypothesis, mine)), None)
        most = max((null.nll - f.nll for f in found), default=0.0)
        if mine.nests and (band is None or null.nll - band.nll < max(BAND_NATS, BAND_SHARE * most)):
            # what no play explains to some part a stem that jumps hardly ever explains
            if not mine.cheap or (raced and _is_clean(found)):
                return None
            band = None
        reach = min(within, _within_reach(null, found))
        return fitted_stem(null, mine, band, reach, fairly=math.isinf(within))
    if mine.frame.replays and mine.sticks:
        fits = [replayed_stem(mine)]
        if type(mine.effect) is Stiction:
            other = other_law(mine)
            if isinstance(other.effect, SampledStiction):
                fits.append(sampled_stem(other))
            elif not mine.frame.noise:  # which law it is shows without noise only
                fits.append(replayed_stem(other))
        return min((fit for fit in fits if fit is not None), key=lambda fit: fit.nll, default=None)
    start = _likelier_noise(tried(mine, one.values) if raced else _own_filter(null, one))
    if start is not None and mine.effect is not None and is_load(mine.effect):
        start = with_likelier_loads(start)  # a random load has stood for the planned one
    return None if start is None else settled(unfitted(_apart_from_switches(start)), 1)


def _apart_from_switches(start: Innovations) -> Innovations:
    """Return a fit in rows that no switch of an input is near, for the model alone has placed these as suits it; the
    start where that is likelier.
    """
    one = start.hypothesis
    apart = replace(one.frame, apart=True)
    if one.frame.replays or one.bends or bool((apart.counted == one.frame.counted).all()):
        return start  # a limit is met behind a switch, and where nothing switches there is nothing to leave out
    there = tried(one.of(apart), start.values)
    found = None if there is None else tried(one, refined(there, free_names(one), FIRST).best.values)
    return found if found is not None and found.nll < start.nll else start


def _likelier_noise(start: Innovations | None) -> Innovations | None:
    """Return a start with noise and loads as the model states them, if that is likelier: a model that is wrong has
    larger ones.
    """
    if start is None:
        return None
    one = start.hypothesis
    plain = {key: size for key, size in one.frame.stated.items() if key in one.noise_keys}
    stated = tried(one, {**start.values, **plain})
    return stated if stated is not None and stated.nll < start.nll else start


def _within_reach(null: Fit, found: Sequence[Fit]) -> float:
    """Return the nll that first sizes of a stem have to come to: nearly that of a fit that leaves nothing unusual, and
    not far above that of any other.
    """
    best = min(found, key=price, default=None)
    if best is None or best.hypothesis.hides:
        return math.inf
    return null.nll - (REACH if _is_clean(found) else FAR_REACH) * max(null.nll - best.nll, 0.0)


def _is_clean(found: Sequence[Fit]) -> bool:
    """Return whether the best fit leaves nothing unusual."""
    best = min(found, key=price, default=None)
    return best is not None and max(map(abs, checks(best.best).values())) <= CLEAN


def _is_without_jump(narrow: Hypothesis, wide: Hypothesis) -> bool:
    """Return whether a hypothesis is that of another stem, at the same place, without its jump."""
    return narrow.place == wide.place and narrow.effect is not None and narrow.effect.name == wide.nests


def price(fit: Fit) -> float:
    """Return the nll and what the parameters of an effect cost [nats]."""
    return fit.nll + schwarz(free_parameters(fit.best), float(np.isfinite(fit.best.judged).sum()))


def schwarz(parameters: int, values: float) -> float:
    """Return what parameters cost by Schwarz's criterion, half ln n each [nats]."""
    return 0.5 * parameters * math.log(max(values, 2.0))


def free_parameters(one: Candidate | Innovations) -> int:
    """Return how many parameters of its effect a hypothesis uses."""
    effect = one.hypothesis.effect
    return sum(math.isfinite(one.values[p.name]) for p in effect.parameters) if effect else 0


def _own_filter(null: Fit, one: Candidate) -> Innovations | None:
    """Return a filter of its own of a candidate, its size fitted with the gains of the model before."""
    hypothesis = one.hypothesis
    if hypothesis.adds_to(null.hypothesis):
        return tried(hypothesis, one.values)
    names = [name for name in free_names(hypothesis) if name not in hypothesis.noise_keys]
    start = tried(hypothesis, one.values, null.best)
    near = one.values if start is None else refined(start, names, APPROACH, null.best).best.values
    return tried(hypothesis, near) or tried(hypothesis, one.values)

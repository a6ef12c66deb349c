"""A stem that plays or sticks, fitted by a bank of stems, each with a path of its own, given which the rest is linear.

    1. gains: a filter in which the stem goes where OP sends it; later, where the likeliest stem went
    2. sizes: a grid, then near the likeliest of it; where controllers scan, by two laws of rest
    3. noise, loads and tolerances: fitted with the likeliest path as known; then gains and sizes again

A model without a stem has taken it for noise or a load, so these are fitted before sizes are compared closely.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from stickslip.gap.effects.stiction import RestingStiction, SampledStiction, Stiction
from stickslip.gap.fits.coordinates import width
from stickslip.gap.insertion.bent_valve import stem_signal
from stickslip.gap.insertion.paths import command
from stickslip.gap.insertion.scales import span
from stickslip.gap.likelihood.few_stems import FewStems, known_stem, on_path
from stickslip.gap.likelihood.fit import Fit, refined
from stickslip.gap.likelihood.hypothesis import LATE, Hypothesis, Innovations
from stickslip.gap.likelihood.stem_trials import (
    AFTER,
    FACTORS,
    STEMS,
    Bank,
    asked_with,
    nll_of,
    sizes_of,
    with_likelier_noise,
    with_path,
)
from stickslip.gap.likelihood.switches import with_switches
from stickslip.gap.likelihood.threads import in_threads

BETWEEN = 10  # draws of a noise from row to row, at most; one held over two scans is another, 250 nats off once
SIZES = 10  # bands over their range, first
SHARES = (0.1, 0.2, 0.3, 0.4, 0.5, 0.65, 0.8)  # of S, that a jump may be
LARGE = (0.3, 0.55, 0.8)  # of any S, likewise
ABOUT = (0.95, 1.0, 1.05)  # the band that stands for a jump, over S - J/2
AT_ONCE = 0.25  # of a scan, after which a stem sticks anew behind a lag
SMALLEST, LARGEST = 0.02, 1.0  # of OP's travel: bands that are looked for
NEARLY_NONE = 1e-3  # of the smallest band: a stem that goes where OP sends it
STARTS, APART = 4, 0.09  # places from which sizes are searched, and by how much their J/S differ at least
OFTEN = 6  # times that sizes are changed by such a share, where each costs little
STEPS = (0.04, 0.02)  # shares by which sizes are changed, one after the other
FEW, MOST_STEMS = 4, 24  # of a bank while sizes are looked for, and at the end
SURER = 3  # times as many at the end, where each costs little
ROUNDS = 2  # of a fit of noise and loads
MORE = 5.0  # nats that sizes, noise and loads must gain, or they are not searched again
SHOWS = 1.0  # nats that some band must gain over a stem that goes where OP sends it, with the same noise and gains
AGAIN = 4  # sizes that are asked again in all rows
ASIDE = 0.1  # share by which sizes are changed to see how sure they are
LEAST_LOSS, MOST_LOSS = 1.5, 80.0  # nats between which the losses of a bank tell how sure a size is


Trial = tuple[dict[str, float], Hypothesis]  # sizes, and the law that has them


@dataclass(frozen=True, eq=False)
class StemFit(Fit):
    """The fit of a stem, with all ``trials`` of its sizes that share noise and gains."""

    trials: tuple[Innovations, ...]
    few: FewStems | None


def fitted_stem(
    null: Fit, one: Hypothesis, without: Fit | None = None, within: float = math.inf, fairly: bool = True
) -> Fit | None:
    """Return the fit of a stem, a band or, from the fit ``without`` one, a jump; None where no run follows it.

    ``within``: the nll that its first sizes have to come to, or it is not fitted; ``fairly``: whether what few stems
    lose is made up.
    """
    one = one.of(replace(one.frame, draws=BETWEEN))
    few = FewStems(null, _without_band(one))
    first = _first(one, without)
    banks = sorted(_screened(few, one, without, fairly, first), key=lambda bank: bank.least)
    # gains that know the path lose most of a stem that does not stick: no other is charged for it, but it may be one
    lost = 0.0 if one.cheap or not fairly else few.lost(one, FEW)
    near = [bank for bank in banks if bank.least + lost <= within]
    fits = [_fitted_from(one, bank, first) for bank in (near if one.cheap else near[:1])]
    return min((fit for fit in fits if fit is not None), key=lambda fit: fit.nll, default=None)


def _fitted_from(one: Hypothesis, bank: Bank, first: Sequence[Trial]) -> Fit | None:
    """Return the fit of a stem from first sizes with the noise and gains of a bank."""
    bank.count = STEMS
    best = _best_of(bank, STARTS if one.cheap else 1)
    if best is None:
        return None
    free = tuple(one.frame.free)
    if one.cheap:
        known = refined(known_stem(best).filtered(bank.shared), free, ROUNDS)
        last = asked_with(bank, {key: known.best.values[key] for key in free}, best)
        if last is None:
            return None
    else:  # across runs a likely path is no known one: noise beside it is searched by the bank itself
        again = asked_with(bank, bank.shared, best)
        if again is None:
            return None
        last, before, factors = again, math.inf, FACTORS
        while last.least < before - MORE:  # the less is left to noise and loads, the sharper sizes show
            before = last.least
            last = with_likelier_noise(last, factors)
            _asked(last, first)
            _best_of(last, 2)
            last, factors = asked_with(last, last.shared, last.likeliest) or last, AFTER
        known = refined(known_stem(last.likeliest).filtered(last.shared), free, 0)
    _refined(last, last.likeliest)
    return _finished(last, known)


def _best_of(bank: Bank, starts: int) -> Innovations | None:
    """Return the likeliest of what sizes near the best few starts leave; None if none can be."""
    return min(in_threads(lambda start: _refined(bank, start), _starts(bank)[:starts]), key=nll_of, default=None)


def _asked(bank: Bank, first: Sequence[Trial]) -> None:
    """Try first sizes."""
    in_threads(lambda trial: bank.tried(*trial), first)


def _first(one: Hypothesis, without: Fit | None) -> list[Trial]:
    """Return the sizes that are tried first, each with its law."""
    pairs = _pairs(one) if len(one.own) > 1 and one.cheap else []
    first = [(size, one) for size in [*(_bands(one) if without is None else _jumps(without, 0.5, ABOUT)), *pairs]]
    if without is not None and behind_lag(one):
        first += [(size, other_law(one)) for size in _jumps(without, 0.0, (1.0,))]
    return first


def _screened(few: FewStems, one: Hypothesis, without: Fit | None, fairly: bool, first: Sequence[Trial]) -> list[Bank]:
    """Return banks with trials of first sizes that show beside a stem that goes where OP sends it.

    A model without a stem may have taken it for noise, a load or another gain: what is stated is a start as well.
    """
    fitted = {key: (without or few.null).best.values[key] for key in one.frame.free}
    both = without is None or one.cheap
    try:
        path = without.best.stem if without is not None else few.path(one)
    except ArithmeticError:
        return []
    starts = (fitted, dict(one.frame.stated)) if both else (fitted,)
    made = [with_path(one, shared, path, few if fairly and one.cheap else None, FEW) for shared in starts]
    banks = [bank for bank in made if bank is not None]
    still = [None if without is not None else bank.tried(_without_band(one)) for bank in banks]
    for bank in banks:
        _asked(bank, first)
    return [
        bank for bank, at_rest in zip(banks, still, strict=True)
        if bank.trials and (at_rest is None or bank.least < at_rest.nll - SHOWS)
    ]  # fmt: skip


def _bands(one: Hypothesis) -> list[dict[str, float]]:
    """Return the bands without a jump that are tried first."""
    low, high = _range(one)
    return [{one.own[0]: float(s), **dict.fromkeys(one.own[1:], 0.0)} for s in np.geomspace(low, high, SIZES)]


def _pairs(one: Hypothesis) -> list[dict[str, float]]:
    """Return sizes of stems of which no play says where to look for them."""
    return [{"S": band["S"], "J": share * band["S"]} for band in _bands(one) for share in LARGE]


def _without_band(one: Hypothesis) -> dict[str, float]:
    """Return the sizes of a stem that goes where OP sends it."""
    low, _ = _range(one)
    return {one.own[0]: NEARLY_NONE * low, **dict.fromkeys(one.own[1:], 0.0)}


def _jumps(without: Fit, less: float, about: Sequence[float]) -> list[dict[str, float]]:
    """Return the sizes of a stem that jumps that are tried first: a play for it has a band S - ``less`` J."""
    band = without.best.values[without.hypothesis.own[0]]
    S = [(band * near / (1.0 - less * share), share) for share in SHARES for near in about]
    return [{"S": band, "J": 0.0}, *({"S": size, "J": share * size} for size, share in S)]


def resting(one: Hypothesis) -> Hypothesis:
    """Return a hypothesis; of a stem that jumps, where OP stands still between scans, that it sticks anew there."""
    held = type(one.effect) is Stiction and one.frame.scanned and not behind_lag(one)
    return replace(one, effect=RestingStiction()) if held else one


def settled_stem(fit: Fit) -> Fit:
    """Return the fit of a stem in all rows, inputs switching when that suits its likeliest path."""
    assert isinstance(fit, StemFit)
    best = fit.best
    one = best.hypothesis.of(replace(best.hypothesis.frame, apart=False))
    shared = {key: best.values[key] for key in one.frame.free}
    found: list[Bank] = []
    switched = with_switches(on_path(one, best.stem).filtered(shared)).hypothesis.frame
    for frame in dict.fromkeys((one.frame, switched)):
        bank = with_path(one.of(frame), shared, best.stem, fit.few)
        if bank is not None and bank.tried(sizes_of(best)) is not None:
            found.append(bank)
    if not found:
        return fit
    bank = min(found, key=lambda b: b.trials[0].nll)
    for trial in sorted(fit.trials, key=nll_of)[1:AGAIN]:
        bank.tried(sizes_of(trial))
    return replace(fit, best=_last(bank), trials=tuple(bank.trials))


def _finished(bank: Bank, known: Fit) -> Fit:
    """Return the fit of the likeliest trial; ``known``: that of the rest with its path."""
    best = bank.likeliest
    aside = [
        _moved(sizes_of(best), k, way) for k in range(len(best.hypothesis.own)) for way in (1.0 - ASIDE, 1.0 + ASIDE)
    ]
    in_threads(lambda size: bank.tried(size, best.hypothesis), aside)
    last = _last(bank)
    mine = [trial for trial in bank.trials if trial.hypothesis.effect is last.hypothesis.effect]
    names, sure = _certainty(last, mine)
    rows = known.slopes.shape[1:] if len(known.slopes) else last.e.shape
    slopes = np.concatenate([np.zeros((len(names), *rows)), known.slopes.reshape(-1, *rows)])
    information = np.zeros((len(names) + len(known.names),) * 2)
    information[: len(names), : len(names)], information[len(names) :, len(names) :] = np.diag(sure), known.I
    return StemFit(last, (*names, *known.names), information, slopes, tuple(mine), bank.few)


def _last(bank: Bank) -> Innovations:
    """Return the likeliest trial of a bank, asked again with more stems."""
    best = bank.likeliest
    bank.count = MOST_STEMS * (SURER if bank.one.cheap else 1)
    return bank.tried(sizes_of(best), best.hypothesis) or best


def _certainty(best: Innovations, trials: Sequence[Innovations]) -> tuple[tuple[str, ...], list[float]]:
    """Return the sizes of a stem, and Fisher's information of the coordinate of each.

    It is that of the flattest parabola through the likeliest trial and another, which is the one along the ridge.
    """
    names: list[str] = []
    sure: list[float] = []
    for name in best.hypothesis.own:
        unit = width(best.hypothesis, name)
        aside = [((t.values[name] - best.values[name]) / unit, t.nll - best.nll) for t in trials]
        bends = [2.0 * loss / x**2 for x, loss in aside if abs(x) > 0.0 and LEAST_LOSS < loss < MOST_LOSS]
        if bends:
            names.append(name)
            sure.append(min(bends))
    return tuple(names), sure


def _range(one: Hypothesis) -> tuple[float, float]:
    """Return the smallest and the largest band that are looked for, by how far the wave of OP goes [% OP]."""
    low, high = one.bounds[one.own[0]]
    f = one.frame
    valve = f.model[one.place]
    ops = [s for s in f.ops if s in map(str, valve.input_labels)] or list(f.ops)
    travel = max(
        (
            100.0 * float(np.ptp(f.Y[np.isfinite(f.Y[:, k]), k])) / span(f.model, s)
            for s in ops for k in [f.signals.index(s)]
        ),
        default=0.0,
    )  # fmt: skip
    if travel <= 0.0:
        return low, high
    return max(low, SMALLEST * travel), max(min(high, LARGEST * travel), 2.0 * low)


def _starts(bank: Bank) -> list[Innovations]:
    """Return the likeliest trials whose jumps differ: the likelihood of a stem has more than one peak."""
    found: list[Innovations] = []
    for trial in sorted(bank.trials, key=nll_of):
        share = _share(trial)
        apart = all(abs(_share(one) - share) > APART for one in found)
        if len(found) < STARTS and apart and trial.nll < (found or [trial])[0].nll + LATE:
            found.append(trial)
    return found


def _share(trial: Innovations) -> float:
    """Return how much of its band a stem jumps."""
    band, *jump = (trial.values[name] for name in trial.hypothesis.own)
    return jump[0] / band if jump else 0.0


def _refined(bank: Bank, start: Innovations) -> Innovations:
    """Return the likeliest of sizes near a start, step by step: where a stem breaks away, and where it stops.

    What gained once is tried again; the way back is tried once the other size has changed.
    """
    best = bank.tried(sizes_of(start), start.hypothesis) or start
    for step in STEPS:
        ways: dict[int, tuple[float, ...]] = dict.fromkeys(range(len(bank.one.own)), (1.0 - step, 1.0 + step))
        for _ in range(OFTEN if bank.one.cheap else OFTEN // 2):
            before = best
            for k in ways:
                for way in ways[k]:
                    ahead = bank.tried(_moved(sizes_of(best), k, way), best.hypothesis)
                    if ahead is not None and ahead.nll < best.nll:
                        best = ahead
                        ways = {i: (way,) if i == k else (1.0 - step, 1.0 + step) for i in ways}
                        break
            if best is before:
                break
    if isinstance(bank.one.effect, Stiction) and best.values.get("J", 0.0) > 0.0:
        other = other_law(best.hypothesis)
        ahead = bank.tried(sizes_of(best), other)
        if ahead is not None and ahead.nll < best.nll:
            best = ahead
    return best


def _moved(size: dict[str, float], k: int, way: float) -> dict[str, float]:
    """Return sizes of which the band, or of a stem that jumps one of the bands f_s and f_c, is changed by a factor."""
    if "J" not in size:
        return {name: value * way for name, value in size.items()}
    f_s, f_c = 0.5 * (size["S"] + size["J"]), 0.5 * (size["S"] - size["J"])
    f_s, f_c = (f_s * way, f_c) if k == 0 else (f_s, f_c * way)
    return {"S": f_s + f_c, "J": max(f_s - f_c, 0.0)}


def other_law(one: Hypothesis) -> Hypothesis:
    """Return the stem that slides on in place of one that sticks anew, or the other way round.

    It sticks anew whenever a scanned OP stands still, behind a lag as soon as it has jumped, or where OP goes on, at
    each row.
    """
    f = one.frame
    if type(one.effect) is not Stiction:
        return replace(one, effect=Stiction())
    if f.scanned and not behind_lag(one):
        return replace(one, effect=RestingStiction())
    return replace(one, effect=SampledStiction(f.scanned * AT_ONCE if f.scanned else f.record.log.dt))


def behind_lag(one: Hypothesis) -> bool:
    """Return whether what a stem follows moves between the scans of a controller, as behind an actuator's lag."""
    f = one.frame
    return bool(f.scanned) and stem_signal(f.model, one.place) not in f.ops and command(f.model[one.place]) not in f.ops

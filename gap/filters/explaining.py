"""The best values of every effect at every place, by likelihood."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from stickslip.blocks.role import Role
from stickslip.diagram.progress import Progress, reporting
from stickslip.gap.effects.controller_limits import ControllerLimits
from stickslip.gap.effects.disturbance import Disturbance
from stickslip.gap.effects.quantisation import Quantisation
from stickslip.gap.effects.scan_time import ScanTime
from stickslip.gap.effects.sensor_saturation import SensorSaturation
from stickslip.gap.filters.affine import NotAffine
from stickslip.gap.filters.filtering import Explanation, Filtered
from stickslip.gap.filters.fitting import NODES, Found, best_of, grid, refined, tried
from stickslip.gap.filters.limiting import limited
from stickslip.gap.filters.reading import Filtering
from stickslip.gap.filters.switches import with_switches
from stickslip.gap.fits.loads import planned
from stickslip.gap.insertion.effect import Effect

STEPPED = (ScanTime, ControllerLimits)
PART = 400  # rows in which slower scans are looked for, at least
SLOWEST = 60  # scans of the model from one to the next of a slower controller, at most
STRAY = 0.02  # share of rows at which its output may change though it has not scanned
OFFSETS = 6  # first scans of a period that are tried before those beside the likeliest
SLOWER = 3  # of these that are looked at with switches of their own
SHORTEST = 2.5  # period of a load [rows]: a filter knows what it does between two rows
FIRST, APART = 2, 4  # steps of every fit; of one without the rows near switches
FIRSTS, FOLLOWED = 3, 8  # explanations that are fitted to the end with switches of their own, and without
LAGGING, BEHIND = 60.0, 0.7  # nats, or share of the gap, by which a few sizes may lag behind a fit to be fitted too
PARTS = (0.5, 0.25)  # of the way to the neighbours in a grid that are looked at where a likelihood is sharp
NEAR = 60.0  # nats by which a fit may lag behind the best to be fitted again
SWITCHED = 3  # times that switches are looked for again
IRREGULAR = 0.2  # nats a row
# what noise alone gains by these; of limits one record of 130 without a gap gained 7.5 nats, true ones 260 and more
PRICES = {"step_disturbance": 6.0, "sine_disturbance": 9.0, "slug": 10.0, "controller_limits": 6.0}


def settled(f: Filtering) -> Found:
    """Return the model as it is, its unsure parameters and the switches of its inputs as suits the record best."""
    return _both(with_switches(Explanation(f).filtered({})), tuple(f.free))


def coarse(plain: Found, effect: Effect, place: str) -> Filtered | None:
    """Return the best of a few sizes of an effect at a place; None if no filter has it.

    ``plain`` the model as it is, settled.
    """
    f = plain.best.explanation.filtering
    one = Explanation(f, effect, place)
    free = {key: plain.best.values[key] for key in f.free}
    if isinstance(effect, ScanTime):
        return _slower(one, free) if _irregular(plain) else None
    if one.load:
        return _load(plain, one)
    if one.own == ("low", "high"):
        return limited(plain, one)
    start, values = None, dict(free)
    for name in one.own:
        start = best_of([start, *(tried(one, {**values, name: size}) for size in grid(one, name))])
        if start is not None and one.law:  # a law that bends has a sharp likelihood
            start = _between(one, name, start)
        if start is not None:
            values = dict(start.values)
    return start


def _between(one: Explanation, name: str, start: Filtered) -> Filtered:
    """Return the best of sizes between the likeliest of a grid and its neighbours."""
    low, high = one.bounds[name]
    best = start
    for part in PARTS:
        by = (high / low) ** (part / (NODES - 1)) if 0.0 < low < high < math.inf else 1.0
        sizes = [best.values[name] * way for way in (by, 1.0 / by)] if by > 1.0 else []
        near = [tried(one, {**best.values, name: size}) for size in sizes if low <= size <= high]
        best = best_of([best, *near]) or best
    return best


def ranked(
    plain: Found, catalogue: Iterable[Effect], progress: Progress = None, rival: float = math.inf
) -> list[Found]:
    """Return the best fit of every effect that a filter has, at every place, the likeliest first.

    All are looked at in a few sizes; the likeliest of these are fitted to the end, and the likeliest of those once more
    from where the best one ended: explanations that leave the same log must not differ by where a search stopped.
    ``rival``: nll of another explanation [nats]; what comes nowhere near it is not fitted to the end.
    """
    return fitted(plain, first_looks(plain, catalogue, progress), rival)


def first_looks(plain: Found, catalogue: Iterable[Effect], progress: Progress = None) -> list[Filtered]:
    """Return a first fit of every effect that a filter has, at every place, the likeliest first."""
    given = plain.best.explanation.filtering.given
    legal = [
        (effect, place)
        for effect in catalogue
        if not (effect.of_log or effect.hidden or isinstance(effect, Quantisation | SensorSaturation))
        for place in given.places(effect)
    ]
    looked = []
    with reporting(progress, len(legal), "effects") as tell:
        for done, (effect, place) in enumerate(legal):
            apart = effect.role is Role.CONTROLLER and not isinstance(effect, ScanTime)
            start = coarse(_apart(plain) if apart else plain, effect, place)
            if start is not None:  # a sharp likelihood is seen only near its top
                looked.append(first_fit(plain, start))
            tell(done + 1, len(legal))
    return sorted(looked, key=lambda one: one.nll)


def without_filter(plain: Found, catalogue: Iterable[Effect]) -> list[Effect]:
    """Return the effects that make the diagram one that a linear filter cannot follow, at some place where they can be.

    A limit of a sensor is one; a stem that hides and what the digits of a log tell have ways of their own.
    """
    f, other = plain.best.explanation.filtering, (Quantisation, ControllerLimits, ScanTime, Disturbance)
    asked = [effect for effect in catalogue if not (effect.of_log or effect.hidden or isinstance(effect, other))]

    def bends(effect: Effect) -> bool:
        return any(_bends(Explanation(f, effect, place), plain) for place in f.given.places(effect))

    return [effect for effect in asked if isinstance(effect, SensorSaturation) or bends(effect)]


def _bends(one: Explanation, plain: Found) -> bool:
    """Return whether no linear filter follows an explanation, at a size in the middle of its range."""
    middle = {name: math.sqrt(low * high) if low > 0.0 else high for name, (low, high) in one.bounds.items()}
    own = {name: middle[name] for name in one.own}
    try:
        one.matrices({**plain.best.values, **own})
    except NotAffine:
        return True
    return False


def fitted(plain: Found, looked: Iterable[Filtered], rival: float = math.inf) -> list[Found]:
    """Return rough fits, the most likely ones fitted to the end; those far behind a ``rival`` in log likelihood are
    not.
    """
    found: list[Found] = []
    for k, start in enumerate(looked):
        best = min([rival, *(one.nll for one in found)])
        gained = plain.nll - best
        near = start.nll < best + max(LAGGING, BEHIND * gained)
        if k < FIRSTS and near:
            found.append(followed(start))
        elif k < FOLLOWED and near:
            found.append(refined(start, free_names(start.explanation)))
        else:
            found.append(Found(start, (), np.zeros((0, 0))))
    found.sort(key=total)
    return sorted((_again(one, found[0]) for one in found), key=total) if found else []


def _apart(plain: Found) -> Found:
    """Return the same without the rows near switches: a scan that is wrong there looks like a wrong controller."""
    one = plain.best.explanation
    apart = replace(one, filtering=replace(one.filtering, apart=True))
    return replace(plain, best=replace(plain.best, explanation=apart))


def first_fit(plain: Found, start: Filtered) -> Filtered:
    """Return a fit after a few steps; one of a controller with switches that suit it."""
    names = own_names(start.explanation)
    if not start.explanation.filtering.apart:
        return refined(start, names, FIRST).best
    near = refined(start, names, APART).best
    whole = replace(near.explanation, filtering=plain.best.explanation.filtering)
    again = tried(whole, near.values)
    return near if again is None else refined(with_switches(again), names, FIRST).best


def _again(one: Found, best: Found) -> Found:
    """Return a fit that comes near the best, fitted once more with that one's switches and unsure parameters."""
    if one is best or not one.names or one.nll > best.nll + NEAR:
        return one
    f = best.best.explanation.filtering
    start = tried(
        replace(one.best.explanation, filtering=f),
        {**one.best.values, **{key: best.best.values[key] for key in f.free}},
    )
    same = tried(replace(one.best.explanation, filtering=f), one.best.values)
    found = best_of([start, same])
    if found is None:
        return one
    again = refined(found, free_names(found.explanation))
    return again if again.nll < one.nll else one


def total(one: Found) -> float:
    """Return the negative log likelihood plus the penalty for parameters that an effect frees besides its size."""
    effect = one.best.explanation.effect
    return one.nll + (PRICES.get(effect.name, 0.0) if effect else 0.0)


def free_names(one: Explanation) -> tuple[str, ...]:
    """Return the parameters that a fit varies: not those whose few possible values the log shows."""
    own = () if isinstance(one.effect, STEPPED) else one.own
    return (*own, *one.filtering.free)


def own_names(one: Explanation) -> tuple[str, ...]:
    """Return the parameters that a first fit varies: noise and loads stay as the model without an effect has them."""
    return tuple(name for name in free_names(one) if name in one.own or name in one.filtering.unsure)


def _irregular(plain: Found) -> bool:
    """Return whether innovations are far too large: a controller that scans more slowly leaves nothing as it was."""
    e = plain.best.judged
    return 0.5 * float(np.nansum(e**2 - 1.0)) > IRREGULAR * len(e)


def followed(start: Filtered) -> Found:
    """Return the fit from a start, with switches where they suit it; from the middle of tolerances if it hit them."""
    names = free_names(start.explanation)
    found = _both(start, names)
    one = start.explanation
    walls = [
        key for key, (low, high) in one.filtering.free.items()
        if min(found.best.values[key] - low, high - found.best.values[key]) < 1e-6 * (high - low)
    ]  # fmt: skip
    if walls:
        middle = {key: one.nominal[key] for key in one.filtering.free}
        other = tried(found.best.explanation, {**found.best.values, **middle})
        if other is not None:
            again = _both(other, names)
            found = min(found, again, key=lambda one: one.nll)
    return found


def _both(start: Filtered, names: Sequence[str]) -> Found:
    found = refined(start, names)
    for _ in range(SWITCHED):
        switched = with_switches(found.best)
        if switched is found.best:
            break
        found = refined(switched, names)
    return found


def _slower(one: Explanation, free: Mapping[str, float]) -> Filtered | None:
    """Return the best of the slower scans: those likeliest in the first part of the record, with and without the rows
    near switches, each with switches that suit it.
    """
    scans = _scans(one)
    rows = len(one.filtering.Y)
    head = one.filtering.head(min(rows, max(PART, rows // 4)))
    counted = replace(head, apart=True).counted
    first = replace(one, filtering=head)
    looked = _tried(first, free, [values for many in scans for values in thinned(many)])
    best = _likeliest(looked, counted)
    by_period = {many[0]["period"]: many for many in scans}
    reach = {period: len(many) / OFFSETS * one.filtering.period for period, many in by_period.items()}
    beside = [
        values for x in best for period in [x.values["period"]] for values in by_period[period]
        if 0.0 < abs(values["offset"] - x.values["offset"]) < reach[period]
    ]  # fmt: skip
    best = _likeliest([*looked, *_tried(first, free, beside)], counted)
    many = {tuple(x.values.items()): x.values for x in best}.values()
    near = [found for values in many if (found := tried(one, values)) is not None]
    near += [found for x in near if (found := tried(one, {**x.values, "present": 0.0})) is not None]
    return best_of([with_switches(found) for found in near])


def _tried(one: Explanation, free: Mapping[str, float], many: Iterable[Mapping[str, float]]) -> list[Filtered]:
    return [found for values in many if (found := tried(one, {**free, **values})) is not None]


def _likeliest(looked: Sequence[Filtered], counted: NDArray[np.bool_]) -> list[Filtered]:
    """Return the likeliest in all rows, and in those that count apart from switches."""
    best = sorted(looked, key=lambda x: x.nll)[:SLOWER]
    return best + sorted(looked, key=lambda x: float(x.losses[counted].sum()))[:SLOWER]


def thinned(many: Sequence[dict[str, float]]) -> Sequence[dict[str, float]]:
    """Return at most about ``OFFSETS`` of the first scans of one period, evenly over it."""
    return many[:: max(1, math.ceil(len(many) / OFFSETS))]


def _scans(one: Explanation) -> list[list[dict[str, float]]]:
    """Return the first scans to try of each period, of an integral that takes in the present error: those that explain
    when the logged output changes.

    A controller that scans more slowly than rows are logged gives the same output at rows without a scan in between.
    """
    f = one.filtering
    values = f.Y[:, f.signals.index(f.op_at(one.place))]
    moved = np.abs(np.diff(values)) > 0.0
    at = f.every * np.arange(len(values))
    found = []
    for period in range(2, min(SLOWEST, int(one.bounds["period"][1] / f.period)) + 1):
        idle = [np.diff((at - offset) // period) == 0 for offset in range(period)]
        known = [k for k, still in enumerate(idle) if moved[still].sum() <= STRAY * still.sum()]
        if known:
            found.append([{"period": f.period * period, "offset": f.period * k, "present": 1.0} for k in known])
    return found


def _load(plain: Found, one: Explanation) -> Filtered | None:
    """Return the best planned load that the innovations of the model as it is propose."""
    f, base = one.filtering, plain.best
    rows = f.time[:: f.every]
    at = f.skipped + (len(rows) - f.skipped) // 4
    pulse = _Pulse(f, one.effect, one.place, row=at)
    kicked = tried(pulse, base.values)
    if kicked is None or one.effect is None:
        return None
    h = np.nan_to_num((kicked.e - base.e)[at:] / _Pulse.size)
    found: list[Filtered | None] = []
    free = {key: base.values[key] for key in f.free}
    e, t = np.nan_to_num(base.judged), rows[f.skipped :]
    for guess in planned(one.effect, f.quiet, one.place, t, e, h, shortest=SHORTEST):
        values = {k: float(np.clip(v, *one.bounds[k])) for k, v in guess.items() if k in one.bounds}
        found.append(tried(one, {**free, **values}))
    return best_of(found)


@dataclass(frozen=True, eq=False)
class _Pulse(Explanation):
    """A load of 1 for one interval of the log, times ``size``."""

    row: int = 0
    size = 1e-3

    def wave(self, values):  # type: ignore[no-untyped-def]
        """Return the pulse."""
        f = self.filtering
        found = super().wave(values)
        found[self.row * f.every : (self.row + 1) * f.every] += self.size
        return found

"""What has changed between two times of one loop: of each change, the nats of a likelihood ratio.

    valve, process      what it gains that this part alone differs from the loops of the other time (``together``), in
                        the mean of both ways round
    stick at one time   what the loops of that time gain at the other one without their stick, or if more, the lesser of
                        its gain there and of what is against it at the other time; where they lose by it, it sticks at
                        both times
    controller          z^2 / 2,   z = ln(later / earlier) of K_p or T_i, read over the same rows, over its deviation
    noise, load         z^2 / 2,   the same of a spread; blocks of the record tell its deviation, and how long it lasts
    level               z^2 / 2,   the OP that it takes to hold PV, likewise; PV at another SP takes 1/K more
    named               where the ratio is beyond what counts: from ``ENOUGH`` nats; of valve and process the best one
                        alone

What counts keeps out what is sure but small, and a fitted part needs more: no plant is the model's, so that another
load makes another fit.  Noise, load and level are those that likely loops leave, changed or not: each has to show it.
Not known: whether OP goes for a sensor that is off or for a load that stays; two changes of valve and process at once.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from stickslip.logs.arrays import Values
from stickslip.logs.normal import Z90
from stickslip.remedy.change import COUNTS, Change, Changes
from stickslip.remedy.controller import Controller, controller_of
from stickslip.remedy.left import free_of_line
from stickslip.remedy.loop_fit import LoopFit
from stickslip.remedy.process import Loop
from stickslip.remedy.size import Size, size_of, widened
from stickslip.remedy.together import PARTS, Pair, Together

__all__ = ["changes", "lacks"]

ENOUGH = {  # nats; a part pays ln(rows)/2 for its value, as tempered nats, and a law is read off without a fit
    "controller_gain": 6.0, "controller_integral_time": 6.0, "sensor_noise": 10.0, "sensor_drift": 10.0,
    "disturbance": 10.0, **dict.fromkeys(PARTS, 20.0),
}  # fmt: skip
GONE = 10.0  # nats of a stick at one time alone, of which no size is fitted
ALIKE = 18.0  # nats by which a part may be behind the best one, to be named beside it
BLOCKS = 12  # of the records of a time
MISSED = 0.08  # of the way of the answer: 1 to 8 % were missed of loops whose load stood still
SHORT, SEEN = (400, 200, 100, 50, 25, 12), 4.0  # parts of a record in which loads go; times what is not known
MEMORY = 0.9  # most that a block may remember of the one before: twelve do not tell more
HABIT = 2.0  # standard deviations of how often SP is moved
LOOP = 0.2  # least gain of process and controller together: lambda of three lags, behind a dead time of two
BEYOND = 99.0  # the logarithm of a ratio to nothing


def changes(earlier: LoopFit, later: LoopFit) -> Changes:
    """Return what has changed between two fits of one loop.

    >>> from stickslip.remedy import fit
    >>> from stickslip.remedy.example import sticky
    >>> day = fit(sticky())
    >>> changes(day, day).gap
    False
    """
    pv, op, notes = later.pv_unit or "PV", later.op_unit, []
    apart = earlier.sticks != later.sticks
    pairs = [Pair(earlier, later, back) for back in ((later.sticks,) if apart else (False, True))]
    gone = pairs[0].gone() if apart else 0.0
    both = apart and gone <= 0.0  # a stick that one fit alone sees, and that the loops of this fit see at both times
    apart = apart and not both
    surer = {part: max(pairs, key=lambda pair: pair.gain(part)) for part in PARTS}
    # what moves PV where nothing else moves OP may be another load as well as another process
    hidden = "" if both else earlier.closed or later.closed
    gains = {part: 0.0 if hidden else _both_ways(part, pairs, surer[part]) for part in PARTS}
    moved = {part: _moved(part, surer[part]) for part in PARTS}
    if hidden:
        notes.append(f"The process is not compared: {hidden}.")
    if apart:  # one that rests all along may be as likely as one that is gone
        moved["stiction"] = math.copysign(BEYOND, later.sticks - 0.5)
        gains["stiction"] = max(gone, _stick_at_one_time(earlier, later))
    enough = dict(ENOUGH, **{"stiction": GONE} if gone >= GONE else {})
    best = max(gains, key=lambda part: gains[part])
    best = "stiction" if apart and gains["stiction"] >= enough["stiction"] else best  # each fit says so by itself
    likeliest = {part: surer[part].own[part] if part == best else surer[part].shared for part in PARTS}
    sizes = {part: _sizes(part, (earlier, later), one.loops) for part, one in likeliest.items()}
    if apart:
        sizes["stiction"] = [size_of(fit.each("S")) if fit.sticks else Size(0.0, 0.0, None) for fit in (earlier, later)]
    units = {"stiction": op, "process_gain": f"{pv} per {op}", "process_time_constant": "s", "dead_time": "s"}
    alike = tuple(part for part in PARTS if part != best and gains[part] > gains[best] - ALIKE)
    found = [
        _change(part, sizes[part], moved[part], gains[part], units[part], part == best, alike, enough[part])
        for part in PARTS
    ]  # fmt: skip
    scans = [fit.days[0].dt for fit in (earlier, later)]
    even = abs(scans[1] - scans[0]) <= 0.02 * scans[0]
    if even:
        spans = {fit.controller.span for fit in (earlier, later)}
        laws = [[_read(fit, span) for fit in (earlier, later)] for span in spans]
        for effect, unit in (("controller_gain", f"{op} per {pv}"), ("controller_integral_time", "s")):
            read = [one for each in laws if (one := _controller(effect, each, unit))]
            found += [_least(read)] if len(read) == len(laws) else []
    else:
        apart_by = f"The logs have rows every {scans[0]:g} and {scans[1]:g} s"
        notes.append(f"{apart_by}, so that controller, noise and load are not compared.")
    may_be = [part for part in PARTS if gains[part] > max(gains[best] - ALIKE, 0.0) or (apart and part == "stiction")]
    likely = [(pair, pair.own[part]) for pair in pairs for part in may_be]
    likely += [(pair, pair.shared) for pair in pairs if gains[best] < enough[best]]
    if even:
        found += [_least(each) for each in zip(*(_of_left(*one, pv) for one in likely), strict=True)]
    found.append(_level_of((earlier, later)))
    if not hidden and any(one.loops[0].integrating for _, one in likely):
        notes.append("The process integrates, so that a sensor that is off by a constant does not show.")
    if hidden:
        found = [replace(one, ambiguous_with=tuple(PARTS)[1:]) if one.effect == "disturbance" else one for one in found]
    notes += _set_points(earlier, later)
    surest = sorted(found, key=lambda one: (-one.changed, -one.nats))
    once = {one.effect: one for one in reversed(surest)}  # a load may move by its size or its level
    return Changes(tuple(one for one in surest if once[one.effect] is one), tuple(notes))


def _set_points(*fits: LoopFit) -> list[str]:
    """What is to be said where SP is moved more or less often: a habit, no change of the loop."""
    given = [[day.sp for day in fit.days if day.sp is not None] for fit in fits]
    if not all(given):
        return []
    moves = [sum(int(np.sum(np.diff(np.flatnonzero(np.diff(sp)), prepend=-9) > 1)) for sp in own) for own in given]
    hours = [fit.days[0].dt / 3600.0 * sum(map(len, own)) for fit, own in zip(fits, given, strict=True)]
    before, after = (n / h for n, h in zip(moves, hours, strict=True))
    unsure = math.sqrt(sum(max(n, 1) / h**2 for n, h in zip(moves, hours, strict=True)))
    said = f"SP is moved {after:.2g} times an hour, before {before:.2g}: another habit, which is no change of the loop."
    return [said] * (abs(after - before) > HABIT * unsure)


def lacks(found: LoopFit) -> Changes:
    """Return what a loop without stick lacks to tell this record: the stick, or nothing."""
    none, ratio = Size(0.0, 0.0, 0.0), Size(None, None, None, "none before")
    probability = 1.0 / (1.0 + math.exp(-min(max(found.gain, -50.0), 50.0) + 10.0))
    stick = Change("stiction", none, found.S, ratio, max(found.gain, 0.0), probability, found.sticks, found.op_unit)
    note = f"A loop with stick predicts PV better than one without by {found.gain:.0f} nats."
    return Changes((stick,), (note,), of_one=True)


def _sizes(part: str, fits: Sequence[LoopFit], loops: Sequence[Loop]) -> list[Size]:
    """A part at both times as the likely ``loops`` have it, with the interval of each time's own fit about it."""
    found = []
    for fit, one in zip(fits, loops, strict=True):
        own, value = size_of(np.array([_value(part, each) for each in fit.loops]), zero=True), _value(part, one)
        found.append(Size(value, min(own.low or 0.0, value), max(own.high or 0.0, value)))
    return found


def _change(
    effect: str, sizes: Sequence[Size], by: float, nats: float, unit: str, may: bool = True,
    ambiguous_with: tuple[str, ...] = (), enough: float = 0.0,
) -> Change:  # fmt: skip
    """A change ``by`` a logarithm or a share that gains so many nats; ``may``: whether it may be named; ``enough``
    nats in place of those of ``ENOUGH``.
    """
    nats, counts, enough = max(nats, 0.0), COUNTS[effect], enough or ENOUGH[effect]
    sd = abs(by) / math.sqrt(2.0 * nats) if nats > 0.0 else math.inf  # as far as a normal value would gain it
    far = 0.5 * math.erfc((counts - abs(by)) / (math.sqrt(2.0) * max(sd, 1e-9))) if math.isfinite(sd) else 0.0
    probability = far / (1.0 + math.exp(min(enough - nats, 50.0)))
    ratio = Size(None, None, None, "a level has no ratio, and none has what is at one time alone")
    if effect != "sensor_drift" and min(one.value or 0.0 for one in sizes) > 0.0:
        low, middle, high = (math.exp(min(max(by + z * min(sd, 99.0), -99.0), 99.0)) for z in (-Z90, 0.0, Z90))
        ratio = Size(middle, low, high)
    changed = may and nats >= enough and abs(by) > counts
    alike = ambiguous_with if changed else ()
    return Change(effect, sizes[0], sizes[1], ratio, nats, probability, changed, unit, alike)


def _stick_at_one_time(earlier: LoopFit, later: LoopFit) -> float:
    """How surely one time has a stick that the other one has not, by each time's own fit [nats]."""
    sticky, free = (earlier, later) if earlier.sticks else (later, earlier)
    return min(sticky.gain, free.against(float(np.percentile(sticky.each("S"), 5.0))))


def _both_ways(part: str, pairs: Sequence[Pair], surer: Pair) -> float:
    """What a part gains in the mean of both ways round; what moves the other way speaks against it."""
    way = _moved(part, surer)
    gains = [pair.gain(part) if way * _moved(part, pair) > 0.0 else -abs(pair.gain(part)) for pair in pairs]
    return sum(gains) / len(gains)


def _moved(part: str, pair: Pair) -> float:
    """ln(later / earlier) of a part; of a dead time, of all that is late beside the main lag."""
    late = part == "dead_time"
    before, after = (max(_value(part, one) + late * (one.tau_2 + pair.scan), 1e-300) for one in pair.own[part].loops)
    return math.log(after / before)


def _value(part: str, one: Loop) -> float:
    lags = one.tau_2 + (0.0 if one.integrating else one.tau)
    return {
        "stiction": one.S, "process_gain": abs(one.K), "process_time_constant": lags, "dead_time": one.theta
    }[part]  # fmt: skip


def _read(fit: LoopFit, span: int) -> Controller:
    """The controller of a time, read over ``span`` rows; one that is not quite its law reads otherwise over others."""
    law, main = fit.controller, max(fit.days, key=lambda day: len(day.op))
    return law if span == law.span else controller_of(main.op, main.pv, main.sp, main.dt, (law.low, law.high), (span,))


def _controller(effect: str, laws: Sequence[Controller], unit: str) -> Change | None:
    """The change of K_p or T_i; None where there is no integral."""
    key, at = ("K_p", 0) if effect == "controller_gain" else ("T_i", 1)
    values = [abs(law.middle[at]) for law in laws]
    if not np.isfinite(values).all():
        return None
    scales = [value / abs(float(getattr(law, key))) for value, law in zip(values, laws, strict=True)]
    ends = [sorted(scale * abs(end) for end in law.spread(key)) for scale, law in zip(scales, laws, strict=True)]
    shares = [(high - low) / (2.0 * Z90) / value for value, (low, high) in zip(values, ends, strict=True)]
    sizes = [Size(value, low, high) for value, (low, high) in zip(values, ends, strict=True)]
    by = math.log(values[1] / values[0])
    return _change(effect, sizes, by, 0.5 * by**2 / (sum(share**2 for share in shares) + 1e-6), unit)


def _of_left(pair: Pair, likely: Together, unit: str) -> list[Change]:
    """Noise and load, by what these loops leave of PV."""
    before, after = (abs(one.K) + 1e-300 for one in likely.loops)
    loads, answers = pair.lefts(likely)
    least = MISSED**2 * max(float(np.mean(_fine(own))) for own in answers)
    fine = [np.maximum(_fine(own), least) for own in loads]
    roots = 1 + likely.loops[0].integrating
    slow = _slow(loads, answers, [float(np.mean(one)) for one in fine], roots)
    return [_spread("sensor_noise", fine, unit), _spread("disturbance", slow, unit, math.log(after / before))]


def _level_of(fits: Sequence[LoopFit]) -> Change:
    """What OP it takes to hold PV, with each gain of the process that may be.

    A gain that is not known is from ``LOOP`` over that of the controller on.  Behind an integrator no level of PV asks
    for a flow, so that OP alone tells a load.  A stem that sticks may stand up to S/2 beside OP.
    """
    most, days = fits[1].controller.K_p / LOOP, [fit.days for fit in fits]
    known = [fit for fit in fits if not fit.closed]
    likely = [0.0 if one.integrating else 1.0 / (abs(one.K) + 1e-300) for fit in known for one in fit.loops]
    rates = np.clip(widened(np.minimum(likely or [0.0, math.inf], abs(most))), 0.0, abs(most))
    effect, alike = "sensor_drift", ("disturbance", "process_gain")[: 1 + (not known)]
    if not rates.any():
        effect, alike = "disturbance", ()
    middle, ends = float(np.mean([day.pv.mean() for own in days for day in own])), np.percentile(rates, [5.0, 95.0])
    ways = [
        [[day.op - math.copysign(end, most) * (day.pv - middle) for day in own] for own in days] for end in ends
    ]  # fmt: skip
    beside = max(0.5 * float(np.median(fit.each("S"))) for fit in fits)
    return _least([_level(effect, way, fits[1].op_unit, alike, beside) for way in ways])


def _least(found: Sequence[Change]) -> Change:
    """The least sure of one change by several likely loops; it is not named where they do not agree which way."""
    least = min(found, key=lambda one: one.nats)
    agree = len({(one.later.value or 0.0) > (one.earlier.value or 0.0) for one in found}) == 1
    return least if agree else replace(least, changed=False)


def _blocks(one: Values) -> list[Values]:
    return [np.asarray(block) for block in np.array_split(one, BLOCKS)]


def _fine(lefts: Sequence[Values]) -> Values:
    """Squares (blocks,) of what differs from row to row: third differences, which a slower signal does not pass."""
    return np.concatenate(
        [[(float(np.median(np.abs(np.diff(b, 3)))) / 3.0) ** 2 for b in _blocks(one)] for one in lefts]
    )  # fmt: skip


def _slow(
    lefts: Sequence[Sequence[Values]], answers: Sequence[Sequence[Values]], noises: Sequence[float], roots: int = 1
) -> list[Values]:
    """Mean squares (blocks,) of how far each time goes, without the share of its noise, in the ``SHORT`` that shows it.

    That is the least time in which both go beyond ``SEEN`` times what is not known: what is small beside the larger
    noise of both, or beside the way of the answer to the stem, of which no loop tells all.  Behind an integrator, of
    two ``roots``, a load that stays goes on and on: what counts there is by how much a way differs from the one before.
    """
    rows, share = min(len(one) for own in lefts for one in own), math.comb(2 * roots, roots)
    for part in SHORT:
        squares, missed = (
            [[_ways(one, max(rows // part, 1), roots) ** 2 for one in own] for own in each] for each in (lefts, answers)
        )
        far, answered = ([np.mean([np.mean(one) for one in own]) for own in each] for each in (squares, missed))
        least = max(0.1 * max(noises), MISSED**2 * float(max(answered)))
        if min(far) > SEEN * (share * max(noises) + least):
            break
    return [
        np.maximum([float(b.mean()) - share * noise for one in own for b in _blocks(one)], least)
        for own, noise in zip(squares, noises, strict=True)
    ]


def _ways(one: Values, between: int, roots: int) -> Values:
    """How far a signal goes between two turns; of two roots, by how much that differs from the way before."""
    for _ in range(roots):
        one = one[between:] - one[:-between]
    return one


def _spread(effect: str, squares: Sequence[Values], unit: str, beside: float = 0.0) -> Change:
    """The change of a spread whose squares (blocks,) are known at both times, by the mean of their logarithms.

    ``beside`` [logarithm] may be the gain's: a load at the valve goes with it, one at PV does not.
    """
    logs = [0.5 * np.log(one + 1e-300) for one in squares]
    means = [float(one.mean()) for one in logs]
    unsure = _unsure([one - mean for one, mean in zip(logs, means, strict=True)])
    variance = sum(unsure) + 1e-6
    by = means[1] - means[0]
    by = 0.0 if by * (by - beside) <= 0.0 else min(by, by - beside, key=abs)
    far = [Z90 * math.sqrt(own) for own in unsure]
    sizes = [Size(math.exp(x), math.exp(x - off), math.exp(x + off)) for x, off in zip(means, far, strict=True)]
    return _change(effect, sizes, by, 0.5 * by**2 / variance, unit)


def _level(
    effect: str, signals: Sequence[Sequence[Values]], unit: str, alike: tuple[str, ...], beside: float
) -> Change:
    """The change of a level beyond ``beside``; later about a line, or a drift would count against itself."""
    blocks = [np.concatenate([[float(b.mean()) for b in _blocks(one)] for one in own]) for own in signals]
    before, after = (float(one.mean()) for one in blocks)
    unsure = _unsure([blocks[0] - before, free_of_line(blocks[1])[0]])
    rows = [np.concatenate(list(signals[0])), np.concatenate([free_of_line(one)[0] for one in signals[1]])]
    spread = math.sqrt(0.5 * sum(float(np.var(one)) for one in rows)) + 1e-300
    moved = math.copysign(max(abs(after - before) - beside, 0.0), after - before)
    by, nats = moved / spread, 0.5 * moved**2 / (sum(unsure) + 1e-300)
    far = [Z90 * math.sqrt(own) for own in unsure]
    sizes = [Size(level, level - off, level + off) for level, off in zip((before, after), far, strict=True)]
    return _change(effect, sizes, by, nats, unit, True, alike)


def _unsure(times: Sequence[Values]) -> list[float]:
    """The variance of the mean of each time's blocks, which remember the one before.

        var(mean) = v (1 + r) / (1 - r) / blocks,    v and r = correlation of neighbours, of both times together

    The r of few blocks is too small by (1 + 3 r) / blocks (M. G. Kendall, Biometrika 41 (1954) 403-404).
    """
    squares = sum(float(one @ one) for one in times) + 1e-300
    r = sum(float(one[1:] @ one[:-1]) for one in times) / squares
    r = min(max(r + (1.0 + 3.0 * r) / len(times[0]), 0.0), MEMORY)
    v = squares / (sum(map(len, times)) - len(times))
    return [v * (1.0 + r) / (1.0 - r) / len(one) for one in times]

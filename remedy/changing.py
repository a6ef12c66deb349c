"""What has changed between two times of one loop: of each change, the nats of a likelihood ratio.

    valve, process      what it gains that this part alone differs from the loops of the other time (``together``), in
                        the mean of both ways round
    stick at one time   or, if more, the lesser of its gain there and of what is against such a stick at the other time
    controller          z^2 / 2,   z = ln(later / earlier) of K_p or T_i as read, over its standard deviation
    noise, load, level  z^2 / 2,   the same of a spread, or a difference; blocks of the record tell its deviation
    named               where the ratio is beyond what counts: from ``ENOUGH`` nats, or as many as ``FROM_FIT`` says;
                        of valve and process the best one alone

What counts keeps out what is sure but small, and a fitted part needs more: no plant is the model's, so that another
load makes another fit.  Noise, load and level are those that likely loops leave, changed or not: each has to show it.
Not known: whether PV moves beside the flow of the valve by its sensor or by a load that stays; two changes of valve and
process at once.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from stickslip.logs.arrays import Values
from stickslip.logs.normal import Z90
from stickslip.remedy.change import COUNTS, Change, Changes
from stickslip.remedy.left import free_of_line
from stickslip.remedy.loop_fit import LoopFit
from stickslip.remedy.process import Loop
from stickslip.remedy.size import Size, size_of
from stickslip.remedy.together import PARTS, Pair, Together

__all__ = ["changes", "lacks"]

ENOUGH = 10.0  # nats
FROM_FIT = {"disturbance": 15.0, **dict.fromkeys(PARTS, 20.0)}  # a part pays ln(rows)/2 for its value, as tempered nats
ALIKE = 18.0  # nats by which a part may be behind the best one, to be named beside it
BLOCKS = 12  # of the records of a time
MISSED = 0.08  # of the way of the answer: 1 to 8 % were missed of loops whose load stood still
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
    surer = {part: max(pairs, key=lambda pair: pair.gain(part)) for part in PARTS}
    hidden = earlier.closed and later.closed  # what moves PV then may be another load as well as another process
    gains = {part: 0.0 if hidden else _both_ways(part, pairs, surer[part]) for part in PARTS}
    moved = {part: _moved(part, surer[part]) for part in PARTS}
    if hidden:
        notes.append(f"The process is not compared: {hidden}.")
    if apart:  # one that rests all along may be as likely as one that is gone
        moved["stiction"] = math.copysign(BEYOND, later.sticks - 0.5)
        gains["stiction"] = max(gains["stiction"], _stick_at_one_time(earlier, later))
    best = max(gains, key=lambda part: gains[part])
    best = "stiction" if apart and gains["stiction"] >= FROM_FIT["stiction"] else best  # each fit says so by itself
    likeliest = {part: surer[part].own[part] if part == best else surer[part].shared for part in PARTS}
    sizes = {part: _sizes(part, (earlier, later), one.loops) for part, one in likeliest.items()}
    if apart:
        sizes["stiction"] = [size_of(fit.each("S")) if fit.sticks else Size(0.0, 0.0, None) for fit in (earlier, later)]
    units = {"stiction": op, "process_gain": f"{pv} per {op}", "process_time_constant": "s", "dead_time": "s"}
    alike = tuple(part for part in PARTS if part != best and gains[part] > gains[best] - ALIKE)
    found: list[Change | None] = [
        _change(part, sizes[part], moved[part], gains[part], units[part], part == best, alike) for part in PARTS
    ]  # fmt: skip
    scans = [fit.days[0].dt for fit in (earlier, later)]
    even = abs(scans[1] - scans[0]) <= 0.02 * scans[0]
    if even:
        found += [_controller("controller_gain", earlier, later, f"{op} per {pv}")]
        found += [_controller("controller_integral_time", earlier, later, "s")]
    else:
        apart_by = f"The logs have rows every {scans[0]:g} and {scans[1]:g} s"
        notes.append(f"{apart_by}, so that controller, noise and load are not compared.")
    may_be = [part for part in PARTS if gains[part] > max(gains[best] - ALIKE, 0.0) or (apart and part == "stiction")]
    likely = [(pair, pair.own[part]) for pair in pairs for part in may_be]
    likely += [(pair, pair.shared) for pair in pairs if gains[best] < FROM_FIT[best]]
    left = [_least(each) for each in zip(*(_of_left(*one, pv) for one in likely), strict=False)]
    found += left if even else left[2:]
    if not hidden and any(one.loops[0].integrating for _, one in likely):
        notes.append("The process integrates, so that a sensor that is off by a constant does not show.")
    compared = [one for one in found if one is not None]
    return Changes(tuple(sorted(compared, key=lambda one: (-one.changed, -one.nats))), tuple(notes))


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
    ambiguous_with: tuple[str, ...] = (),
) -> Change:  # fmt: skip
    """A change ``by`` a logarithm or a share that gains so many nats; ``may``: whether it may be named."""
    nats, counts, enough = max(nats, 0.0), COUNTS[effect], FROM_FIT.get(effect, ENOUGH)
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
    """How surely one time has a stick that the other one has not [nats]."""
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


def _controller(effect: str, earlier: LoopFit, later: LoopFit, unit: str) -> Change | None:
    """The change of K_p or T_i; None where there is no integral."""
    key, variance = "K_p" if effect == "controller_gain" else "T_i", 1e-6
    sizes: list[Size] = []
    for fit in (earlier, later):
        value = abs(float(getattr(fit.controller, key)))
        if not math.isfinite(value):
            return None
        low, high = sorted(abs(end) for end in fit.controller.spread(key))
        sizes.append(Size(value, low, high))
        variance += ((high - low) / (2.0 * Z90) / value) ** 2
    before, after = (abs(float(getattr(fit.controller, key))) for fit in (earlier, later))
    by = math.log(after / before)
    return _change(effect, sizes, by, 0.5 * by**2 / variance, unit)


def _of_left(pair: Pair, likely: Together, unit: str) -> list[Change]:
    """Noise, load and, of a process that settles, level of PV, by what these loops leave."""
    integrating = likely.loops[0].integrating
    before, after = (abs(one.K) + 1e-300 for one in likely.loops)
    loads = pair.lefts(likely, own=True)
    answers = pair.answers(loads)
    least = MISSED**2 * max(float(np.mean(_fine(own))) for own in answers)
    fine = [np.maximum(_fine(own), least) for own in loads]
    slow = _slow(loads, answers, pair.between, [float(np.mean(one)) for one in fine], 1 + integrating)
    found = [_spread("sensor_noise", fine, unit), _spread("disturbance", slow, unit, math.log(after / before))]
    return found if integrating else [*found, _level(pair.lefts(likely), unit)]


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
    lefts: Sequence[Sequence[Values]], answers: Sequence[Sequence[Values]], between: int, noises: Sequence[float],
    roots: int = 1,
) -> list[Values]:  # fmt: skip
    """Mean squares (blocks,) of how far each time goes between two turns of OP, without the share of its noise.

    What is small beside the larger noise of both times is not known, and taken for the same; so is what is small beside
    the way of the answer to the stem, of which no loop tells all.  Behind an integrator, of two ``roots``, a load that
    stays goes on and on: what counts there is by how much a way differs from the one before.
    """
    squares = [[_ways(one, between, roots) ** 2 for one in own] for own in lefts]
    missed = [np.mean([np.mean(_ways(one, between, roots) ** 2) for one in own]) for own in answers]
    least = max(0.1 * max(noises), MISSED**2 * float(max(missed)))
    return [
        np.maximum([float(b.mean()) - math.comb(2 * roots, roots) * noise for one in own for b in _blocks(one)], least)
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
    unsure = [float(np.var(one)) / len(one) for one in logs]
    variance, means = sum(unsure) + 1e-6, [float(one.mean()) for one in logs]
    by = means[1] - means[0]
    by = 0.0 if by * (by - beside) <= 0.0 else min(by, by - beside, key=abs)
    far = [Z90 * math.sqrt(own) for own in unsure]
    sizes = [Size(math.exp(x), math.exp(x - off), math.exp(x + off)) for x, off in zip(means, far, strict=True)]
    return _change(effect, sizes, by, 0.5 * by**2 / variance, unit)


def _level(lefts: Sequence[Sequence[Values]], unit: str) -> Change:
    """The change of PV's level beside the flow, over what the level of a block varies by: loads may stay for long.

    At the later time about a line, or a drift would count against itself.
    """
    levels = [np.concatenate([[float(b.mean()) for b in _blocks(one)] for one in own]) for own in lefts]
    before, after = (float(one.mean()) for one in levels)
    variance = max(float(np.var(levels[0])), float(np.var(free_of_line(levels[1])[0]))) + 1e-300
    spread = float(np.std(np.concatenate(list(lefts[0])))) + 1e-300
    by, nats = (after - before) / spread, 0.5 * (after - before) ** 2 / variance
    far = Z90 * math.sqrt(variance)
    sizes = [Size(level, level - far, level + far) for level in (before, after)]
    return _change("sensor_drift", sizes, by, nats, unit, True, ("disturbance",))

"""The sizes of an effect that are looked at first, before anything is fitted."""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
from stickslip.blocks.recorded import Recorded
from stickslip.diagram.diagram import Diagram
from stickslip.gap.effects.scan_time import ScanTime
from stickslip.gap.effects.valve_characteristic import flow_at
from stickslip.gap.fits.loads import is_load, planned, trimmed
from stickslip.gap.fits.scans import first_scans
from stickslip.gap.insertion.about import FactorAbout
from stickslip.gap.insertion.added import with_added
from stickslip.gap.insertion.inserted import percent_out
from stickslip.gap.insertion.paths import given
from stickslip.gap.insertion.scales import ends
from stickslip.gap.likelihood.fit import Fit, tried
from stickslip.gap.likelihood.hypothesis import Hypothesis
from stickslip.gap.likelihood.statement import BEYOND
from stickslip.logs.arrays import Values

FACTORS = (0.75, 0.92, 0.97, 1.03, 1.08, 1.33)  # sizes of a factor that are tried
SHARES = (0.02, 0.1, 0.4)  # of the range, to both sides of neutral
SIZES, APART = 5, 3.0  # of a size whose neutral value is none at all, at least, and their ratio, at most
WIDE, FAR = (0.3, 0.75, 1.33, 3.0, 10.0, 30.0), 100.0  # the same where its bounds are this far apart
OPEN = (0.02, 1.0)  # openings at which the flow of a model may be right
CUT = (0.0, 0.002, 0.005, 0.01, 0.03, 0.1, 0.4)  # shares of the rows of OP that a limit would cut
EVEN = 1e-6  # share of an interval by which a scan may differ from it
FURTHER = (0.0, 0.2, 0.5, 1.0)  # shares of what a signal may go further between two rows
SLOWER = (*range(2, 13), 15, 20, 30, 60)  # times the model's scan
AT_LEAST = 0.5  # of the share of rows at which an output stands still that scans as seldom
FIRSTS = 4  # first scans of each that are tried, at most, where each costs a run of the diagram
STANDS = 3  # rows at which a signal stands at its limit, at least
CALM = 4.0  # standard deviations from which on innovations propose no load


def sizes(null: Fit, one: Hypothesis) -> list[dict[str, float]]:
    """Return the sizes of an effect to look at first."""
    effect = one.effect
    assert effect is not None
    if is_load(effect):
        return _loads(null, one)
    if isinstance(effect, ScanTime):
        return _scans(null, one)
    if one.level:
        return _level(one)
    if one.bends:
        return _limits(one)
    if effect.hidden:  # a stem, which jumps or does not: the first parameter is its band
        size, *jump = one.own
        return [{size: band, **dict.fromkeys(jump, 0.0)} for band in np.geomspace(*one.bounds[size], SIZES + 2)[1:-1]]
    found: list[dict[str, float]] = [{}]
    for p in effect.parameters:
        if p.nuisance or p.name == effect.level:
            continue
        low, high = one.bounds[p.name]
        nominal = one.nominal[p.name]
        if p.spacing == "log" and low < nominal < high:
            several = [nominal * by for by in (WIDE if high / low > FAR else FACTORS)]
        elif p.spacing == "log":
            count = max(SIZES, math.ceil(math.log(high / low) / math.log(APART)))
            several = np.geomspace(low, high, count + 2)[1:-1].tolist()
        else:
            start = nominal if math.isfinite(nominal) else low
            several = [start + way * share * (high - low) for share in SHARES for way in (1.0, -1.0)]
        kept = [v for v in several if low <= v <= high]
        found = [{**before, p.name: v} for before in found for v in kept] if kept else found
    return [size for size in found if size]


def _scans(null: Fit, one: Hypothesis) -> list[dict[str, float]]:
    """Return scans that the model's controller does not have, none so slow that its output would stand still more."""
    f, own = one.frame, one.nominal["period"]
    signal = str(f.model[one.place].output_labels[0])
    values = f.Y[:, f.signals.index(signal)] if signal in f.signals else np.full(len(f.Y), np.nan)
    good = np.isfinite(values)
    found = first_scans(f.record.log.t[good], values[good], own, f.record.log.dt, one.bounds["period"])
    if f.scans is not None:
        found += [
            {"period": own * k, "offset": f.scans.period * offset, "present": present}
            for k in SLOWER
            for offset in _firsts(round(own * k / f.scans.period), null.best.gains is None)
            for present in (1.0, 0.0)
        ]
    still = float(np.mean(np.diff(values[good]) == 0.0)) if good.sum() > 1 else 0.0
    return [
        size for size in found
        if size["period"] != own and still >= AT_LEAST * (1.0 - f.record.log.dt / size["period"])
    ]  # fmt: skip


def _level(one: Hypothesis) -> list[dict[str, float]]:
    """Return sizes of an effect that leaves its signal the level at which it stands in the middle of the log."""
    model, effect, place = one.frame.model, one.effect, one.place
    middle = _middle(one, effect.signal(model, place) if isinstance(effect, FactorAbout) else given(model, place))
    if middle is None:
        return []
    if isinstance(effect, FactorAbout):
        at = float(np.clip(middle / effect.unit_of(model, place), *one.bounds["at"]))
        return [{"factor": factor, "at": at} for factor in FACTORS]
    x = float(np.clip(middle / (100.0 * percent_out(model, place)), *OPEN))
    return [{"rangeability": R, "flow": x / flow_at(x, R)} for R in WIDE]


def _middle(one: Hypothesis, signal: str) -> float | None:
    """Return where a signal stands in the middle of the log, by itself or by OP; None if no span or log says so."""
    f = one.frame
    within = ends(f.model, signal) if signal else None
    if within is None:
        return None
    if signal in f.signals:
        return float(np.nanmedian(f.Y[:, f.signals.index(signal)]))
    entering = [s for s in map(str, f.model[one.place].input_labels) if s in f.ops]
    op = next(iter(entering or f.ops), "")
    of_OP = f.model.signal_spans.get(op)
    if of_OP is None:
        return None
    share = (float(np.nanmedian(f.Y[:, f.signals.index(op)])) - of_OP[0]) / (of_OP[1] - of_OP[0])
    return within[0] + share * (within[1] - within[0])


def _firsts(count: int, exact: bool) -> list[int]:
    """Return which of so many first scans are tried: all where a linear filter, which takes little time, serves.

    >>> _firsts(2, False), _firsts(60, False)
    ([0, 1], [0, 15, 30, 45])
    """
    few = count if exact else min(count, FIRSTS)
    return [count * k // few for k in range(few)]


def _limits(one: Hypothesis) -> list[dict[str, float]]:
    """Return limits where OP stands or stood: of a valve, or of a controller."""
    f, (shown, values, zero, to_unit) = one.frame, one.reached
    if not shown:
        return []
    own = [str(s) for s in f.model[one.place].output_labels]
    unseen = f.scanned < (1.0 - EVEN) * f.record.log.dt
    found = []
    for share in (CUT[0],) if shown in own else CUT:
        k = int(share * (len(values) - 1))
        for name, end in (("low", values[k]), ("high", values[-1 - k])):
            if shown not in own or np.count_nonzero(values == end) >= STANDS:  # what is logged shows its limits
                found.append({name: (end - zero) * to_unit})
            elif unseen:  # but those that it meets between two rows only
                out = (-BEYOND if name == "low" else BEYOND) * float(np.ptp(values))
                found += [{name: (end + by * out - zero) * to_unit} for by in FURTHER]
    inside = [{k: float(v) for k, v in size.items() if one.bounds[k][0] < v < one.bounds[k][1]} for size in found]
    return [size for size in inside if size]


def _loads(null: Fit, one: Hypothesis) -> list[dict[str, float]]:
    """Return the planned loads that the innovations of the model propose."""
    f = one.frame
    h = response(null, one.place, max(0.05 * abs(one.bounds["amplitude"][1]), 1e-9))
    if h is None:
        return []
    t, first = f.record.log.t, f.skipped
    left = null.best.e[first:]
    several = trimmed(left) if f.replays else [np.clip(np.nan_to_num(left), -CALM, CALM)]
    guesses = [g for e in several for g in planned(one.effect, f.quiet, one.place, t[first:], e, h)]
    return [{k: float(np.clip(v, *one.bounds[k])) for k, v in guess.items() if k in one.bounds} for guess in guesses]


def response(null: Fit, place: str, size: float, hold: Literal["previous", "linear"] = "previous") -> Values | None:
    """Return how innovations answer a load of 1 in one interval of the log at a place, (rows from then on, signals).

    A load of ``size`` is put in. It is held from row to row, or joined by straight lines (``hold``); None where nothing
    answers.
    """
    f = null.hypothesis.frame
    t, first = f.record.log.t, f.skipped
    at = first + (len(t) - first) // 4
    signal = str(f.model[place].output_labels[0])
    push = np.zeros(len(t))
    push[at] = size
    pushed = with_added(f.model, signal, Recorded("wave", t, push, hold=hold), f"{place}:pulse")
    moved = tried(_Kicked(f, kicked=pushed), null.best.values, null.best)
    if moved is None:
        return None
    begins = at - (1 if hold == "linear" else 0)  # what is joined by lines rises from the row before
    h = np.nan_to_num((moved.e - null.best.e) / size)[begins:]
    return h if np.abs(h).max(initial=0.0) > 0.0 else None


@dataclass(frozen=True, eq=False)
class _Kicked(Hypothesis):
    """The model with a wave added to a signal."""

    kicked: Diagram | None = None

    @cached_property
    def changed(self) -> Diagram:
        """The model with the wave."""
        return self.kicked or self.frame.model

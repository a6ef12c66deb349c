"""Facts about a record that decide whether a method may look at it: each with its number and its limit.

A fact is measured first and judged second: ``Fact.present`` compares the value with the limit, and the text
quotes both, so that a refusal can say "OP sits at a limit in 23 % of the samples (10 % allowed)".
"""

import numpy as np
import numpy.typing as npt
from stickslip.detect.health.drawn import controlled_as_logged, drawn
from stickslip.detect.health.fact import Fact
from stickslip.detect.health.final_element import no_valve
from stickslip.detect.health.in_charge import asleep, copied, untracked
from stickslip.detect.health.response import frozen, unresponsive
from stickslip.detect.health.stale import held, stale
from stickslip.detect.signals.order import percentile
from stickslip.detect.verdict import Code
from stickslip.logs import LoopRecord
from stickslip.logs.arrays import Values
from stickslip.logs.modes import CASCADE

UNSATURATED = "Log a stretch with OP away from its limits."
SLAVE_SHARE = 0.5  # of the samples at which SP moves at all: a master does that, no operator


def examine(record: LoopRecord) -> tuple[Fact, ...]:
    """Every fact of a record, in the order in which a method should refuse.

    >>> t = np.arange(100.0)
    >>> loop = LoopRecord.from_arrays(t, pv=0 * t + 4, op=50 + np.sin(t / 5), sp=0 * t + 4)
    >>> [fact.code for fact in examine(loop) if fact.present]
    ['constant_signal']
    """
    first = (no_valve(record), manual(record), missing(record), beyond_reason(record))
    if first[-1].present:
        return first  # of such numbers nothing else can be worked out
    return (
        *first, constant(record, "PV"), constant(record, "OP"), asleep(record), frozen(record), copied(record),
        unresponsive(record), stale(record), saturated(record), set_point(record), quantised(record),
        compressed(record), untracked(record),
    )  # fmt: skip


def manual(record: LoopRecord, limit: float = 0.5) -> Fact:
    """Share of samples in manual mode, when a mode is logged."""
    if record.mode is None:
        return Fact("manual_mode", False, 0.0, limit, "The mode is not logged.", judged=False)
    known = np.isfinite(record.mode)
    share = float(np.mean(record.mode[known] < 1)) if known.any() else 0.0
    text = f"The controller is in manual in {share:.0%} of the samples."
    return Fact("manual_mode", share > limit, share, limit, text)


def missing(record: LoopRecord, limit: float = 0.5) -> Fact:
    """Share of samples where PV, OP or SP is missing or marked bad (manual and stale ones are counted elsewhere)."""
    bad = ~(record.log.good(record.pv_name) & record.log.good(record.op_name))
    if record.sp_name is not None:
        bad |= ~record.log.good(record.sp_name)
    if bad.any() and stale(record).present:
        bad &= ~held(record)
    share = float(np.mean(bad))
    text = f"PV, OP or SP is missing or bad in {share:.0%} of the samples ({limit:.0%} allowed)."
    return Fact("signal_missing", share > limit, share, limit, text)


def beyond_reason(record: LoopRecord, limit: float = 1e100) -> Fact:
    """Return whether a number is so large that its square is none: no measurement and no clock gives it."""
    signals = {"time": record.t, "PV": _good(record, record.pv), "OP": _good(record, record.op)}
    largest = {name: float(np.max(np.abs(x))) if len(x) else 0.0 for name, x in signals.items()}
    name = max(largest, key=lambda key: largest[key])
    present = largest[name] > limit
    text = (
        f"{name} reaches {largest[name]:.3g}, which no plant measures: look at its unit and at the columns read."
        if present
        else f"No number is beyond {limit:g}."
    )
    return Fact("signal_missing", present, largest[name], limit, text)


def constant(record: LoopRecord, signal: str = "PV") -> Fact:
    """Whether PV or OP never moves: peak-to-peak below 1e-9 of its largest value."""
    x = _good(record, record.pv if signal == "PV" else record.op)
    span = float(np.ptp(x)) if len(x) else 0.0
    limit = 1e-9 * float(np.max(np.abs(x))) if len(x) else 0.0
    code: Code = "constant_signal" if signal == "PV" else "manual_mode"
    if len(x) == 0:
        return Fact(code, False, 0.0, 0.0, f"{signal} has no good sample.", judged=False)
    if span <= limit:
        why = (
            "a frozen or dead measurement (or a model at rest)"
            if signal == "PV"
            else "the loop is in manual or OP is frozen"
        )
        return Fact(code, True, span, limit, f"{signal} stays at {x[0]:.6g} over {len(x)} samples: {why}.")
    return Fact(code, False, span, limit, f"{signal} moves by {span:.4g}.")


def saturated(record: LoopRecord, limit: float = 0.10) -> Fact:
    """Share of samples with OP within 0.5 % of an end of its span.

    When the span is unknown, the share of samples that stand exactly at the record's own extreme is taken.
    """
    op = record.op_percent
    if op is not None:
        op = _good(record, op)
        share = float(np.mean((op <= 0.5) | (op >= 99.5))) if len(op) else 0.0
        text = f"OP sits at an end of its span in {share:.0%} of the samples ({limit:.0%} allowed)."
        return Fact("op_saturated", share > limit, share, limit, text, UNSATURATED)
    x = _good(record, record.op)
    if len(x) == 0:
        return Fact("op_saturated", False, 0.0, limit, "OP has no good sample.", judged=False)
    edge = 1e-6 * float(np.ptp(x))
    share = float(max(np.mean(x <= np.min(x) + edge), np.mean(x >= np.max(x) - edge)))
    clipped = 2 * limit
    text = (
        f"The span of OP is not known; OP stands at its own extreme in {share:.0%} of the samples "
        f"({clipped:.0%} taken as a limit reached)."
    )
    return Fact("op_saturated", bool(share > clipped and np.ptp(x) > 0), share, clipped, text, UNSATURATED)


def set_point(record: LoopRecord, limit: float = 0.05) -> Fact:
    """Share of samples at which SP has moved on by more than 5 % of the standard deviation of e.

    A set point that moves a few times cuts the record into pieces; one that keeps moving (cascade, operator
    ramp) forces the loop, and the wave is no longer the loop's own.
    """
    if record.sp is None or record.e is None:
        return Fact("sp_not_constant", False, 0.0, limit, "SP is not logged.", judged=False)
    sp, e = _good(record, record.sp), _good(record, record.e)
    if len(sp) < 2:
        return Fact("sp_not_constant", False, 0.0, limit, "SP has fewer than two good samples.", judged=False)
    moves = len(set_point_moves(sp, e))
    share = moves / (len(sp) - 1)
    text = (
        f"SP moves at {moves} of {len(sp)} samples, by {float(np.ptp(sp)):.4g} in all."
        if moves
        else f"SP stands over all {len(sp)} samples."
    )
    remedy = "Log a stretch with a fixed set point."
    cascade = record.mode is not None and float(np.mean(record.mode[record.good] == CASCADE)) > 0.5
    if share > limit and (cascade or float(np.mean(np.diff(sp) != 0.0)) > SLAVE_SHARE):
        text = f"{text.removesuffix('.')}: the slave of a cascade, whose master makes the wave."
        remedy = "Judge the master too, or log the slave with a local set point that stands."
    return Fact("sp_not_constant", share > limit, share, limit, text, remedy)


def set_point_moves(sp: Values, e: Values) -> npt.NDArray[np.int64]:
    """Indices at which SP has left its last level by more than 5 % of std(e), shape (m,).

    The level is the one last left, so a slow ramp is a row of moves though no single step is large.
    """
    steps = np.flatnonzero(sp[1:] != sp[:-1]) + 1
    if len(steps) == 0:
        return steps
    band = max(0.05 * float(np.std(e)), 1e-9 * float(np.max(np.abs(sp))))
    level, moves = float(sp[0]), []
    for i in steps.tolist():
        if abs(sp[i] - level) > band:
            level = float(sp[i])
            moves.append(i)
    return np.array(moves, dtype=np.int64)


def quantised(record: LoopRecord, limit: float = 10.0) -> Fact:
    """Number of levels of the grid on which PV lives, across its peak-to-peak; below ``limit`` is too coarse.

    The step is the smallest move; PV counts as gridded when 90 % of its values lie within 5 % of a step of
    the grid. A flat-then-jump PV on a coarse grid looks like stick-slip without any valve.
    """
    x = _good(record, record.pv)
    moves = np.abs(np.diff(x))
    counted = moves > 1e-9 * float(np.max(np.abs(x))) if len(x) else moves > 0.0
    moves = moves if counted.all() else moves[counted]
    if len(moves) < 5:
        return Fact("quantised", False, float("inf"), limit, "PV moves too seldom to look for a grid.", judged=False)
    step = percentile(moves, 1.0)
    levels = float(np.ptp(x)) / step
    if not on_grid(x, step):
        return Fact("quantised", False, levels, limit, "PV is not on a grid.")
    text = f"PV moves in steps of {step:.4g}, {levels:.0f} levels in its swing ({limit:.0f} needed)."
    return Fact(
        "quantised", levels < limit, levels, limit, text, "Log PV with all the digits that the transmitter has."
    )


def on_grid(x: Values, step: float) -> bool:
    """Whether nine in ten of the values (n,) lie within 5 % of a ``step`` of a grid through the first."""
    place = (x - x[0]) / step
    return bool(np.mean(np.abs(place - np.round(place)) < 0.05) >= 0.9 - 1e-9)


def compressed(record: LoopRecord, limit: float = 0.5) -> Fact:
    """Share of samples that a historian has drawn, not measured: on the line between their neighbours, or held.

    What curves, and what the logged OP was worked out from, was not drawn (``drawn``).
    """
    x, t = _good(record, record.pv), _good(record, record.t)
    if len(x) < 5 or np.ptp(x) == 0.0:
        return Fact("compressed", False, 0.0, limit, "PV is too short to look for compression.", judged=False)
    share = float(np.mean(drawn(t, x)))
    text = f"{share:.0%} of the PV samples lie on straight lines between others ({limit:.0%} allowed)."
    found = share > limit and not controlled_as_logged(record)
    if share > limit and not found:
        text = f"{text.removesuffix('.')}, but the controller worked on these very samples."
    return Fact("compressed", found, share, limit, text, "Log raw values: exception and compression off.")


def drawn_op(record: LoopRecord, limit: float = 0.5) -> Fact:
    """Share of samples of OP on a sloping line between their neighbours while PV moves on: a historian has drawn them.

    A controller with integral action draws a line only while its error moves in one way, which the logged PV then shows
    (``drawn``).  Steps are left out: OP may be held between two scans.
    """
    op, pv, t = (_good(record, x) for x in (record.op, record.pv, record.t))
    remedy = "Log OP raw: exception and compression off."
    if len(op) < 5 or np.ptp(op) == 0.0 or np.ptp(pv) == 0.0:
        return Fact("compressed", False, 0.0, limit, "OP is too short to look for compression.", remedy)
    step, moves = np.abs(np.diff(op)), np.abs(np.diff(pv)) > 1e-6 * np.ptp(pv)
    sloping = drawn(t, op) & (step[1:] > 1e-6 * np.ptp(op))
    share = float(np.mean(sloping & moves[1:] & moves[:-1]))
    text = f"{share:.0%} of the OP samples lie on straight lines between others while PV moves ({limit:.0%} allowed)."
    return Fact("compressed", share > limit and not controlled_as_logged(record), share, limit, text, remedy)


def _good(record: LoopRecord, x: Values) -> Values:
    kept: Values = x[record.kept]
    return kept

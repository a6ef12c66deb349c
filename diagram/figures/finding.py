"""The finding of a run in a few words for a title: rest, a cycle and its cause, or where a signal goes."""

from collections.abc import Iterable, Sequence

import numpy as np
from stickslip.blocks.declared import STUCK_MODE
from stickslip.blocks.role import Role
from stickslip.diagram.simulation import Run
from stickslip.logs import Log
from stickslip.logs.oscillation import Oscillation, following, oscillation
from stickslip.logs.trend import rests

__all__ = ["cycles", "finding", "later", "swing"]

LATE = 0.5  # of the run: what is said of an oscillation is measured from there on
FEWEST = 2.0  # cycles in that part, one in each half of it, or it is none
STEADY = 0.8  # of the swing in the half before: what swings less dies out, what swings more by as much grows
BACK = 0.3  # of what it moves: a signal that ends so near its start comes back
SMALL = 0.02  # of what the signal moves in the whole run: a smaller ripple is not the finding
ALIKE = 0.15  # of a period: how far two may differ that are one
SINE = 0.3  # of a source's variance: with less at the period it does not swing so
SLIPS = (0.8, 6.0)  # a cycle: how often a stem comes to rest that slips with the cycle


def later(t: np.ndarray) -> np.ndarray:
    """Return which rows are of the later part of a run, where its start-up is over; shapes (n,)."""
    return np.asarray(t >= t[0] + LATE * (t[-1] - t[0]))


def cycles(log: Log, signal: str) -> float:
    """Return how often a signal would swing over the run if it swung as in its second half; 0 where it does not.

    >>> from stickslip.blocks.periodic import Sine
    >>> from stickslip.diagram import simulate, wire
    >>> round(cycles(simulate(wire([Sine("F", amplitude=1.0, period=2.0)], outputs=["F"]), 100.0, every=0.1).log, "F"))
    50
    """
    known = np.isfinite(log[signal]) & later(log.t)
    if known.sum() < 3 or rests(log[signal][known]):
        return 0.0
    period = oscillation(log.t[known], log[signal][known]).period
    return float(log.t[-1] - log.t[0]) / period if np.isfinite(period) and period > 0.0 else 0.0


def swing(log: Log, signal: str) -> tuple[Oscillation, str] | None:
    """Return the oscillation of a signal in the later part of a run, and whether it "dies out", "grows" or stays ("").

    None where it does not swing.
    """
    late = later(log.t)
    t, y = log.t[late], log[signal][late]
    if len(t) < 3 or not np.isfinite(y).all() or rests(y):
        return None
    found = oscillation(t, y)
    whole = log[signal][np.isfinite(log[signal])]
    if not (t[-1] - t[0] >= FEWEST * found.period and 2.0 * found.amplitude > SMALL * float(np.ptp(whole))):
        return None
    first = t < 0.5 * (t[0] + t[-1])
    before, after = float(np.ptp(y[first])), float(np.ptp(y[~first]))
    return found, "dies out" if after < STEADY * before else "grows" if before < STEADY * after else ""


def finding(run: Run, shown: Sequence[str]) -> str:
    """Return what a run shows of the signals in its picture; "" where nothing simple can be said.

    >>> from stickslip.blocks.sources import Ramp
    >>> from stickslip.diagram import simulate, wire
    >>> finding(simulate(wire([Ramp("F", slope=0.1)], outputs=["F"]), 100.0), ["F"])
    'F goes from 0 to 10'
    """
    log = run.log
    if not run.ok or not shown:
        return ""
    if all(rests(log[s]) for s in shown):
        return _at_rest(run, shown)
    measured = {b.loop_signal("PV") for b in run.final.blocks if b.role is Role.CONTROLLER}
    order = [s for s in shown if s in measured] + [s for s in shown if s not in measured]
    for s in order:
        found = swing(log, s)
        if found is not None:
            return _cycle(run, s, *found)
    for s in order:
        y = log[s][np.isfinite(log[s])]
        if rests(y) or not np.isfinite(log[s][[0, -1]]).all():
            continue
        if abs(y[-1] - y[0]) < BACK * np.ptp(y):
            return f"{s} moves between {_with_unit(run, s, y.min(), False)} and {_with_unit(run, s, y.max())}"
        return f"{s} goes from {_with_unit(run, s, log[s][0], False)} to {_with_unit(run, s, log[s][-1])}"
    return ""


def _at_rest(run: Run, shown: Sequence[str]) -> str:
    """Rest, and by how much rounding moves what moves most: in the common unit, or as a share of its value."""
    moved = {s: float(np.ptp(y)) for s in shown if (y := run.log[s][np.isfinite(run.log[s])]).size}
    if not any(moved.values()):
        return "at rest: nothing moves"
    if len({run.log.units.get(s, "") for s in shown}) == 1:
        most = max(moved, key=lambda s: moved[s])
        return f"at rest: nothing moves by more than {_with_unit(run, most, float(f'{moved[most]:.1g}'))}"
    share = max(by / float(np.nanmax(np.abs(run.log[s]))) for s, by in moved.items() if by)
    return f"at rest: nothing moves by more than {share:.1g} of its value"


def _cycle(run: Run, s: str, found: Oscillation, trend: str) -> str:
    """An oscillation of a signal: what moves it from outside, or which stems stick, with period and amplitude."""
    amplitude, period = _with_unit(run, s, found.amplitude), f"{found.period:.3g} s"
    stems = _slipping(run, found.period)
    sticks = f"{_and(stems)} stick{'s' * (len(stems) == 1)}" if stems else ""
    late = later(run.log.t)
    for source in _moved_by_themselves(run, s, found.period):
        behind = following(run.log.t[late], run.log[source][late], run.log[s][late], found.period)
        if behind.share > SINE:
            text = f"{source} swings by itself with a period of {period}; {s} follows {behind.lag:.2g} s later, "
            text += (f"{behind.gain:.2g} times as far" if run.log.units.get(s) == run.log.units.get(source)
                     else f"amplitude {amplitude}")  # fmt: skip
            return text + (f"; {sticks}" if sticks else "")
    for standing in _unmoved(run, s):
        return f"{s} swings by itself with a period of {period}; {standing} stands" + (
            f" and {_and(stuck)} is stuck" if len(stuck := _stuck(run)) == 1 else "")  # fmt: skip
    after = f" and {trend}" if trend else ""
    if not sticks:
        return f"{s} oscillates{after}, period {period}, amplitude {amplitude}"
    controllers = [b for b in run.final.blocks if b.role is Role.CONTROLLER]
    if len(controllers) == 1:
        return f"{sticks}: the loop cycles{after} with a period of {period}, {s} with an amplitude of {amplitude}"
    return f"{sticks}: {s} cycles{after}, period {period}, amplitude {amplitude}"


def _moved_by_themselves(run: Run, s: str, period: float) -> list[str]:
    """Signals from outside all loops that swing with a period, set points first; none where ``s`` is one itself."""
    log = run.log
    outside = [x for b in run.final.blocks if b.role.drives for x in b.output_labels if x in log]
    set_points = {b.loop_signal("SP") for b in run.final.blocks}
    found = [x for x in outside if (there := swing(log, x)) and abs(there[0].period - period) < ALIKE * period]
    return [] if s in outside else sorted(found, key=lambda x: x not in set_points)


def _unmoved(run: Run, s: str) -> list[str]:
    """What controllers measure that stands in the later part although ``s``, their set point, moves."""
    late = later(run.log.t)
    held = [b.loop_signal("PV") for b in run.final.blocks if b.role is Role.CONTROLLER and b.loop_signal("SP") == s]
    return [pv for pv in held if pv is not None and pv in run.log and rests(run.log[pv][late])]


def _stuck(run: Run) -> list[str]:
    """Stems that never leave their place in the later part of the run."""
    since = run.log.t[later(run.log.t)][0]
    moved = {e.block for e in run.events if e.t >= since}
    return [b.loop_signal("MV") or b.output_labels[0] for b in run.final.blocks if b.can_stick and b.name not in moved
            and b.mode == STUCK_MODE]  # fmt: skip


def _slipping(run: Run, period: float) -> list[str]:
    """Stems that stick and slip with a period in the later part of the run."""
    since = run.log.t[later(run.log.t)][0]
    swings = float(run.log.t[-1] - since) / period
    found = []
    for block in run.final.blocks:
        if block.can_stick:
            rests_again = sum(e.block == block.name and e.after == STUCK_MODE and e.t >= since for e in run.events)
            if SLIPS[0] * swings <= rests_again <= SLIPS[1] * swings:
                found.append(block.loop_signal("MV") or block.output_labels[0])
    return found


def _and(names: Iterable[str]) -> str:
    *most, last = names
    return f"{', '.join(most)} and {last}" if most else last


def _with_unit(run: Run, signal: str, value: float, unit: bool = True) -> str:
    """A value with its unit, pressures in bar."""
    named = run.log.units.get(signal, "")
    if named == "Pa":
        value, named = value / 1e5, "bar"
    return f"{value:.3g} {named}".rstrip() if unit and named not in ("", "1") else f"{value:.3g}"

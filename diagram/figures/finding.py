"""What a run shows, in the few words that fit a title: rest, an oscillation with period and size, or where it goes."""

from collections.abc import Sequence

import numpy as np

from blocks.role import Role
from diagram.simulation import Run
from logs import Log
from logs.oscillation import oscillation
from logs.trend import rests

__all__ = ["cycles", "finding"]

LATE = 0.5  # of the run: what is said of an oscillation is measured from there on
FEWEST = 3.0  # cycles in that part, or it is none
BACK = 0.3  # of what it moves: a signal that ends so near its start comes back
SMALL = 0.02  # of what the signal moves in the whole run: a smaller ripple is not the finding


def cycles(log: Log, signal: str) -> float:
    """Return how often a signal would swing over the run if it swung as in its second half; 0 where it does not.

    >>> from blocks.periodic import Sine
    >>> from diagram import simulate, wire
    >>> round(cycles(simulate(wire([Sine("F", amplitude=1.0, period=2.0)], outputs=["F"]), 100.0, every=0.1).log, "F"))
    50
    """
    known = np.isfinite(log[signal]) & (log.t >= log.t[0] + LATE * (log.t[-1] - log.t[0]))
    if known.sum() < 3 or rests(log[signal][known]):
        return 0.0
    period = oscillation(log.t[known], log[signal][known]).period
    return float(log.t[-1] - log.t[0]) / period if np.isfinite(period) and period > 0.0 else 0.0


def finding(run: Run, shown: Sequence[str]) -> str:
    """Return what a run shows of the signals in its picture; "" where nothing simple can be said.

    >>> from blocks.sources import Ramp
    >>> from diagram import simulate, wire
    >>> finding(simulate(wire([Ramp("F", slope=0.1)], outputs=["F"]), 100.0), ["F"])
    'F goes from 0 to 10'
    """
    log = run.log
    if not run.ok or not shown:
        return ""
    if all(rests(log[s]) for s in shown):
        return "everything is at rest"
    measured = {b.loop_signal("PV") for b in run.final.blocks if b.role is Role.CONTROLLER}
    order = [s for s in shown if s in measured] + [s for s in shown if s not in measured]
    late = log.t >= log.t[0] + LATE * (log.t[-1] - log.t[0])
    for s in order:
        y = log[s][late]
        if rests(y) or not np.isfinite(y).all():
            continue
        found = oscillation(log.t[late], y)
        swings = float(np.ptp(log.t[late])) / found.period if np.isfinite(found.period) else 0.0
        if swings >= FEWEST and 2.0 * found.amplitude > SMALL * float(np.ptp(log[s][np.isfinite(log[s])])):
            return f"{s} oscillates, period {found.period:.3g} s, amplitude {_told(run, s, found.amplitude)}"
    for s in order:
        y = log[s][np.isfinite(log[s])]
        if rests(y) or not np.isfinite(log[s][[0, -1]]).all():
            continue
        if abs(y[-1] - y[0]) < BACK * np.ptp(y):
            return f"{s} moves between {_told(run, s, y.min(), False)} and {_told(run, s, y.max())}"
        return f"{s} goes from {_told(run, s, log[s][0], False)} to {_told(run, s, log[s][-1])}"
    return ""


def _told(run: Run, signal: str, value: float, unit: bool = True) -> str:
    """A value with its unit, pressures in bar."""
    named = run.log.units.get(signal, "")
    if named == "Pa":
        value, named = value / 1e5, "bar"
    return f"{value:.3g} {named}".rstrip() if unit and named not in ("", "1") else f"{value:.3g}"

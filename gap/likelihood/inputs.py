"""What the log does not tell of a logged input: its last digits, and what it does between two rows.

    u = what is played + d,      d ~ N(0, step^2/12)             anew where the input moves, else as it was
    between rows in a line:      d' = d q + w,  q = (1 - f')/(1 - f),  w ~ N(0, 4 s^2 (f' - f) q)     a Brownian bridge
                                 f, f': shares of the way from row to row;  s: the spread halfway, or half of a jump

A set point of a cascade, of a ratio or of a higher control is a number with all digits, of which the log keeps some.
A spread is that of a random walk halfway between its rows: what one row misses the middle of its neighbours by, over
the square root of two.
"""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import median_filter
from stickslip.blocks.recorded import Recorded
from stickslip.gap.records.record import Digits, Record, rounding, significant, switch_rows, switches
from stickslip.logs.arrays import Values
from stickslip.logs.normal import OF_SIZES, spread

RAMP = 3  # rows at which an input moves, beyond which it may be a ramp
TYPED = 1.5  # times the digit of the other signals: what has coarser digits has been typed in, and is exact
JUMP = 4.0  # standard deviations of its moves from row to row, beyond which an input has jumped
NEAR = 61  # rows over which an input is taken to move alike


@dataclass(frozen=True)
class Doubt:
    """The ``step`` to which the log rounds an input, and its usual ``spread`` halfway between two rows [its unit]."""

    step: float
    spread: float = 0.0

    def drawn(self, log_t: Values, values: Values, stops: Values, row_of: NDArray[np.int64]) -> tuple[Values, Values]:
        """Return how much of the doubt stays at each stop, and the standard deviation of what is new, (stops,) each."""
        phi, sd = np.ones(len(stops)), np.zeros(len(stops))
        fresh = np.diff(values, prepend=np.nan) != 0.0
        at_row = row_of >= 0
        step = Digits(self.step, significant(values) if self.step else 0).steps(values)[np.maximum(row_of, 0)]
        new = at_row & fresh[np.maximum(row_of, 0)]
        phi[new], sd[new] = 0.0, step[new] / np.sqrt(12.0)
        if self.spread > 0.0:
            k = np.clip(np.searchsorted(log_t, stops, side="right") - 1, 0, len(log_t) - 2)
            share = np.clip((stops - log_t[k]) / (log_t[k + 1] - log_t[k]), 0.0, 1.0)
            since = np.where(np.diff(k, prepend=-1) == 0, np.concatenate([[0.0], share[:-1]]), 0.0)
            steps = np.abs(np.diff(values))
            jumps = steps > JUMP * spread(steps)  # somewhere between the rows
            wide = np.where(jumps, 0.5 * steps, spreads(values)[:-1])[k]
            moving = ~at_row & (fresh[k] | fresh[k + 1])
            phi[moving] = ((1.0 - share) / (1.0 - since))[moving]
            sd[moving] = 2.0 * (wide * np.sqrt((share - since) * (1.0 - share) / (1.0 - since)))[moving]
            behind = at_row & np.concatenate([[False], moving[:-1]])
            phi[behind], sd[behind] = 0.0, step[behind] / np.sqrt(12.0)
        return phi, sd


def rounded(record: Record) -> dict[str, Doubt]:
    """Return the doubts of inputs that are measured or computed: they move at row after row, or have the digits which
    the log gives other signals.
    """
    finest = max((record.steps[s] for s in record.pinned), default=0.0)
    steps = {s: rounding(record.known(s)) for s in record.played}
    return {
        s: Doubt(step)
        for s, step in steps.items()
        if step > 0.0 and (moves(record, s) or finest / TYPED <= step <= TYPED * finest)
    }


def moves(record: Record, signal: str) -> bool:
    """Return whether an input moves at row after row, in place of switching at a few."""
    return len(switch_rows(record.log, signal)) > RAMP and not switches(record.log, signal)


def in_lines(record: Record, signal: str) -> Doubt:
    """Return the doubt of an input that moves all the time, and goes in lines from row to row."""
    spread = float(np.median(spreads(record.log[signal])))
    return Doubt(0.0 if switches(record.log, signal) else rounding(record.known(signal)), spread)


def spreads(values: Values) -> Values:
    """Return the spread of an input halfway to the next row, near each row: the set point of a ratio moves more where
    the ratio is larger.
    """
    off = np.abs(values[1:-1] - 0.5 * (values[:-2] + values[2:]))
    usual = OF_SIZES * median_filter(off, min(NEAR, len(off)), mode="nearest") / np.sqrt(2.0)
    return np.concatenate([usual[:1], usual, usual[-1:]])


def played(
    record: Record, doubts: Mapping[str, Doubt], stops: Values, row_of: NDArray[np.int64], seeds: Iterable[int]
) -> Iterator[dict[str, Recorded]]:
    """Yield what may have driven the inputs: with digits, and ways between rows, that the log has not."""
    sources = {s: record.source(s) for s in record.played}
    lines = {s: np.array([float(sources[s].output(t, [], [])[0]) for t in stops.tolist()]) for s in doubts}
    drawn = {s: one.drawn(record.log.t, record.log[s], stops, row_of) for s, one in doubts.items()}
    for seed in seeds:
        rng, found = np.random.default_rng(seed), dict(sources)
        for s, (phi, sd) in drawn.items():
            d, now = np.empty(len(stops)), 0.0
            for k, new in enumerate((sd * rng.standard_normal(len(stops))).tolist()):
                now = d[k] = phi[k] * now + new
            found[s] = Recorded(s, stops, lines[s] + d, hold="previous", name=sources[s].name)
        yield found

"""A record cut into the pieces that can be read without a break, and whether the longest of them oscillates."""

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from stickslip.detect.health import conditions
from stickslip.detect.oscillation import acf_crossings as oscillation
from stickslip.detect.oscillation.gate import Gate
from stickslip.detect.signals.gaps import Gap, bridgeable, describe, gaps_in, split, taken
from stickslip.logs import LoopRecord
from stickslip.logs.arrays import Values

NEAR_SHARE = 0.1  # of the swing of e, beyond which it has not come to where it stays
Piece = tuple[Values, Values]


@dataclass(frozen=True, eq=False)
class Pieces:
    """The pieces of a record, in order of time.

    all : tuple of (t, e); times [s] and control error [unit of PV] of each piece, (n,); -PV stands for e without SP
    gate : the oscillation test of the longest piece
    notes : what was bridged and what cuts the record: where and how long, without full stops
    """

    all: tuple[Piece, ...]
    gate: Gate
    notes: tuple[str, ...]

    @property
    def longest(self) -> Piece:
        """The piece of most samples; empty arrays when there is none."""
        return _longest(self.all)

    def stretches(self, p: oscillation.Params) -> Iterator[tuple[Values, Values, float]]:
        """(t, e, period [s]) of every stretch of one period.

        Each piece is tested by itself; one that does not pass has the period of the longest.
        """
        tested = self.longest[0]
        for t, e in self.all:
            gate = self.gate if t is tested else oscillation.find_in(t, e, p)
            if len(gate.stretches) < 2:  # all of it, with its own period or that of the longest
                yield t, e, (gate.period if gate.stretches else self.gate.period) or math.inf
                continue
            for start, end, period in gate.stretches:
                inside = slice(int(np.searchsorted(t, start)), int(np.searchsorted(t, end, side="right")))
                yield t[inside], e[inside], period


def pieces_of(record: LoopRecord, p: oscillation.Params) -> Pieces:
    """Cut a record at the moves of its set point and at every gap that is too long to be bridged.

    How long that is depends on the period, which the gate finds. It starts from the longest period that the record
    can show and, if nothing oscillates then, from no bridge but over single samples.
    """
    gaps = gaps_in(record)
    for period in (record.log.duration / p.cycles_min, 0.0):
        tried = bridgeable(record, period)
        pieces = _cut(record, tried)
        gate = oscillation.find_in(*_longest(pieces), p)
        if gate.oscillating and gate.period is not None:
            period = gate.period
            bridged = bridgeable(record, period)
            if any(min(tried, bridged) < gap.length <= max(tried, bridged) for gap in gaps):
                pieces = _cut(record, bridged)
                gate = oscillation.find_in(*_longest(pieces), p)
            break
    return Pieces(pieces, gate, _notes(gaps, bridgeable(record, period), len(pieces)))


def _longest(pieces: tuple[Piece, ...]) -> Piece:
    return max(pieces, key=lambda piece: len(piece[0]), default=(np.empty(0), np.empty(0)))


def _cut(record: LoopRecord, bridged: float) -> tuple[Piece, ...]:
    """The good samples between moves of the set point and gaps longer than ``bridged`` [s]."""
    pieces: list[Piece] = []
    for part in map(taken, split(record, bridged)):
        t = record.t[part]
        if record.e is None or record.sp is None:
            pieces.append((t, -record.pv[part]))
            continue
        e = record.e[part]
        cuts = [0, *conditions.set_point_moves(record.sp[part], e).tolist(), len(t)]
        pieces += [(t[a + k : b], e[a + k : b]) for a, b in itertools.pairwise(cuts) for k in [run_in(e[a:b])]]
    return tuple(pieces)


def run_in(e: Values) -> int:
    """How many samples a piece of e (n,) takes at its start to come to where it stays, after a step of SP or a start.

    e starts further off than it ever swings in the last two thirds, by their range or more: that drowns the swing.

    >>> run_in(np.array([9.0, 5.0, 2.0, 1.0, -1.0, 1.0, -1.0, 1.0, -1.0]))
    3
    """
    third = len(e) // 3
    if not third:
        return 0
    low, high = float(np.min(e[third:])), float(np.max(e[third:]))
    off = np.maximum(low - e[:third], e[:third] - high)
    swing = high - low
    return int(np.flatnonzero(off > NEAR_SHARE * swing)[-1]) + 1 if off[0] >= swing > 0.0 else 0


def _notes(gaps: tuple[Gap, ...], bridged: float, pieces: int) -> tuple[str, ...]:
    short = [gap for gap in gaps if gap.length <= bridged]
    long = [gap for gap in gaps if gap.length > bridged]
    moves = max(pieces - 1 - len(long), 0)
    causes = [describe(long)] * bool(long) + [f"{moves} move{'s' * (moves != 1)} of the set point"] * bool(moves)
    notes = [f"{describe(short)} bridged by a straight line"] * bool(short)
    return (*notes, *[f"{' and '.join(causes)} cut the record into {pieces} pieces"] * bool(causes))

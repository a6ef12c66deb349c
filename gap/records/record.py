"""What a log says about itself: which signals of a diagram it has, how they are rounded, and where each is good."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray
from stickslip.blocks.recorded import Recorded
from stickslip.diagram.diagram import Diagram
from stickslip.logs import Log
from stickslip.logs.arrays import Values

LATTICE = 1e-3  # how far, in steps, values may lie off a lattice that they are said to be on
FINEST = 1e-12  # of the largest value: numbers themselves are not more exact
MOST_DIGITS = 9  # significant digits of a log that rounds
COARSER, DISTINCT = 2.0, 10  # times the finest step, and values that have it, of a log of significant digits
FEW = 0.1  # distinct values for each row, at most, where a signal has few
UNEVEN = 0.02  # how far, in steps, they may lie off their lattice
APART = 2.5  # roundings of the log by which they lie apart, where it has rounded them again
BRIEF = 1e-6  # share of a row's interval in which a step is made among ramps
RARE = 0.1  # share of rows at which a set point switches, at most
FEWEST = 20  # rows below which a record says too little


class GapError(ValueError):
    """A model, or a log, that a diagnosis cannot use."""


def rounding(values: ArrayLike) -> float:
    """Return the step [unit of the values] of the lattice on which all values lie; 0 if there is none.

    >>> rounding([0.0, 0.003, 0.0045, 0.3]).__round__(9)
    0.0015
    >>> rounding([0.0, 0.1, 3.0**0.5])
    0.0
    """
    known = np.asarray(values, dtype=float)
    known = np.unique(known[np.isfinite(known)])
    if len(known) < 2:
        return 0.0
    gaps = np.diff(known)
    noise = FINEST * float(np.abs(known).max())
    step = float(gaps[gaps > noise].min(initial=np.inf))
    for _ in range(24):  # Euclid: what does not divide becomes the next divisor
        if not noise < LATTICE * step < np.inf:
            return 0.0
        step = float(f"{step:.6g}")  # without the digits that are rounding of the numbers themselves
        left = np.abs(known - np.round(known / step) * step)
        off = left > max(noise, LATTICE * step)
        if not off.any():
            return step
        step = float(left[off].min())
    return 0.0


def significant(values: ArrayLike) -> int:
    """Return to how many significant digits the values of a signal are rounded; 0 where they are not, or by decimals.

    Many large values without the last decimal of the small ones say so: 1.0 beside 0.999 does not.

    >>> significant([*np.round(np.linspace(9.5, 9.99, 40), 4), *np.round(np.linspace(10.0, 12.0, 40), 3)])
    5
    >>> significant([0.999, 1.0, 0.123]), significant([0.1, 3.0**0.5])
    (0, 0)
    """
    known = np.unique(np.asarray(values, dtype=float))
    known = left = known[np.isfinite(known) & (known != 0.0)]
    for digits in range(1, MOST_DIGITS + 1) if len(known) else ():
        step = _last_digit(left, digits)
        left = left[np.abs(left - np.round(left / step) * step) > FINEST * np.abs(left)]
        if not len(left):
            coarse = np.sum(_last_digit(known, digits) > COARSER * rounding(known))
            return digits if coarse >= DISTINCT else 0
    return 0


def _last_digit(values: Values, digits: int) -> Values:
    """Return by how much a value changes where the last of so many significant digits does; 0 of zero."""
    size = np.abs(values)
    exponents = np.floor(np.log10(size, where=size > 0.0, out=np.full(size.shape, -np.inf)) + FINEST)
    return np.asarray(10.0 ** (exponents + 1 - digits))


@dataclass(frozen=True)
class Digits:
    """How a log rounds a signal: to multiples of a ``step`` [its unit], 0 for none; to ``significant`` digits, 0 for
    decimals.

    >>> np.round(Digits(1e-5, 6).steps(np.array([9.87654, 12.1436])), 6).tolist()
    [1e-05, 0.0001]
    """

    step: float
    significant: int = 0

    @classmethod
    def of(cls, values: ArrayLike) -> "Digits":
        """Return how values have been rounded."""
        return cls(rounding(values), significant(values))

    def steps(self, values: Values) -> Values:
        """Return to which step each value is rounded."""
        if not self.significant:
            return np.full(values.shape, self.step)
        return np.maximum(self.step, _last_digit(values, self.significant))

    def rounded(self, values: Values) -> Values:
        """Return values as the log keeps them."""
        steps = self.steps(values)
        return np.asarray(np.round(values / steps) * steps) if self.step else values


def spacing(values: ArrayLike) -> float:
    """Return the step between the few values that a signal ever has, [unit of the values]; 0 where they are not few.

    Unlike ``rounding`` it bears values that were rounded once more.

    >>> spacing(np.round(0.0223055 * np.random.default_rng(0).integers(40, 90, 5000), 4)).__round__(6)
    0.022306
    """
    known = np.asarray(values, dtype=float)
    known = known[np.isfinite(known)]
    levels = np.unique(known)
    if len(levels) < 3 or len(levels) > FEW * len(known):
        return 0.0
    step = float(np.median(np.diff(levels)))
    for _ in range(3):
        k = np.cumsum(np.round(np.diff(levels) / step))  # from neighbour to neighbour no error adds up
        if k[-1] < 2.0:
            return 0.0
        step = float(np.polyfit(k, levels[1:], 1)[0])
    k = np.round(levels / step)  # multiples of the step, of which zero is one
    step = float(k @ levels / (k @ k)) if k.any() else step
    off, again = np.abs(levels - np.round(levels / step) * step), rounding(known)
    again = again if APART * again < step else 0.0
    return step if float(np.max(off)) < UNEVEN * step + 0.51 * again else 0.0


def switches(log: Log, signal: str) -> bool:
    """Return whether a signal stands still but for switches at few rows, as a set point does.

    >>> switches(Log(np.arange(40.0), {"SP": np.repeat([1.0, 2.0], 20)}), "SP")
    True
    """
    return 0.0 < len(switch_rows(log, signal)) / max(len(log) - 1, 1) < RARE


def switch_rows(log: Log, signal: str) -> NDArray[np.intp]:
    """Return the rows at which a signal has another value than at the row before.

    >>> switch_rows(Log(np.arange(4.0), {"SP": np.array([1.0, 1.0, 2.0, 2.0])}), "SP").tolist()
    [2]
    """
    return np.flatnonzero(np.diff(log[signal]) != 0.0) + 1


class Residuals(Protocol):
    """What makes residuals of a diagram and a log in place of a pinned replay
    (``stickslip.gap.linearised.filtered``).
    """

    def residuals(
        self, diagram: Diagram, record: "Record", params: Mapping[str, ArrayLike] | None, logs: Sequence[Log] | None
    ) -> Values:
        """Return (runs, rows, pinned signals)."""

    def holding(self, diagram: Diagram, record: "Record") -> "Residuals":
        """Return what takes what all diagrams do between rows from one run of a diagram."""


@dataclass(frozen=True, eq=False)
class Record:
    """A log as a diagnosis reads it: the signals that the diagram has too, in the diagram's order.

    ``log``; ``played`` the logged open inputs; ``pinned`` the other logged signals, those that blocks drive;
    ``lattices`` those whose lattice is the sensor's own, not the log's rounding; ``used`` logged signals that the model
    drives and that are taken as they are, not judged; ``filter`` what makes residuals of it where no replay does;
    ``suspects`` the blocks at which a gap can be, none named: all; ``computed`` the rounding of signals that were
    computed from logged ones [their unit]; ``leads`` by how much [s] before the row that shows it an input switched;
    ``ramps`` inputs that move from row to row and go in lines between them, with the interval at which they are read
    there [s], 0 for the lines themselves; ``fresh`` signals in which noise is drawn anew, with (period, first time) [s]
    of the draws: between rows nobody knows it.
    """

    log: Log
    played: tuple[str, ...]
    pinned: tuple[str, ...]
    lattices: tuple[str, ...] = ()
    used: tuple[str, ...] = ()
    filter: "Residuals | None" = None
    suspects: tuple[str, ...] = ()
    computed: Mapping[str, float] = field(default_factory=dict)
    leads: Mapping[str, Mapping[int, float]] = field(default_factory=dict)
    ramps: Mapping[str, float] = field(default_factory=dict)
    fresh: Mapping[str, tuple[float, float]] = field(default_factory=dict)

    def source(self, signal: str, name: str = "") -> Recorded:
        """Return what plays a logged input: held between its switches, each of which lies its lead before its row.

        Where a ramp moves at row after row, lines join the rows; a sensor reads them at its scans.
        """
        t, v = self.log.t, self.log[signal]
        moved = np.diff(v, prepend=np.nan) != 0.0
        known = self.leads.get(signal, {})
        times, values = [float(t[0])], [float(v[0])]
        for k in np.flatnonzero(moved)[1:]:
            at = float(t[k]) - known.get(int(k), 0.0)
            joined = signal in self.ramps and ((moved[k - 1] and k > 1) or (k + 1 < len(v) and moved[k + 1]))
            if signal in self.ramps:
                times.append(float(t[k - 1]) if joined else at - BRIEF * (t[k] - t[k - 1]))
                values.append(float(v[k - 1]))
            times.append(at)
            values.append(float(v[k]))
        times.append(float(t[-1]) + self.log.dt)
        values.append(float(v[-1]))
        fresh = np.diff(times, prepend=-np.inf) > 0.0
        rows, lines = np.array(times)[fresh], np.array(values)[fresh]
        every = self.ramps.get(signal, 0.0)
        if every > 0.0:
            scans = every * np.arange(np.floor(rows[0] / every), np.ceil(rows[-1] / every))
            return Recorded(signal, scans, np.interp(scans, rows, lines), hold="previous", name=name)
        return Recorded(signal, rows, lines, hold="linear" if signal in self.ramps else "previous", name=name)

    @cached_property
    def steps(self) -> dict[str, float]:
        """Rounding of each signal that the model drives [its unit], 0 for none."""
        return {s: 0.0 if s in self.lattices else self.lattice(s) for s in (*self.pinned, *self.used)}

    def known(self, signal: str) -> Values:
        """Return the good values of a signal."""
        return self.log[signal][self.log.good(signal)]

    def lattice(self, signal: str) -> float:
        """Return the step on whose multiples the values of a signal lie, 0 for none."""
        values = self.known(signal)
        return max(rounding(values), spacing(values))

    @cached_property
    def first(self) -> dict[str, float]:
        """First good value of each signal of the log."""
        return {s: float(self.known(s)[0]) for s in self.log.names if len(self.known(s))}

    @cached_property
    def digits(self) -> dict[str, Digits]:
        """How the log rounds each signal that the model drives."""
        return {s: Digits(step, significant(self.known(s)) if step else 0) for s, step in self.steps.items()}

    def rounded(self, values: dict[str, Values]) -> dict[str, Values]:
        """Return values of the pinned signals rounded as the log rounds them."""
        return {s: self.digits[s].rounded(v) for s, v in values.items()}

    def first_part(self, share: float) -> "Record":
        """Return the record up to a share of its rows."""
        return replace(self, log=self.log.samples(0, round(share * len(self.log))))

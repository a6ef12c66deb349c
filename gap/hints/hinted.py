"""Which mistake of model or log would explain a gap that no effect explains, by one likelihood.

    L = sum over rows and signals of  ln(1 + e^2) + 1/2 ln s + ln |factor|

e: innovations of a filter of the model alone, whose variance is s.  ln(1 + e^2) grows slowly, so that a log which
is wrong nearly everywhere still says which way is better.  Only the first rows are asked.
"""

import math
from collections.abc import Iterator, Sequence

import numpy as np
from stickslip.diagram.diagram import Diagram
from stickslip.gap.hints.mistakes import Mistake, late, of_controllers, of_units
from stickslip.gap.likelihood.framing import frame_of
from stickslip.gap.likelihood.hypothesis import Hypothesis
from stickslip.gap.records.model import read
from stickslip.gap.records.record import GapError, switches
from stickslip.logs import Log
from stickslip.logs.arrays import Values

Loss = tuple[float, float]
NOWHERE = (math.inf, math.inf)
ROWS = 600  # that are asked
LATEST = 32  # rows by which a clock may be wrong
EXPLAINED = 0.5  # share of the gap in L that a mistake must explain
USUAL = 0.534  # mean of ln(1 + e^2) of a standard normal e
CLEAR = 30.0  # by which L must be better


def hints(diagram: Diagram, log: Log) -> tuple[str, ...]:
    """Return a sentence on the mistake that explains the log best; none where none explains half of the gap."""
    first = log.samples(0, min(ROWS, len(log)))
    stated = Mistake("", diagram, first)
    now = _left(stated)
    if not math.isfinite(now[0]):
        return ()
    tried = [(one, _left(one)) for one in (*of_units(diagram, first), *of_controllers(diagram, first))]
    tried += [found for s in _moving(diagram, first) for found in _clocks(diagram, first, s)]
    best, (loss, size) = min(tried, key=lambda x: x[1][0], default=(stated, now))
    beyond = now[1] - USUAL
    if beyond <= 0.0 or now[0] - loss < CLEAR or now[1] - size < EXPLAINED * beyond:
        return ()
    part = 100.0 * min((now[1] - size) / beyond, 1.0)
    return (f"Check whether {best.words}. That alone would explain {part:.0f} % of the gap.",)


def _moving(diagram: Diagram, log: Log) -> Sequence[str]:
    """Return the logged signals that the model drives, and inputs that move all the time."""
    return [s for s in log.names if s in diagram.signals or (s in diagram.open_inputs and not switches(log, s))]


def _clocks(diagram: Diagram, log: Log, signal: str) -> Iterator[tuple[Mistake, Loss]]:
    """Yield the log with the clock of a signal set right, by ever more rows while it becomes likelier."""
    for way in (1, -1):
        best, rows = math.inf, way
        while abs(rows) <= LATEST:
            one = late(diagram, log, signal, rows)
            found = _left(one)
            yield one, found
            if found[0] >= best:
                break
            best, rows = found[0], rows + way


def _left(one: Mistake) -> Loss:
    """Return L of a log, and the mean of ln(1 + e^2); infinite where no filter follows it."""
    try:
        frame = frame_of(*read(one.diagram, one.log), asked=False)
        if frame is None:
            return NOWHERE
        left = Hypothesis(frame).filtered({})
    except (GapError, ArithmeticError, ValueError):
        return NOWHERE
    return size_of(left.e[frame.skipped :], left.S[frame.skipped :], one.density)


def size_of(e: Values, S: Values, density: float) -> Loss:
    """Return L of innovations and their variances, with ``density`` [nats], and the mean of ln(1 + e^2); infinite where
    no value is known.

    >>> size_of(np.full((3, 1), np.nan), np.full((3, 1), np.nan), 0.0)
    (inf, inf)
    """
    known = np.isfinite(e) & (S > 0.0)
    if not known.any():
        return NOWHERE
    size = np.log1p(e[known] ** 2)
    return float(size.sum() + 0.5 * np.log(S[known]).sum()) + density, float(size.mean())

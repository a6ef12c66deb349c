"""The piece of a model around a place, alone, driven by the logged signals around it."""

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
from stickslip.blocks.recorded import Recorded
from stickslip.diagram.diagram import Diagram
from stickslip.diagram.simulation import simulate
from stickslip.gap.records.record import GapError, Record
from stickslip.logs import Log
from stickslip.logs.arrays import Values

if TYPE_CHECKING:
    from stickslip.diagram.segments import Segment

__all__ = ["driven_to", "filled", "most_amiss", "segment_at"]


def segment_at(quiet: Diagram, record: Record, place: str) -> "Segment[Diagram]":
    """Return the segment between logged signals in which a block is.

    Raises ``GapError`` if it drives no logged signal.
    """
    logged = [s for s in record.log.names if s in quiet.signals]
    segment = next((one for one in quiet.segments(logged) if place in one.blocks), None)
    if segment is None or not segment.drives:
        raise GapError(f"{place} drives no logged signal by itself, so its missing input cannot be computed")
    return segment


def most_amiss(segment: "Segment[Diagram]", residuals: Mapping[str, Values]) -> str:
    """Return the logged signal that a segment drives and of which the model as it is leaves most; (2, rows) each."""
    outputs = [s for s in segment.drives if s in residuals] or list(segment.drives)
    return max(outputs, key=lambda s: _size(residuals.get(s)))


def driven_to(
    quiet: Diagram, segment: "Segment[Diagram]", log: Log, inputs: Mapping[str, Values], shown: str
) -> Values:
    """Return what the segment drives a signal to, its inputs those given, (rows,).

    Raises ``GapError`` if it cannot be run so.
    """
    given = {
        # what a block drives moves between rows, a set point switches
        s: (log.t, values) if s in quiet.driven else Recorded(s, log.t, values, hold="previous")
        for s, values in inputs.items()
    }
    (name,) = (s for s in segment.diagram.output_labels if s.split(":")[0] == shown)
    run = simulate(segment.diagram, log.duration, t0=float(log.t[0]), times=log.t, inputs=given, signals=[name])
    if not run.ok:
        raise GapError(f"the segment {', '.join(segment.blocks)} cannot be run alone from the log: {run.hint}")
    return run.log[name]


def filled(values: Values) -> Values:
    """Return a signal with what is missing on a straight line.

    >>> filled(np.array([1.0, np.nan, 3.0])).tolist()
    [1.0, 2.0, 3.0]
    """
    good = np.isfinite(values)
    if good.all():
        return values
    return np.asarray(np.interp(np.arange(len(values)), np.flatnonzero(good), values[good]))


def _size(residuals: Values | None) -> float:
    """Return the mean square of what the model as it is leaves of a signal, 0 where nothing is known."""
    return 0.0 if residuals is None else float(np.nanmean(np.clip(residuals[0], -1e3, 1e3) ** 2))

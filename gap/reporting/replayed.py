"""The log and the model's answer to the same inputs: as the model is, and with the cause that was found.

The piece of the model around the place is driven by its logged inputs over the stretch of the record where the model as
it is errs most, from the start values that suit the first rows there.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from stickslip.gap.answers.report import UNKNOWN, Cause, GapReport, Shrinkage
from stickslip.gap.effects import effect
from stickslip.gap.insertion.effect import EffectError
from stickslip.gap.records.model import read, silenced
from stickslip.gap.records.record import GapError, Record
from stickslip.gap.records.start import start_values
from stickslip.gap.reporting.driven import driven_to, filled, most_amiss, segment_at
from stickslip.logs import Log
from stickslip.logs.arrays import Values
from stickslip.logs.shown import Shown

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from stickslip.diagram.diagram import Diagram

__all__ = ["Replayed", "replayed"]

SHARE = 0.25  # of the record that is drawn
FEWEST = 300  # rows that are drawn where there are as many


@dataclass(frozen=True, eq=False, repr=False)
class Replayed(Shown):
    """A logged ``signal`` (rows,) over ``t`` [s], and what the model makes of the logged inputs: ``as_it_is``, and
    ``with_cause`` (None where the cause is not one that can be put in).

    ``inputs`` names what was taken from the log, ``cause`` what was put in, in words; ``shrinkage`` is the report's.
    """

    signal: str
    unit: str
    t: Values
    logged: Values
    as_it_is: Values
    with_cause: Values | None
    inputs: tuple[str, ...]
    cause: str
    shrinkage: Shrinkage | None

    @property
    def headline(self) -> str:
        """The result in one line."""
        return str(self)

    def __str__(self) -> str:
        driven = f"{self.signal}, driven by the logged {' and '.join(self.inputs)}"
        errors = f"the model as it is misses {driven}, by {_rms(self.as_it_is - self.logged):.2g} (rms)"
        if self.with_cause is None:
            return f"{errors[0].upper()}{errors[1:]}."
        return f"{errors[0].upper()}{errors[1:]}, with {self.cause} by {_rms(self.with_cause - self.logged):.2g}."

    def plot(self) -> "Figure":
        """Draw the log against the model, as it is and with the cause, and how far the gap shrinks."""
        from stickslip.gap.reporting.figures import plot_replayed

        return plot_replayed(self)


def replayed(report: GapReport, log: Log) -> Replayed:
    """Return the log against the model over the stretch where the model as it is errs most.

    Raises ``GapError`` where the report has no gap, or where no logged signal drives the place.

    >>> from stickslip.blocks import Staircase
    >>> from stickslip.cases.models import ideal_flow
    >>> from stickslip.diagram import simulate
    >>> from stickslip.gap import diagnose
    >>> real = effect("deadband").insert(ideal_flow(), "valve", width=4.0)
    >>> set_point = Staircase("SP", [1.2, 1.6, 1.4] * 20, dwell=40.0)
    >>> signals = ["SP", "PV", "OP"]
    >>> log = simulate(real, 2400.0, every=1.0, signals=signals, inputs={"SP": set_point}).log
    >>> found = replayed(diagnose(ideal_flow(), log), log)
    >>> found.signal, found.inputs, found.cause
    ('PV', ('OP',), 'deadband at valve')
    """
    if report.where is None:
        raise GapError("there is no gap, so there is nothing to show; ask a report with a gap")
    opened, record = read(report.diagram, getattr(log, "log", log))
    segment = segment_at(silenced(opened), record, report.where.place)
    shown = most_amiss(segment, report.residuals)
    inputs = tuple(s for s in segment.reads if s in record.log and s != shown)
    if not inputs:
        raise GapError(f"no logged signal drives the blocks {', '.join(segment.blocks)}; log what does")
    stretch = _stretch(record, report, shown)
    as_it_is = _run(opened, stretch, report.where.place, shown)
    named = tuple(cause for cause in report.causes if cause.effect != UNKNOWN)
    with_cause = _with(report, opened, stretch, named, shown) if named else None
    return Replayed(
        shown, opened.signal_units.get(shown, ""), stretch.log.t, stretch.log[shown], as_it_is, with_cause, inputs,
        " and ".join(f"{cause.effect.replace('_', ' ')} at {cause.place}" for cause in named), report.shrinkage,
    )  # fmt: skip


def _stretch(record: Record, report: GapReport, shown: str) -> Record:
    """Return the part of a record, in whole quarters of its length, in which the model leaves most of a signal."""
    t = record.log.t
    rows = max(int(SHARE * len(t)), min(FEWEST, len(t)))
    left = np.zeros(len(t))
    if shown in report.residuals:
        values = np.nan_to_num(np.clip(report.residuals[shown][0], -1e3, 1e3) ** 2)
        inside = np.clip(np.searchsorted(t, report.t), 0, len(t) - 1)
        np.add.at(left, inside, values)
    total = np.concatenate([[0.0], np.cumsum(left)])
    first = max(range(0, len(t) - rows + 1, max(rows // 4, 1)), key=lambda k: total[k + rows] - total[k])
    return replace(record, log=record.log.samples(first, first + rows))


def _with(
    report: GapReport, opened: "Diagram", stretch: Record, causes: tuple[Cause, ...], shown: str
) -> Values | None:
    """Return the signal of the model with the causes in; None where they cannot be put in by their names and sizes."""
    model = opened
    try:
        for cause in causes:
            sizes: Mapping[str, float] = {name: size.value for name, size in cause.parameters.items()}
            model = effect(cause.effect).insert(model, cause.place, **sizes)
        assert report.where is not None
        return _run(model, stretch, report.where.place, shown)
    except (EffectError, GapError):
        return None


def _run(model: "Diagram", stretch: Record, place: str, shown: str) -> Values:
    quiet = silenced(model)
    quiet = quiet.starting_at(start_values(quiet, stretch))
    segment = segment_at(quiet, stretch, place)
    inputs = {s: filled(stretch.log[s]) for s in segment.reads if s in stretch.log}
    return driven_to(quiet, segment, stretch.log, inputs, shown)


def _rms(values: Values) -> float:
    return float(np.sqrt(np.nanmean(values**2)))

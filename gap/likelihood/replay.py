"""What a model without wandering loads leaves of a record: a pinned replay tells all that a filter would.

Nothing is to be estimated there: what drives each block is logged, or follows from what is.  Each row's residual is
white but for what runs of the model themselves show (``stickslip.gap.null_model.null_model``), so its innovations are

    e = L^-1 (r_k - sum_j A_j r_(k-j)) / factor          factor: of the noise of the sensor that gives the signal
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from stickslip.blocks.role import Role
from stickslip.diagram.diagram import Diagram
from stickslip.diagram.inputs import close, source_name
from stickslip.gap.insertion.paths import noise_of
from stickslip.gap.likelihood.frame import Frame
from stickslip.gap.linearised.filtered import filter_of
from stickslip.gap.linearised.usual import null_model_of_record, suspected
from stickslip.gap.null_model.modes import CHARGE, branches_of
from stickslip.gap.null_model.null_model import NullModel, measured
from stickslip.gap.records.given import Given
from stickslip.gap.records.model import silenced
from stickslip.gap.records.offsets import branched
from stickslip.gap.records.record import FEWEST, GapError, Record
from stickslip.gap.records.start import start_values
from stickslip.logs.arrays import Values

RUNS = 40  # of the model without a gap
AFTER_LIMIT = 6  # rows behind a limit that are not scored where residuals are predicted


@dataclass(frozen=True, eq=False)
class Left:
    """What a replay leaves: innovations ``e`` (rows, signals), their variances ``S``, and what modes cost that were set
    right, ``charge`` [nats].
    """

    e: Values
    S: Values
    charge: float


@dataclass(frozen=True, eq=False)
class Replays(Frame):
    """A frame whose hypotheses are replayed; ``null_model`` what replays of runs without a gap leave."""

    null_model: NullModel = field(kw_only=True)

    @property
    def replays(self) -> bool:
        """True."""
        return True

    @cached_property
    def scans(self) -> None:
        """None: no filter follows it."""
        return None

    @property
    def skipped(self) -> int:
        """Rows at the beginning that are not judged."""
        return self.null_model.skipped

    @cached_property
    def quick(self) -> "Replays":
        """The frame in which a large diagram does between rows what the model does: a replay takes a tenth there."""
        if self.record.filter is None:
            return self
        return replace(self, record=replace(self.record, filter=self.record.filter.holding(self.quiet, self.record)))

    def scaled(self, e: Values, charge: float, settings: Mapping[str, float]) -> Left:
        """Return innovations of the scored rows in the noise that settings have, in place of what is stated."""
        columns = [self.record.pinned.index(s) for s in self.signals]
        unit, factor = np.diag(self.null_model.L)[columns], np.ones(len(self.signals))
        for block, signals in self.factors.items():
            by = settings[f"{block}.sd"] / self.given.base.stated[f"{block}.sd"]
            factor[[self.signals.index(s) for s in signals]] = by
        whole = np.concatenate([np.full((self.null_model.skipped, len(factor)), np.nan), e / factor])
        return Left(whole, np.where(np.isnan(whole), np.nan, (unit * factor) ** 2), charge)

    @property
    def changing(self) -> tuple[str, ...]:
        """Signals without a level, whose change is judged; a stem is held to the OP of each row."""
        moves = [s for s, yes in zip(self.record.pinned, self.null_model.changes, strict=True) if yes]
        return tuple(s for s in moves if self.model.blocks[self.model.driven[s][0]].role is not Role.VALVE)

    @cached_property
    def at_limit(self) -> NDArray[np.bool_]:
        """Whether a logged signal is at a limit of the block that drives it, or was a moment ago, (rows,).

        There the model is not linear, and a filter of it says nothing for some rows.
        """
        log = self.record.log
        found = np.zeros(len(log), dtype=bool)
        for s in self.record.pinned:
            block = self.quiet.blocks[self.quiet.driven[s][0]]
            if block.limit_params is None:
                continue
            low, high = block.limits
            near = 1.5 * self.record.lattice(s)
            found |= (log[s] <= low + near) | (log[s] >= high - near)
        for back in range(1, AFTER_LIMIT):
            found[back:] |= found[:-back].copy()
        return found

    @cached_property
    def factors(self) -> dict[str, tuple[str, ...]]:
        """The noise whose size is that of a signal's residuals: block of the noise -> signals."""
        found: dict[str, list[str]] = {}
        for s in self.signals:
            sensor = self.model.blocks[self.model.driven[s][0]]
            block = noise_of(self.model, sensor)
            if block:
                found.setdefault(block, []).append(s)
        return {block: tuple(signals) for block, signals in found.items()}


def replays_of(model: Diagram, record: Record, seed: int = 0) -> Replays:
    """Return the frame of a model and a record of which no filter is made.

    Raises ``GapError`` if no run of the model comes to its end, or too few rows are left once it has settled.
    """
    quiet = silenced(model)
    filtered = filter_of(model, quiet, record)
    record = record if filtered is None else filtered
    start = start_values(quiet, record) if filtered is None else {}
    model, quiet = model.starting_at(start), quiet.starting_at(start)
    if filtered is not None:
        record, null_model, usual = null_model_of_record(model, quiet, record, RUNS, seed + 1)
        record = suspected(quiet, record, null_model, usual)
    else:
        null_model, _ = measured(model, quiet, record, RUNS, seed + 1)
    left = len(record.log) - null_model.skipped
    if left < FEWEST:
        raise GapError(
            f"of the log's {len(record.log)} rows {max(left, 0)} are left once the model has settled, which is "
            f"too few to tell a gap; give at least {null_model.skipped + FEWEST}"
        )
    return Replays(Given(model), record, null_model=null_model)


def left_by_replays(
    f: Replays, silent: Diagram, many: Sequence[Mapping[str, float]], noise: frozenset[str], modes: bool = True
) -> list[Left | None]:
    """Return what a silent diagram leaves with each of many sets of parameters; None for a run that fails.

    ``noise``: the parameters among these that only make random numbers larger; ``modes`` whether wrong modes of a stem
    are set right.
    """
    keys = [key for key in (many[0] if many else {}) if key not in noise]
    rows = [tuple(own[key] for key in keys) for own in many]
    distinct = list(dict.fromkeys(rows))
    found = dict(zip(distinct, _replayed(f, silent, keys, distinct, modes), strict=True))
    each = ((found[row], own) for row, own in zip(rows, many, strict=True))
    return [None if left is None else f.scaled(*left, own) for left, own in each]


def _replayed(
    f: Replays, silent: Diagram, keys: Sequence[str], rows: Sequence[tuple[float, ...]], modes: bool
) -> list[tuple[Values, float] | None]:
    """Return innovations in the stated noise, and the charge of modes that were set right, of each run."""
    if not rows:
        return []
    record = f.record
    moving = {*record.leads, *record.ramps} & {*record.played}
    if moving and record.filter is None:  # which knows when inputs switch
        silent = close(silent, {s: record.source(s, name=source_name(silent, s)) for s in moving})
        record = replace(record, played=tuple(s for s in record.played if s not in moving))
    params = {key: np.array([row[k] for row in rows]) for k, key in enumerate(keys)}
    branches = branches_of(silent, f.quiet, record, f.null_model, params) if modes else None
    found, kept = branched(silent, record, params, branches=branches, workers=1)
    left = f.null_model.innovations(found)[..., [record.pinned.index(s) for s in f.signals]]
    if f.null_model.coloured and record.filter is None:
        left[:, f.at_limit[f.null_model.skipped :][: left.shape[1]]] = np.nan
    return [None if np.isnan(e).all() else (e, CHARGE * charge) for e, charge in zip(left, kept.tolist(), strict=True)]

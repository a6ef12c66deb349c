"""What a model without wandering loads leaves of a record: a pinned replay tells all that a filter would.

Nothing is to be estimated there: what drives each block is logged, or follows from what is.  Each row's residual is
white but for what runs of the model themselves show (``stickslip.gap.floors.floor``), so its innovations are

    e = L^-1 (r_k - sum_j A_j r_(k-j)) / factor          factor: of the noise of the sensor that gives the signal
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from stickslip.blocks.role import Role
from stickslip.diagram.diagram import Diagram
from stickslip.diagram.inputs import close, source_name
from stickslip.gap.floors.cache import keep, kept
from stickslip.gap.floors.floor import Floor, measured
from stickslip.gap.floors.modes import CHARGE, branches_of
from stickslip.gap.insertion.paths import noise_of
from stickslip.gap.likelihood.frame import Frame
from stickslip.gap.linearised.filtered import filter_of
from stickslip.gap.linearised.usual import floor_of_record, suspected
from stickslip.gap.records.given import Given
from stickslip.gap.records.model import silenced
from stickslip.gap.records.offsets import branched
from stickslip.gap.records.record import FEWEST, GapError, Record
from stickslip.gap.records.start import start_values

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Replays(Frame):
    """A frame whose hypotheses are replayed; ``floor`` what replays of runs without a gap leave."""

    floor: Floor = field(kw_only=True)

    @property
    def replays(self) -> bool:
        return True

    @cached_property
    def scans(self) -> None:
        """None: no filter follows it."""
        return None

    @property
    def skipped(self) -> int:
        """Rows at the beginning that are not judged."""
        return self.floor.skipped

    @property
    def changing(self) -> tuple[str, ...]:
        """Signals without a level, whose change is judged; a stem is held to the OP of each row."""
        moves = [s for s, yes in zip(self.record.pinned, self.floor.changes, strict=True) if yes]
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
            found[back:] |= found[:-back] & True
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


RUNS = 40  # of the model without a gap
AFTER_LIMIT = 6  # rows behind a limit that are not scored where residuals are predicted


def replays_of(model: Diagram, record: Record, seed: int = 0) -> Replays:
    """Return the frame of a model and a record of which no filter is made.

    Raises ``GapError`` if no run of the model comes to its end, or too few rows are left once it has settled.
    """
    quiet = silenced(model)
    filtered = filter_of(model, quiet, record)
    record = record if filtered is None else filtered
    start = start_values(quiet, record) if filtered is None else {}
    model, quiet = model.starting_at(start), quiet.starting_at(start)
    floor = None
    if filtered is not None:
        record, floor, usual = floor_of_record(model, quiet, record, RUNS, seed + 1)
        record = suspected(quiet, record, floor, usual)
    floor = floor or kept(model, record)
    if floor is None:
        floor, _ = measured(model, quiet, record, RUNS, seed + 1)
        keep(model, record, floor)
    left = len(record.log) - floor.skipped
    if left < FEWEST:
        raise GapError(
            f"of the log's {len(record.log)} rows {max(left, 0)} are left once the model has settled, which is "
            f"too few to tell a gap; give at least {floor.skipped + FEWEST}"
        )
    return Replays(Given(model), record, floor=floor)


def left_by_replays(
    one: Any, many: Sequence[Mapping[str, float]], modes: bool = True
) -> list[tuple[Floats, Floats, float] | None]:
    """Return innovations (rows, signals), their variances, and what modes cost that were set right, of each run; None
    for one that fails.
    """
    if not many:
        return []
    f, record, diagram = one.frame, one.frame.record, one.silent
    settings = [one.settings(values) for values in many]
    moving = {*record.leads, *record.ramps} & {*record.played}
    if moving and record.filter is None:  # which knows when inputs switch
        diagram = close(diagram, {s: record.source(s, name=source_name(diagram, s)) for s in moving})
        record = replace(record, played=tuple(s for s in record.played if s not in moving))
    keys = [k for k in settings[0] if k not in one.drawing]
    params = {k: np.array([own[k] for own in settings]) for k in keys}
    branches = branches_of(diagram, f.quiet, record, f.floor, params) if modes else None
    found, kept = branched(diagram, record, params, branches=branches, workers=1)
    columns = [record.pinned.index(s) for s in f.signals]
    unit = np.diag(f.floor.L)[columns]
    left = f.floor.innovations(found)[..., columns]
    if f.floor.coloured and record.filter is None:
        left[:, f.at_limit[f.floor.skipped :][: left.shape[1]]] = np.nan
    results: list[tuple[Floats, Floats, float] | None] = []
    for own, e0, charge in zip(settings, left, kept, strict=True):
        if np.isnan(e0).all():
            results.append(None)
            continue
        factor = np.ones(len(f.signals))
        for block, signals in f.factors.items():
            for s in signals:
                factor[f.signals.index(s)] = own[f"{block}.sd"] / f.given.base.stated[f"{block}.sd"]
        e = np.concatenate([np.full((f.floor.skipped, len(f.signals)), np.nan), e0 / factor])
        results.append((e, np.where(np.isnan(e), np.nan, (unit * factor) ** 2), CHARGE * float(charge)))
    return results

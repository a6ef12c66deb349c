"""When everything in a model scans in step with the rows of its log, and what its logged inputs are at each scan."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from stickslip.blocks.block import Block
from stickslip.blocks.role import Role
from stickslip.diagram.diagram import Diagram
from stickslip.gap.insertion.paths import made_of
from stickslip.gap.records.record import Record
from stickslip.logs.arrays import Values

EVEN = 1e-6  # of a scan, by which a row may lie off it
SELDOM = 0.1  # share of rows behind which an output may have been at a limit
UNSEEN = 0.5  # of the largest change of an output from row to row: as far it may have gone beyond between two


@dataclass(frozen=True, eq=False)
class Scans:
    """``period`` of a scan [s], ``every`` how many scans a row comes, ``controllers`` from the outer one inwards,
    ``u`` logged inputs, the time [s] and 1 at each scan, (scans, kinds); ``limited`` behind which rows an output may
    have been at a limit, (controllers, rows).
    """

    period: float
    every: int
    controllers: tuple[str, ...]
    u: Values
    limited: NDArray[np.bool_]

    @property
    def unsure(self) -> NDArray[np.bool_]:
        """Rows at which, or just before which, an output may have been at a limit, (controllers, rows)."""
        before = np.zeros_like(self.limited)
        before[:, 1:] = self.limited[:, :-1]
        return np.asarray(self.limited | before)


def base_period(diagram: Diagram) -> float:
    """Return the shortest scan period of a diagram's blocks [s], 0 where nothing scans."""
    return min((b.period for b in diagram.blocks if b.sampled), default=0.0)


def scans_of(quiet: Diagram, record: Record) -> Scans | None:
    """Return the scans of a record; None where rows lie between scans, or a controller does not scan, is not logged, or
    may have been at a limit often.

    ``quiet``: the model without random numbers.
    """
    log, period = record.log, base_period(quiet)
    if period <= 0.0 or record.ramps or not _whole(log.dt, period) or not _whole(float(log.t[0]), period):
        return None
    every = round(log.dt / period)
    acting = [b for b in quiet.blocks if b.role is Role.CONTROLLER]
    if every < 1 or float(np.ptp(np.diff(log.t))) > EVEN * log.dt or not acting:
        return None
    if not all(b.sampled and b.limit_params is not None and str(b.output_labels[0]) in record.pinned for b in acting):
        return None
    names = _from_outside(quiet, acting)
    limited = np.array([_limited(quiet[name], record, every) for name in names])
    if limited.mean(axis=1).max() > SELDOM:
        return None
    return Scans(period, every, names, _inputs(record, period, every), limited)


def _whole(time: float, period: float) -> bool:
    return abs(time / period - round(time / period)) < EVEN


def _limited(block: Block, record: Record, every: int) -> NDArray[np.bool_]:
    """Return behind which rows the output of a controller may have been at a limit, from row to row as well."""
    values = record.log[str(block.output_labels[0])]
    low, high = block.limits
    after = np.append(values[1:], values[-1:])
    unseen = UNSEEN * np.abs(after - values) if every > 1 else np.zeros(len(values))
    found: NDArray[np.bool_] = np.minimum(values, after) - unseen <= low
    return found | (np.maximum(values, after) + unseen >= high)


def _from_outside(diagram: Diagram, acting: list[Block]) -> tuple[str, ...]:
    """Return the names of controllers, the outer one of a cascade before those whose set points it moves."""
    given_by = {str(b.output_labels[0]): b for b in acting}

    def depth(block: Block) -> int:
        behind = [given_by[s] for s in made_of(diagram, str(block.loop_signal("SP"))) if s in given_by]
        return 1 + max((depth(b) for b in behind if b is not block), default=0)

    return tuple(b.name for b in sorted(acting, key=depth))


def _inputs(record: Record, period: float, every: int) -> Values:
    """Return logged inputs, held between their switches, the time and 1, at each scan."""
    log = record.log
    count = (len(log) - 1) * every + 1
    found = np.ones((count, len(record.played) + 2))
    for j, s in enumerate(record.played):
        found[:, j] = np.repeat(log[s], every)[:count]
        leads: Mapping[int, float] = record.leads.get(s, {})
        for row, lead in leads.items():
            if row >= len(log):
                continue
            early = min(int(lead / period + EVEN), every - 1)
            found[row * every - early : row * every, j] = log[s][row]
    found[:, -2] = float(log.t[0]) + period * np.arange(count)
    return found

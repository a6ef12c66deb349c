"""Where a model starts in a record: the states and memories with which the first offsets vanish.

    min over s of  sum over the first rows and all pinned signals of ((o(s) - 0) / spread of the signal)^2

by Gauss and Newton, from the model's own start values; what the first rows do not feel stays as the model says.  A
model may start so far away that all slopes are hidden by limits: a controller may also start settled at the first row.
"""

from collections.abc import Mapping, Sequence

import numpy as np
from stickslip.blocks.role import Role
from stickslip.diagram.diagram import Diagram
from stickslip.gap.records.model import smooth_memories
from stickslip.gap.records.offsets import offsets
from stickslip.gap.records.record import Record
from stickslip.logs.arrays import Values

ROWS = 60  # of the record's beginning
STEP = 1e-3  # perturbation of a start value, in its own size or 1e-3
FELT = 1e-6  # smallest response, in spreads of the signal per unit of start value, that counts
ROUNDS = 8
SHARES = (2.0, 1.0, 0.5, 0.2, 0.05)  # of a step


def start_values(quiet: Diagram, record: Record) -> dict[str, float]:
    """Return the start values of a silent model that suit the first rows of a record, by name."""
    head, spread = _head(record)
    names = _names(quiet)
    if not names:
        return {}
    values, cost = dict(names), np.inf
    settled = _settled(quiet, record)
    others = [{**names, **settled}] if settled else []
    for _ in range(ROUNDS):
        residual, J = _slopes(quiet, head, values, spread)
        cost = float(residual @ residual)
        felt = np.flatnonzero(np.linalg.norm(J, axis=0) > FELT)
        if len(felt) == 0:
            break
        change = np.linalg.lstsq(J[:, felt], -residual, rcond=1e-6)[0]
        keys = list(values)
        # A limit hides a part of the slopes: too long a step is as likely as too short a one.
        ahead = [
            {**values, **{keys[k]: values[keys[k]] + share * float(c) for k, c in zip(felt, change, strict=True)}}
            for share in SHARES
        ] + others
        others = []
        costs = [float(np.sum(one[np.isfinite(one)] ** 2)) for one in _tried(quiet, head, ahead) / spread]
        best = int(np.argmin(costs))
        if not costs[best] < cost:
            break
        values = ahead[best]
        if costs[best] > 0.999 * cost:
            break
    return values


def unsure_starts(quiet: Diagram, record: Record) -> dict[str, float]:
    """Return by how much each state of a silent model may start elsewhere, by name, where the first rows feel it.

    Loads that nobody measures were there before the record.  So a state may be off by what moves some signal by as
    much as that signal moves in the record.
    """
    head, spread = _head(record)
    names = _names(quiet)
    if not names:
        return {}
    _, J = _slopes(quiet, head, names, spread)
    felt = np.max(np.abs(J), axis=0, initial=0.0)
    return {name: float(1.0 / f) for name, f in zip(names, felt, strict=True) if f > FELT}


def _head(record: Record) -> tuple[Record, Values]:
    """Return the first rows of a record, and the spread of each pinned signal over all."""
    log = record.log.samples(0, min(ROWS, len(record.log)))
    spread = np.array([max(float(np.nanstd(record.log[s])), 1e-9) for s in record.pinned])
    return Record(log, record.played, record.pinned, fresh=record.fresh), spread


def _names(quiet: Diagram) -> dict[str, float]:
    """Return the start values of states, and of memories that are smooth, by name."""
    return {
        f"{block.name}.{name}": float(value)
        for block in quiet.blocks
        for name, value in [
            *zip(block.state_names, block.x0, strict=True),
            *((n, v) for n, v in zip(block.memory_names, block.d0, strict=True) if n in smooth_memories(block)),
        ]
    }


def _slopes(quiet: Diagram, head: Record, values: Mapping[str, float], spread: Values) -> tuple[Values, Values]:
    """Return the offsets [spreads] from start values, and their slopes in each of these."""
    found = _tried(quiet, head, [values, *({**values, key: v + _step(v)} for key, v in values.items())]) / spread
    seen = np.isfinite(found).all(axis=0)
    residual = found[0][seen]
    J = np.stack([(found[k + 1][seen] - residual) / _step(v) for k, v in enumerate(values.values())], axis=1)
    return residual, J


def _settled(quiet: Diagram, record: Record) -> dict[str, float]:
    """Return the memories of controllers as they are if all that they read and give has been as in the first row."""
    first = record.first
    found: dict[str, float] = {}
    for block in quiet.blocks:
        if block.role is Role.CONTROLLER and {*block.input_labels, *block.output_labels} <= first.keys():
            u, y = (np.array([first[str(s)] for s in labels]) for labels in (block.input_labels, block.output_labels))
            ready = block.settled(u, y)
            found |= {f"{block.name}.{n}": float(v) for n, v in zip(block.memory_names, ready.d0, strict=True)
                      if n in smooth_memories(block)}  # fmt: skip
    return found


def _tried(quiet: Diagram, head: Record, many: Sequence[Mapping[str, float]]) -> Values:
    """Return the offsets from each set of start values, (sets, rows, signals)."""
    start = {key: np.array([values[key] for values in many]) for key in many[0]}
    return offsets(quiet, head, start=start, workers=1)  # a thread costs more than such short runs


def _step(value: float) -> float:
    return STEP * max(abs(value), 1.0)

"""Where a model starts in a record: the states and memories with which the first offsets vanish.

    min over s of  sum over the first rows and all pinned signals of ((o(s) - 0) / spread of the signal)^2

by Gauss and Newton, from the model's own start values; what the first rows do not feel stays as the model says.
"""

import numpy as np

from blocks.noise import seeded
from diagram.diagram import Diagram
from gap.offsets import offsets
from gap.record import Record

ROWS = 60  # of the record's beginning
STEP = 1e-3  # perturbation of a start value, in its own size or 1e-3
FELT = 1e-6  # smallest response, in spreads of the signal per unit of start value, that counts
ROUNDS = 3
NO_STATE = {"mode", *seeded(0)}  # memories that are switches or random numbers


def start_values(quiet: Diagram, record: Record) -> dict[str, float]:
    """Return the start values of a silent model that suit the first rows of a record, by name."""
    log = record.log.samples(0, min(ROWS, len(record.log)))
    head = Record(log, record.played, record.pinned)
    spread = np.array([max(float(np.nanstd(record.log[s])), 1e-9) for s in record.pinned])
    names = {
        f"{block.name}.{name}": float(value)
        for block in quiet.blocks
        for name, value in [
            *zip(block.state_names, block.x0, strict=True),
            *((n, v) for n, v in zip(block.memory_names, block.d0, strict=True) if n not in NO_STATE),
        ]
    }
    if not names:
        return {}
    values, cost = dict(names), np.inf
    for _ in range(ROUNDS):
        start = {key: np.full(len(values) + 1, value) for key, value in values.items()}
        for k, (key, value) in enumerate(values.items(), start=1):
            start[key][k] = value + _step(value)
        found = offsets(quiet, head, start=start) / spread
        seen = np.isfinite(found).all(axis=0)
        residual = found[0][seen]
        if not (new := float(residual @ residual)) < cost:
            break
        best, cost = dict(values), new
        J = np.stack([(found[k + 1][seen] - residual) / _step(v) for k, v in enumerate(values.values())], axis=1)
        felt = np.flatnonzero(np.linalg.norm(J, axis=0) > FELT)
        if len(felt) == 0:
            break
        change = np.linalg.lstsq(J[:, felt], -residual, rcond=1e-6)[0]
        keys = list(values)
        values = {**values, **{keys[k]: values[keys[k]] + float(c) for k, c in zip(felt, change, strict=True)}}
    last = offsets(quiet, head, start={key: [value] for key, value in values.items()})[0] / spread
    seen = np.isfinite(last)
    return values if seen.any() and float(np.sum(last[seen] ** 2)) < cost else best


def _step(value: float) -> float:
    return STEP * max(abs(value), 1.0)

"""Pinned replays of many variants of one wiring: what each pin had to add at each row (``diagram.pins``).

A variant is a whole diagram; those of one wiring differ in values only, so they run side by side as one ensemble.
"""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from diagram.diagram import Diagram
from diagram.ensembles.result import Ensemble
from diagram.pins import replays
from gap.record import Record
from logs import Log

Floats = NDArray[np.float64]


def offsets(variants: Sequence[Diagram], record: Record, logs: Sequence[Log] | None = None) -> Floats:
    """Return what the pins add, (variants, rows, pinned signals); NaN where a signal is missing or a run failed.

    ``logs``: one a variant in place of the record's, with the same signals and rows.
    """
    params, start = differences(variants)
    many = replays(
        variants[0],
        record.log if logs is None else list(logs),
        signals=[*record.played, *record.pinned],
        keep=[f"{s}:offset" for s in record.pinned],
        params=params,
        start=start,
        progress=False,
    )
    return stacked(many, record, len(variants))


def stacked(many: Ensemble, record: Record, runs: int) -> Floats:
    """Return the offsets of an ensemble as one array, (runs, rows, pinned signals)."""
    found = np.stack([many.values[f"{s}:offset"] for s in record.pinned], axis=-1)
    if len(found) < runs:  # variants that are all alike run once
        found = np.repeat(found, runs, axis=0)
    bad = ~np.stack([record.log.good(s) for s in record.pinned], axis=-1)
    return np.where(bad[None], np.nan, found)


def differences(variants: Sequence[Diagram]) -> tuple[dict[str, Floats], dict[str, Floats]]:
    """Return the parameters and start values in which diagrams of one wiring differ, (variants,) each."""
    params: dict[str, Floats] = {}
    start: dict[str, Floats] = {}
    for blocks in zip(*(variant.blocks for variant in variants), strict=True):
        first = blocks[0]
        places = [
            (params, first.param_names, np.array([block.p[: len(first.param_names)] for block in blocks])),
            (start, first.state_names, np.array([block.x0 for block in blocks])),
            (start, first.memory_names, np.array([block.d0 for block in blocks])),
        ]
        for found, names, table in places:
            for name, column in zip(names, table.T, strict=True):
                if (column != column[0]).any():
                    found[f"{first.name}.{name}"] = column
    if not params and not start:
        name, key = next((b.name, b.param_names[0]) for b in variants[0].blocks if b.param_names)
        params[f"{name}.{key}"] = np.full(len(variants), variants[0][name].p[0])
    return params, start


def with_starts(diagram: Diagram, start: Mapping[str, float]) -> Diagram:
    """Return the diagram with those start values that its blocks have."""
    names = {block.name: {*block.state_names, *block.memory_names} for block in diagram.blocks}
    known = {k: v for k, v in start.items() if k.rpartition(".")[2] in names.get(k.rpartition(".")[0], ())}
    return diagram.starting_at(known) if known else diagram

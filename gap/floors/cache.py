"""Floors that are known already: kept in a file for each model, set of logged signals, interval and rounding.

A floor depends on the model with its nuisances and on how its log is written, hardly on the set points and the length,
but where the model has little noise on how far its signals range (by powers of two); its score is kept for each row.
(That of a large diagram is made again where a log is much shorter or longer, or has the first switches.)  Files appear
whole or not at all; one that cannot be read is made again.
"""

import contextlib
import hashlib
import os
from dataclasses import replace
from pathlib import Path

import numpy as np
from stickslip.diagram.diagram import Diagram
from stickslip.gap.floors.floor import Floor, foretold, settling_rows, sharpest, skipped_rows
from stickslip.gap.records.record import Record, switches
from stickslip.logs.files.write import replacing

VERSION = 7  # of what a floor is


def folder() -> Path:
    """Return the folder for kept noise floors: STICKSLIP_CACHE, by default ``~/.cache/stickslip``."""
    named = os.environ.get("STICKSLIP_CACHE")
    return (Path(named) if named else Path.home() / ".cache" / "stickslip") / "gap"


def digest(model: Diagram, record: Record) -> str:
    """Return one key for all that a noise floor depends on: wiring, parameters, tolerances, signals, interval,
    rounding.
    """
    told: list[object] = [VERSION, record.pinned, record.played, round(record.log.dt, 9)]
    if record.filter is not None:  # whose floor has many numbers, of rows behind switches too
        switching = any(switches(record.log, s) for s in record.played)
        told.append((len(record.log).bit_length(), switching))
    else:  # what a model without noise is judged by follows from the record's own ranges
        least = [max(sharpest(model, record, s), foretold(model, record, s)) for s in record.pinned]
        told.append([float(f"{one:.3g}") for one in least])
    told.append({s: float(f"{step:.3g}") for s, step in record.steps.items()})
    for block in model.blocks:
        labels = list(block.input_labels), list(block.output_labels)
        told.append((type(block).__name__, block.name, labels, np.asarray(block.p).round(12).tolist()))
    return hashlib.sha256(repr(told).encode()).hexdigest()[:24]


def kept(model: Diagram, record: Record) -> Floor | None:
    """Return the kept noise floor of a model for such records, if there is one."""
    try:
        with np.load(folder() / f"{digest(model, record)}.npz") as found:
            floor = Floor(
                found["changes"], found["A"], found["L"], int(found["skipped"]), found["scores"], int(found["rows"])
            )
    except (OSError, ValueError, KeyError, EOFError):
        return None
    return replace(floor, skipped=skipped_rows(len(record.log), settling_rows(model, record)))


def keep(model: Diagram, record: Record, floor: Floor) -> None:
    """Keep a noise floor; if nothing can be written, it is measured again next time."""
    with contextlib.suppress(OSError):
        folder().mkdir(parents=True, exist_ok=True)
        with replacing(folder() / f"{digest(model, record)}.npz") as part, open(part, "wb") as file:
            np.savez(file, **vars(floor))

"""The log that a run keeps: its times and signals, and whether it fits into the memory of the machine."""

import math
import os
from collections.abc import Sequence
from functools import cache

import numpy as np
from numpy.typing import ArrayLike, NDArray
from stickslip.blocks.arguments import texts
from stickslip.blocks.ports import nearest, number
from stickslip.diagram.wired import Wired
from stickslip.engine import snapshot
from stickslip.engine.table import Component
from stickslip.logs.arrays import seconds_and_start

Floats = NDArray[np.float64]
MEMORY_SHARE = 0.8  # of the machine's memory that the values may take


def log_times(
    duration: float, every: float | None, times: ArrayLike | None, t0: float, signals: int = 1, variants: int = 1
) -> Floats:
    """Return the log times [s]; refuse requests that make no sense, or rows that the memory cannot hold.

    ``signals``, ``variants``: how many values each row holds.
    """
    duration, t0 = number("simulate", "duration", duration), number("simulate", "t0", t0)
    if not (math.isfinite(duration) and duration > 0.0):
        raise ValueError(f"duration = {duration!r}, but it must be a positive number of seconds; give e.g. 600.0")
    if not math.isfinite(t0):
        raise ValueError(f"t0 = {t0!r}, but it must be a number of seconds; give 0.0")
    t_end = t0 + duration
    if times is not None:
        if every is not None:
            raise ValueError(f"every = {every!r} and times are both given, but one of them says when to log; drop one")
        grid = _asked(times, t0, t_end)
        check_memory(variants, signals, len(grid))
        return grid
    step = duration / 1000.0 if every is None else number("simulate", "every", every)
    if not (math.isfinite(step) and 0.0 < step <= duration):
        raise ValueError(
            f"every = {step!r}, but the log interval must be positive and at most the duration, {duration} s; "
            "give a shorter one, or none for 1000 intervals"
        )
    rows = math.floor(duration / step + 1e-9) + 1
    check_memory(variants, signals, rows)
    even: Floats = np.arange(rows, dtype=np.float64)
    even *= step
    even += t0
    even[-1] = min(even[-1], t_end)
    return even


def _asked(times: ArrayLike, t0: float, t_end: float) -> Floats:
    try:
        seconds, moment = seconds_and_start(times)  # durations become seconds
        grid = np.array(seconds, dtype=float)
    except (TypeError, ValueError):
        raise ValueError(f"times = {times!r}, but log times are numbers of seconds; give an array of them") from None
    if moment is not None:
        raise ValueError(
            f"times begin at {moment}, but a run counts seconds from t0 = {t0:g} and has no clock; "
            "give (times - times[0]).total_seconds()"
        )
    if grid.ndim > 1:
        raise ValueError(f"times has shape {grid.shape}, but log times stand in one row; give an array of shape (n,)")
    grid = grid.ravel()
    rounding = 4.0 * np.spacing(max(abs(t0), abs(t_end)))
    inside = grid.size > 0 and grid[0] >= t0 - rounding and grid[-1] <= t_end + rounding
    if not (inside and (grid[1:] > grid[:-1]).all()):
        raise ValueError(
            f"times = {np.array2string(grid, threshold=6)} s, but they must be finite and increase strictly "
            f"within {t0} .. {t_end} s; leave out those beyond, or give a longer duration"
        )
    return grid if t0 <= grid[0] and grid[-1] <= t_end else np.asarray(np.clip(grid, t0, t_end))


def check_memory(variants: int, signals: int, rows: int) -> None:
    """Raise ``ValueError`` if the values of so many variants, signals and rows are more than the memory holds."""
    size, memory = 8.0 * variants * signals * rows, _memory()
    if size > MEMORY_SHARE * memory:
        many = f"{variants} variants x " if variants > 1 else ""
        without = ", or keep_logs=False with a summary=" if variants > 1 else ""
        raise ValueError(
            f"{many}{signals} signals x {rows} rows take {size / 1e9:.0f} GB, the machine has "
            f"{memory / 1e9:.0f} GB; log fewer signals=, or a longer every={without}"
        )


@cache
def _memory() -> float:
    """Return the machine's memory [bytes], infinite where it is not known."""
    known = hasattr(os, "sysconf") and "SC_PHYS_PAGES" in os.sysconf_names
    return os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE") if known else math.inf


def wanted_signals(diagram: Wired, signals: Sequence[str] | None) -> tuple[str, ...]:
    """Return the signals to log, all if none are named; raise ``ValueError`` for one that the diagram has not."""
    if signals is None:
        return diagram.signals
    signals = texts("simulate", "signals", signals)
    for signal in signals:
        if signal not in diagram.signals:
            raise ValueError(f"the diagram has no signal '{signal}'; {nearest(signal, list(diagram.signals))}")
    return tuple(dict.fromkeys(signals))


def logging_only(component: Component, diagram: Wired, wanted: Sequence[str]) -> Component:
    """Return a copy of a component that logs the wanted signals only; its columns say which."""
    names = set(wanted)
    kept = [k for k, column in enumerate(component.columns) if diagram.signals[column] in names]
    return snapshot.logging_only(component, kept)

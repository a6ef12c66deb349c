"""A signal at times at which it was not reported: held from the report before, or on the line between two."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from stickslip.logs.files.names import role_of

__all__ = ["carried", "carried_over", "is_held"]

Values = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

_BLANK_SHARE = 0.2  # share of blank cells from which a wide table is one of reports by exception
_RUNS = 5  # places with blank cells; fewer are stretches without data


def is_held(name: str) -> bool:
    """Whether a signal of this name keeps its value until the next report: SP, OP and MODE do.

    >>> is_held("FIC1.SP"), is_held("FIC1.PV")
    (True, False)
    """
    role = role_of(name)
    return role is not None and role[1] in ("SP", "OP", "MODE")


def carried_over(t: Values, values: dict[str, Values], good: dict[str, Mask], notes: list[str]) -> None:
    """Fill, in place, the columns of a wide table that were not reported in every row.

    Such a column is blank in a fifth of its rows or more, in ``_RUNS`` places or more while others report there; one
    of SP may be blank in a single long stretch. Modes are held where they are read. ``good`` says where a value is
    good; a blank is never bad.
    """
    reported = {name: ~np.isnan(v) for name, v in values.items()}
    anywhere = np.logical_or.reduce([*reported.values()])
    for name, seen in reported.items():
        mask = good.get(name)
        blank = ~seen & anywhere if mask is None else ~seen & anywhere & mask
        runs = int(np.count_nonzero(np.diff(blank.astype(np.int8), prepend=0) == 1))
        role = role_of(name)
        part = "" if role is None else role[1]
        if part == "MODE" or not seen.any() or np.mean(blank) < _BLANK_SHARE or (runs < _RUNS and part != "SP"):
            continue
        rows = np.flatnonzero(seen) if mask is None else np.flatnonzero(seen | ~mask)
        own = mask[rows] if mask is not None else np.ones(len(rows), dtype=bool)
        held = is_held(name)
        values[name], kept = carried(t, t[rows], values[name][rows], own, held=held)
        if mask is not None:
            good[name] = kept
        how = "held from the report before" if held else "on the line between reports"
        notes[:] = [note for note in notes if not (note.startswith(f"{name}: ") and note.endswith("blank: missing."))]
        notes.append(f"{name}: reported in {int(seen.sum())} of {len(t)} rows, {how} in the others.")


def carried(
    axis: npt.NDArray[np.float64],
    t: npt.NDArray[np.float64],
    values: npt.NDArray[np.float64],
    good: npt.NDArray[np.bool_],
    *,
    held: bool,
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.bool_]]:
    """Values and quality on ``axis`` [s] of a signal reported at ``t`` [s]: NaN before the first report.

    Held until the next report, or on the line between two, and then NaN after the last.
    """
    before = np.searchsorted(t, axis, side="right") - 1
    known = before >= 0
    i = np.maximum(before, 0)
    on_report = known & (t[i] == axis)
    carried = np.where(known, values[i], np.nan)
    mask = known & good[i]
    if not held:
        after = np.minimum(i + 1, len(t) - 1)
        width = t[after] - t[i]
        inside = known & ~on_report & (width > 0)
        weight = np.divide(axis - t[i], width, out=np.zeros(len(axis)), where=inside)
        line = values[i] + weight * (values[after] - values[i])
        carried = np.where(on_report, values[i], np.where(inside, line, np.nan))
        mask = np.where(on_report, good[i], inside & good[i] & good[after])
    return carried, mask

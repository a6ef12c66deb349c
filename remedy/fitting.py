"""Fit a loop to its own log: controller from OP, SP and PV; valve and process by likelihood; load and noise, the rest.

1  the controller is read off (``controller``)
2  the likeliest loop without stick, and with it (``search``); the stick is believed where it gains (``weighing``)
3  a population of loops about as likely; what each leaves of PV is its load and noise
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
from stickslip.detect.likelihood.pooled import evidence_of
from stickslip.detect.likelihood.stems import stems_of
from stickslip.detect.prepare.prepared import Grid, prepared
from stickslip.detect.stem.process_kind import kind_of_tag
from stickslip.logs import LoopRecord
from stickslip.logs.arrays import Values
from stickslip.remedy.controller import LEAST, Controller, controller_of, limits_of, moved_from_outside
from stickslip.remedy.left import excitation
from stickslip.remedy.loop_fit import LoopFit
from stickslip.remedy.population import population_of
from stickslip.remedy.process import Day, day_of, predicted
from stickslip.remedy.refusal import STANDS, FitError, refuse_short
from stickslip.remedy.search import best_without
from stickslip.remedy.weighing import weighed

__all__ = ["fit"]

FORMS = 0.01  # share by which K_p differs between two forms of a controller, from which on it is said
WHOLE = 0.9  # of a record and of its rows, below which it is said


def fit(
    records: LoopRecord | Sequence[LoopRecord], progress: Callable[[str], None] = lambda _: None, seed: int = 0
) -> LoopFit:
    """Return the loop fitted to a record, or to several of one loop, which are pooled.

    ``progress`` hears what is done; ``seed`` of the ensemble.  Raises ``FitError`` where the record is too
    short, OP or PV stands, or OP does not follow SP and PV.

    >>> from stickslip.logs import LoopRecord
    >>> fit(LoopRecord.from_arrays([0, 1, 2], pv=[1, 2, 1], op=[5, 5, 5]))
    Traceback (most recent call last):
    ...
    stickslip.remedy.refusal.FitError: the record has 3 samples on an even grid; 200 are needed, a few hours at the scan
    are good
    """
    given = [records] if isinstance(records, LoopRecord) else list(records)
    if not given:
        raise FitError("records is empty; give at least one record of the loop")
    loops = [prepared(record) for record in given]
    days, notes = [], []
    for loop in loops:
        grid = loop.with_stale.whole
        refuse_short(len(grid))
        day = day_of(grid.t, grid.op, grid.pv, grid.sp)
        if day is None:
            raise FitError(STANDS)
        days.append(day)
        notes += _left_out(loop.with_stale.record, grid)
    if any(abs(day.dt - days[0].dt) > 0.02 * days[0].dt for day in days):
        raise FitError(
            f"the records have rows every {', '.join(f'{day.dt:g}' for day in days)} s; give records of one interval"
        )
    progress("reading the controller off OP, SP and PV")
    span = given[0].op_span
    limits = limits_of(np.concatenate([day.op for day in days]), span)
    main = max(days, key=lambda day: len(day.op))
    law = controller_of(main.op, main.pv, main.sp, main.dt, limits)
    if not law.explained >= LEAST or law.K_p == 0.0:
        raise FitError(
            f"a PI law tells {100 * law.explained:.0f} % of how OP moves ({100 * LEAST:.0f} % are needed); log the "
            "controller's own OP and SP at its scan, in automatic, without compression"
        )
    if main.sp is None:
        notes.append("SP is not logged; it is taken to stand.")
    if 1.0 - law.present[0] / law.K_p > FORMS:
        K_p, T_i = law.present
        filters = law.T_d * law.T_f > 0.0
        notes.append(
            f"K_p and T_i are {law.K_p:.3g} and {law.T_i:.3g} s if the integral takes in the error of the row before"
            f"{' and the filter is of all PV' * filters}. With the error of the same row"
            f"{' and a filter of the derivative' * filters} they are {K_p:.3g} and {T_i:.3g} s. The log does not tell "
            "which it is, so the table states the middle."
        )
    if law.explained < 0.9:
        notes.append(f"The PI law tells {100 * law.explained:.0f} % of how OP moves; settings are as unsure.")
    progress("fitting the process without stick")
    kind = kind_of_tag(given[0]).integrating  # of the data, the likelihood of the whole loop says more
    without = best_without(days, kind, math.copysign(1.0, law.K_p))
    stems = [one for day in days if (one := stems_of(day.op, day.pv)) is not None]
    progress("fitting the valve")
    evidence = evidence_of(stems) if stems else None
    seen = weighed(days, without, evidence)
    if seen.starts[0].loop.K == 0.0:
        raise FitError("PV shows no answer to OP: the stem may stand still; log steps of OP in manual, or of SP")
    progress("drawing loops that are about as likely")
    best, likely = population_of(days, seen.starts, seed)
    notes += [seen.note] * bool(seen.note)
    lags = best.loop.tau + best.loop.tau_2 + best.loop.theta
    if seen.sticks and not best.loop.integrating and lags < main.dt:
        notes.append(
            f"The process answers within a row ({lags:.2g} of {main.dt:.3g} s), so that sizes may be farther off than "
            "their intervals say; log at the controller's scan."
        )
    paths = [predicted(days, one, best.noises).shown for one in likely]
    lefts = tuple(
        tuple(day.pv[: own.shape[1]] - one.K * own[1] for own, day in zip(path, days, strict=True))
        for one, path in zip(likely, paths, strict=True)
    )
    return LoopFit(
        given[0].name, "% of OP" if span is not None and tuple(span) == (0.0, 100.0) else "unit of OP",
        given[0].log.units.get(given[0].pv_name, ""), law, tuple(days), seen.without, best, likely, seen.gain,
        seen.sticks, evidence, lefts, np.array([path[0][0, 0] for path in paths]), tuple(notes),
        given[0].log.start, sum(excitation(day.rows, _as_rows(day, law)) for day in days),
    )  # fmt: skip


def _as_rows(day: Day, law: Controller) -> Values:
    """What moves OP and is not PV, in the rows of PV."""
    moved, n = moved_from_outside(law, day.op, day.pv, day.sp), len(day.rows)
    return np.asarray(moved[: n * day.q].reshape(n, day.q).mean(axis=1))


def _left_out(record: LoopRecord, grid: Grid) -> list[str]:
    """What is to be said of a record that the even grid does not hold as it was logged."""
    hours, used = (float(t[-1] - t[0]) / 3600.0 for t in (record.t, grid.t))
    logged = float(np.sum(record.good & (record.t >= grid.t[0]) & (record.t <= grid.t[-1]))) / len(grid)
    short = f"{used:.3g} h of {hours:.3g} h are fitted: the longest stretch without a gap, or its last part."
    thin = f"{100 * (1.0 - logged):.0f} % of the rows are not logged; PV goes in lines there, and OP stands."
    return [short] * (used < WHOLE * hours) + [thin] * (logged < WHOLE)

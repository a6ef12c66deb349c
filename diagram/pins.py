"""Pins: a diagram held to a log, signals set right at every logged time and moved by the diagram in between.

    s(t) = r(t) + o_k,   t_k <= t < t_(k+1),     o_k = v_k - r(t_k)          (``stickslip.blocks.pin``)

r is the signal as its block drives it, v_k its logged value at t_k.  The loop stays closed between samples and is open
across them, so an error at one place shows there and does not wander around the loop.  Nothing logged is interpolated.

The offsets are the residuals.  Behind a sensor the offset itself is its noise; behind a controller, whose integral runs
on freely, the change from one offset to the next is the one-step error.  Without a gap between diagram and log they are
noise and rounding.  At one instant pins follow the flow of signals, and each sees what the blocks before it make of the
instant: a valve that slips when OP jumps has slipped before its MV is compared with the log.
"""

from collections.abc import Mapping, Sequence
from typing import Any, Unpack

import numpy as np
from numpy.typing import ArrayLike, NDArray
from stickslip.blocks.block import Block
from stickslip.diagram.branches import Branches, times_of_rows
from stickslip.diagram.diagram import Diagram
from stickslip.diagram.ensembles.result import Ensemble
from stickslip.diagram.ensembles.running import Summary, ensemble
from stickslip.diagram.inputs import Inputs
from stickslip.diagram.pinning import Fresh, logged, pin_blocks, pinned
from stickslip.diagram.progress import Progress
from stickslip.diagram.settings import Changes, Settings, settings_of
from stickslip.diagram.simulation import Run, simulate
from stickslip.logs import Log

Floats = NDArray[np.float64]


def residuals(run: Run) -> dict[str, Floats]:
    """Return signal -> (rows,): what each pin had to add at each time of the run's log, in the signal's unit.

    NaN at rows where the signal was not logged: the pin holds its last offset there, which says nothing new.
    """
    found = {}
    for block in run.diagram.blocks:
        offset = f"{block.output_labels[0]}:offset" if block.output_labels else ""
        if block.timetable is not None and offset in block.output_labels and offset in run.log:
            known = times_of_rows(block)
            near = known[np.clip(np.searchsorted(known, run.log.t - 0.5 * _rounding(run.log.t)), 0, len(known) - 1)]
            listed = np.abs(near - run.log.t) <= _rounding(run.log.t)
            found[block.output_labels[0]] = np.where(listed, run.log[offset], np.nan)
    return found


def replay(
    diagram: Diagram,
    log: Log,
    *,
    signals: Sequence[str] | None = None,
    params: Mapping[str, float] | None = None,
    start: Mapping[str, float] | None = None,
    branches: Branches | None = None,
    settings: Settings | None = None,
    **changes: Unpack[Changes],
) -> Run:
    """Simulate the diagram pinned to a log, from its first to its last time, with one row for each of them.

    ``signals``: those to pin, by default all that log and diagram share; ``branches``: modes of a block to try where a
    sample does not fit (``stickslip.diagram.branches``); the rest as in ``simulate``.

    >>> from stickslip.blocks import FirstOrder, Step
    >>> from stickslip.diagram import wire
    >>> from stickslip.diagram.pins import replay, residuals
    >>> model = wire([Step("MV", 1.0), FirstOrder(K=2.0, tau=5.0)])
    >>> run = replay(model, Log(t=[0.0, 5.0, 10.0], signals={"PV": [0.1, 1.3, 1.7]}))
    >>> residuals(run)["PV"].round(4).tolist()
    [0.1, 0.0358, -0.0293]
    """
    held = pinned(diagram, log, signals)
    return simulate(
        held, log.duration, times=log.t, t0=float(log.t[0]), params=params, start=start, branches=branches,
        settings=settings_of(replay, settings, changes),
    )  # fmt: skip


def replays(
    diagram: Diagram,
    logs: Log | Sequence[Log],
    *,
    signals: Sequence[str] | None = None,
    keep: Sequence[str] | None = None,
    params: Mapping[str, ArrayLike] | None = None,
    start: Mapping[str, ArrayLike] | None = None,
    inputs: Inputs | None = None,
    fresh: Fresh | None = None,
    summary: Summary | None = None,
    keep_logs: bool = True,
    branches: Branches | None = None,
    settings: Settings | None = None,
    workers: int | None = None,
    progress: Progress = False,
    **changes: Unpack[Changes],
) -> Ensemble:
    """Replay many times on all cores: parameters, start values and logs as arrays, one entry a run.

    ``logs``: one for all runs, which share its tables, or one a run with equal numbers of rows: other records, or
    windows of one, ``log.between(t0, t1)``. ``inputs`` as in ``ensemble``, of what no log has; ``fresh`` as in
    ``Diagram.pinned``. ``keep``: the signals to keep, by default the offsets (``PV:offset``, (runs, rows)).
    ``summary`` with ``keep_logs=False`` keeps numbers only; ``branches`` as in ``replay``; the rest as in
    ``ensemble``.

    Raises ``ValueError`` if logs differ in their number of rows, or in the signals that they have.

    >>> import numpy as np
    >>> from stickslip.blocks import FirstOrder, Step
    >>> from stickslip.diagram import wire
    >>> from stickslip.diagram.pins import replays
    >>> model = wire([Step("MV", 1.0), FirstOrder(K=2.0, tau=5.0)])
    >>> log = Log(t=[0.0, 5.0, 10.0], signals={"PV": [0.0, 1.264241, 1.729329]})
    >>> many = replays(model, log, params={"process.K": [1.8, 2.0]})
    >>> abs(many.values["PV:offset"]).round(4).tolist()
    [[0.0, 0.1264, 0.1729], [0.0, 0.0, 0.0]]
    """
    each = [logs] if isinstance(logs, Log) else list(logs)
    if not each or len({len(log) for log in each}) > 1:
        raise ValueError(
            f"the logs have {sorted({len(log) for log in each})} rows, but runs side by side have equally many; "
            "give windows of one length, log.samples(first, stop)"
        )
    names = logged(diagram, each[0], signals)
    held = pinned(diagram, each[0], names, fresh)
    own: dict[str, list[Block]] = {}
    if not isinstance(logs, Log):
        for log in each:
            played, pins = pin_blocks(diagram, log, logged(diagram, log, names), fresh)
            for block in (*played.values(), *pins):
                own.setdefault(block.name, []).append(block)
    return ensemble(
        held,
        max(log.duration for log in each),
        params=params,
        start=start,
        t0=float(each[0].t[0]) if isinstance(logs, Log) else [float(log.t[0]) for log in each],
        times=each[0].t if isinstance(logs, Log) else np.array([log.t for log in each]),
        inputs=inputs,
        blocks=own,
        signals=[s for s in held.signals if s.endswith(":offset")] if keep is None else keep,
        summary=summary,
        keep_logs=keep_logs,
        branches=branches,
        settings=settings_of(replays, settings, changes),
        workers=workers,
        progress=progress,
    )


def _rounding(t: Any) -> Any:
    return 4.0 * np.spacing(np.maximum(1.0, np.abs(t)))

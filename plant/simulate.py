"""Simulate a diagram with the compiled engine: a log at the times asked for, events, status, statistics."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from blocks.block import Block
from blocks.ports import nearest, shortened
from engine import layout as at
from engine.run import METHODS, Outcome, Settings, prepare, run
from engine.status import HINTS, Statistics, Status
from plant.diagram import Diagram
from plant.flatten import DELAY_RECORDS, Ends, Past, Plan, plan
from plant.in_python import InPython, counts, spent
from plant.inputs import close
from plant.wiring import WiringError
from records import Log

if TYPE_CHECKING:
    import polars as pl
    from matplotlib.figure import Figure

Floats = NDArray[np.float64]
MOST_BLAMED = 6  # blocks that a hint names


@dataclass(frozen=True)
class Event:
    """A change of mode: time [s], block, mode before, mode after."""

    t: float
    block: str
    before: str
    after: str


@dataclass(frozen=True, repr=False)
class Run:
    """What a simulation gave: a log, the events in order of time, a status with a hint, what it cost, the end.

    If ``status`` is not OK the log holds the rows reached and NaN after them, and ``hint`` says what to try.
    ``final`` is the diagram at the end of the run: simulate it with ``t0`` = that time to go on (only blocks that run
    in Python begin anew).  ``ends`` are the engine's arrays there.  ``in_python`` tells which functions could not be
    compiled and were called in Python, how often and for how long.
    """

    log: Log
    events: tuple[Event, ...]
    status: Status
    hint: str
    statistics: Statistics
    diagram: Diagram
    ends: Ends
    in_python: tuple[InPython, ...] = ()

    def __repr__(self) -> str:
        told = [f"{self.status}, {self.log!r}, {len(self.events)} events, {self.statistics.steps} steps"]
        told += [self.hint] if self.hint else []
        told += [str(entry) for entry in self.in_python[:MOST_BLAMED]]
        return shortened(f"<Run of '{self.diagram.name}': {'; '.join(told)}>")

    def _repr_html_(self) -> str:
        from records.notebook import image, paragraph, table

        return paragraph(repr(self)) + image(self.plot()) + table(self.log)

    def to_pandas(self) -> Any:
        """Return the log as a pandas data frame; see ``Log.to_pandas``."""
        return self.log.to_pandas()

    def to_polars(self) -> "pl.DataFrame":
        """Return the log as a polars data frame; see ``Log.to_polars``."""
        return self.log.to_polars()

    @cached_property
    def final(self) -> Diagram:
        """The diagram with states, memories, held outputs and dead times as they stand at the end."""
        return _final(self.diagram, self.ends)

    @property
    def ok(self) -> bool:
        """Whether the run reached its end."""
        return self.status is Status.OK

    def plot(self, names: Sequence[str] | None = None) -> "Figure":
        """Plot the log with the events marked."""
        from plant.plots import plot_run

        return plot_run(self, names)


def simulate(
    diagram: Diagram,
    duration: float,
    *,
    every: float | None = None,
    times: ArrayLike | None = None,
    inputs: Mapping[str, Any] | None = None,
    params: Mapping[str, float] | None = None,
    start: Mapping[str, float] | None = None,
    rtol: float = 1e-6,
    atol: float = 1e-9,
    method: str = "auto",
    max_steps: int = 20_000_000,
    t0: float = 0.0,
    on_progress: Callable[[float], None] | None = None,
) -> Run:
    """Simulate ``duration`` seconds and log every signal.

    Parameters: ``every`` log interval [s] (default: 1000 intervals) or ``times`` [s]; ``inputs`` open input ->
    number, ``(t, values)`` or source block; ``params`` as in ``Diagram.with_params``; ``start`` as in
    ``Diagram.starting_at``; ``rtol``, ``atol`` local error per step; ``method`` "auto", "explicit" or "stiff";
    ``on_progress`` called every few thousand steps with the time reached; a ``KeyboardInterrupt``, its own or Ctrl-C's,
    ends the run with status INTERRUPTED, and what is simulated so far is kept.

    Raises ``ValueError`` for a request that makes no sense; numerical failure is a status, not an exception.

    >>> from blocks import Step, FirstOrder
    >>> from plant import simulate, wire
    >>> run = simulate(wire([Step("MV", 1.0), FirstOrder(K=2.0, tau=5.0)]), 50.0, every=10.0)
    >>> run.log["PV"].round(4).tolist()
    [0.0, 1.7293, 1.9634, 1.995, 1.9993, 1.9999]
    """
    ready = set_up(diagram, inputs, params, start)
    grid = log_times(duration, every, times, t0)
    settings = check_settings(Settings(rtol, atol, method, max_steps))
    past = ready._past if ready._past is not None and ready._past.ends_at(t0) else None
    records = max(DELAY_RECORDS, 2 * past.records if past else 0)
    before = counts(ready)
    while True:
        laid = plan(ready, records)
        outcomes = [_run(laid, c, ready, settings, grid, t0, t0 + duration, on_progress, past) for c in laid.components]
        if not any(o.status is Status.DELAY_FULL for o in outcomes):
            return _collect(ready, laid, outcomes, grid, spent(ready, before))
        records *= 4


def set_up(
    diagram: Diagram,
    inputs: Mapping[str, Any] | None = None,
    params: Mapping[str, float] | None = None,
    start: Mapping[str, float] | None = None,
) -> Diagram:
    """Return the diagram with its inputs closed and values changed; refuse inputs left open."""
    if inputs:
        diagram = close(diagram, inputs)
    if diagram.open_inputs:
        raise WiringError(
            f"the diagram's input '{diagram.open_inputs[0]}' is open; "
            f"give it a signal: simulate(..., inputs={{'{diagram.open_inputs[0]}': 0.0}})"
        )
    if params:
        diagram = diagram.with_params(params)
    if start:
        diagram = diagram.starting_at(start)
    return diagram


def log_times(duration: float, every: float | None, times: ArrayLike | None, t0: float) -> Floats:
    """Return the log times [s], refusing requests that make no sense."""
    if not (np.isfinite(duration) and duration > 0.0):
        raise ValueError(f"duration = {duration!r}, but it must be a positive number of seconds")
    if not np.isfinite(t0):
        raise ValueError(f"t0 = {t0!r}, but it must be a number of seconds")
    t_end = t0 + duration
    if times is not None:
        grid = np.asarray(times, dtype=float).ravel()
        rounding = 4.0 * np.spacing(max(abs(t0), abs(t_end)))
        inside = grid.size > 0 and np.all(np.isfinite(grid)) and np.all(np.diff(grid) > 0.0)
        if not (inside and grid[0] >= t0 - rounding and grid[-1] <= t_end + rounding):
            raise ValueError(
                f"times = {np.array2string(grid, threshold=6)} s, but they must be finite and increase strictly "
                f"within {t0} .. {t_end} s"
            )
        return np.asarray(np.clip(grid, t0, t_end))
    step = duration / 1000.0 if every is None else float(every)
    if not (np.isfinite(step) and 0.0 < step <= duration):
        raise ValueError(f"every = {every!r}, but the log interval must be positive and at most {duration} s")
    count = int(np.floor(duration / step + 1e-9)) + 1
    even: Floats = t0 + np.arange(count, dtype=np.float64) * step
    return np.minimum(even, t_end)


def check_settings(settings: Settings) -> Settings:
    """Refuse tolerances and methods that make no sense."""
    if settings.method not in METHODS:
        raise ValueError(f"method = {settings.method!r}; {nearest(settings.method, list(METHODS))}")
    if not (1e-13 <= settings.rtol <= 0.1 and settings.atol > 0.0):
        raise ValueError(
            f"rtol = {settings.rtol!r}, atol = {settings.atol!r}, but 1e-13 <= rtol <= 0.1 and atol > 0 are needed"
        )
    return settings


def _run(
    laid: Plan,
    component: Any,
    diagram: Diagram,
    settings: Settings,
    grid: Floats,
    t0: float,
    t_end: float,
    on_progress: Callable[[float], None] | None,
    past: Past | None,
) -> Outcome:
    I, W = prepare(component, settings, t0, -np.inf if past is None else past.t)
    laid.fill(component, W, diagram.blocks)
    if past is not None:
        past.put_back(component, I, W)
    return run(component, laid.flat, I, W, grid, t_end, on_progress)


def _collect(
    diagram: Diagram, laid: Plan, outcomes: Sequence[Outcome], grid: Floats, in_python: tuple[InPython, ...]
) -> Run:
    columns: dict[int, Floats] = {}
    for component, outcome in zip(laid.components, outcomes, strict=True):
        outcome.log.flags.writeable = False  # so that the log need not copy it
        columns.update(zip(component.columns, outcome.log, strict=True))
    log = Log(
        t=grid,
        signals={signal: columns[i] for i, signal in enumerate(diagram.signals)},
        units={s: u for s, u in diagram.signal_units.items() if u},
        spans=diagram.signal_spans,
        origin=f"simulated: {diagram.name}",
    )
    ends = tuple((component, o.I, o.W) for component, o in zip(laid.components, outcomes, strict=True))
    status, hint = _verdict(diagram, laid, outcomes, ends)
    return Run(
        log=log,
        events=named_events(diagram, (row for o in outcomes for row in o.events.tolist())),
        status=status,
        hint=hint,
        statistics=statistics([o.I for o in outcomes]),
        diagram=diagram,
        ends=ends,
        in_python=in_python,
    )


def _verdict(diagram: Diagram, laid: Plan, outcomes: Sequence[Outcome], ends: Ends) -> tuple[Status, str]:
    """Return the status of a run and its hint: where the first component that failed did so, and what to try."""
    failed = next(((c, o) for c, o in zip(laid.components, outcomes, strict=True) if o.status is not Status.OK), None)
    if failed is None:
        return Status.OK, HINTS[Status.OK]
    component, outcome = failed
    when = f"at t = {outcome.t:.6g} s"
    if told := troubles(diagram, ends):
        return Status.MODEL_ENDED, f"{told} ({when})"
    involved = component.blocks
    if outcome.status is Status.CHATTERING and len(outcome.events):
        involved = tuple(dict.fromkeys(outcome.events[-MOST_BLAMED:, 1].astype(int).tolist()))
    culprits = [diagram.blocks[b].name for b in involved if b < len(diagram.blocks)]
    more = f" and {len(culprits) - MOST_BLAMED} more" if len(culprits) > MOST_BLAMED else ""
    return outcome.status, f"{HINTS[outcome.status]} ({when} in {', '.join(culprits[:MOST_BLAMED])}{more})"


def named_events(diagram: Diagram, rows: Iterable[Sequence[float]]) -> tuple[Event, ...]:
    """Return changes of mode in order of time, with names for the numbers of ``rows``: t, block, before, after."""
    modes: dict[int, dict[float, str]] = {}
    events = []
    for t, number, before, after in rows:
        b = int(number)
        if b not in modes:
            modes[b] = {value: name for name, value in diagram.blocks[b].modes.items()}
        names = modes[b]
        events.append(Event(t, diagram.blocks[b].name, names.get(before, str(before)), names.get(after, str(after))))
    return tuple(sorted(events, key=lambda event: event.t))


def statistics(counters: Sequence[Any]) -> Statistics:
    """Add up what the components cost."""
    total = Statistics(components=len(counters))
    for I in counters:
        total = replace(
            total,
            steps=total.steps + int(I[at.STEPS]),
            rejected=total.rejected + int(I[at.REJECTED]),
            rhs=total.rhs + int(I[at.RHS]),
            jacobians=total.jacobians + int(I[at.JACOBIANS]),
            events=total.events + int(I[at.EVENTS]),
        )
    return total


def troubles(diagram: Diagram, ends: Ends) -> str:
    """Return what the blocks of a failed run say of where it ended, "" if none of them knows."""
    return "; ".join(filter(None, (block.trouble() for block in _final(diagram, ends).blocks)))


def _final(diagram: Diagram, ends: Ends) -> Diagram:
    blocks: list[Block] = list(diagram.blocks)
    first = {signal: i for i, signal in enumerate(diagram.signals)}
    for component, _, W in ends:
        for b in component.blocks:
            if b < len(blocks) and (len(blocks[b].x0) or len(blocks[b].d0)):
                x, d = component.states[b], component.memory[b]
                values = dict(zip(blocks[b].state_names, W[x : x + len(blocks[b].x0)], strict=True))
                values |= dict(zip(blocks[b].memory_names, W[d : d + len(blocks[b].d0)], strict=True))
                blocks[b] = blocks[b].starting_at(**{k: float(v) for k, v in values.items()})
            if b < len(blocks) and blocks[b].sampled:
                y = component.signals[first[blocks[b].output_labels[0]]]
                blocks[b] = blocks[b].holding(W[y : y + len(blocks[b].y0)])
    final = diagram._with_blocks(blocks)
    final._past = Past.of(ends)
    return final

"""Simulate a diagram with the compiled engine: a log at the times asked for, events, status, statistics."""

import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, Unpack

import control as ct
import numpy as np
from numpy.typing import ArrayLike, NDArray
from stickslip.blocks.arguments import by_name
from stickslip.blocks.block import Block
from stickslip.blocks.ports import shortened
from stickslip.diagram.branches import Branches, Taken, branching, taken
from stickslip.diagram.coarse import ToleranceWarning, too_coarse
from stickslip.diagram.diagram import Diagram
from stickslip.diagram.ends import at_end, troubles
from stickslip.diagram.flatten import DELAY_RECORDS, Ends, Plan
from stickslip.diagram.in_python import InPython, counts, spent
from stickslip.diagram.inputs import Inputs, close
from stickslip.diagram.kept import log_times, logging_only, wanted_signals
from stickslip.diagram.kinds import known_loops
from stickslip.diagram.past import Past, resumed
from stickslip.diagram.playback import check_logged
from stickslip.diagram.run_events import Event, in_order, named_events
from stickslip.diagram.settings import Changes, Settings, settings_of
from stickslip.diagram.strides import bounded
from stickslip.diagram.wiring import WiringError
from stickslip.engine.branching import Branching, Kept, run_branching
from stickslip.engine.cells import run_windows
from stickslip.engine.probing import Bound, bound_steps
from stickslip.engine.run import Outcome, prepare, run
from stickslip.engine.snapshot import Snapshot, total
from stickslip.engine.status import HINTS, Statistics, Status
from stickslip.logs import Log
from stickslip.logs.loop_signals import LoopsLater, within

if TYPE_CHECKING:
    import polars as pl
    from matplotlib.figure import Figure

Floats = NDArray[np.float64]
MOST_BLAMED = 6  # blocks that a hint names


@dataclass(frozen=True, repr=False)
class Run:
    """The result of a simulation: log, events in order of time, status with a hint, statistics, and the end state.

    If ``status`` is not OK the log holds the rows reached and NaN after them, and ``hint`` says what to try.
    ``raw_events`` (events, 4) are the changes of mode in order of time: t, block, value before, value after; ``events``
    names them.  ``notes`` are warnings about a run that is OK (``stickslip.diagram.coarse``,
    ``stickslip.diagram.strides``). ``final`` is the diagram at the end of the run: simulate it, changed or not, with
    ``t0`` = that time to go on (only blocks that run in Python begin anew).  ``ends`` are the engine's arrays there;
    they are lost in a pickle. ``taken`` lists where another mode replaced the run's own
    (``stickslip.diagram.branches``). ``in_python`` lists the functions that could not be compiled and were called in
    Python, how often and for how long.
    """

    log: Log
    raw_events: Floats
    status: Status
    hint: str
    statistics: Statistics
    diagram: Diagram
    ends: Ends
    notes: tuple[str, ...] = ()
    in_python: tuple[InPython, ...] = ()
    taken: tuple[Taken, ...] = ()

    def __getstate__(self) -> dict[str, Any]:
        """Keep the end as values: the engine's arrays hold addresses of compiled code, good in this process only."""
        return self.__dict__ | ({"final": self.final, "ends": ()} if self.ends else {})

    def __repr__(self) -> str:
        events = f"{len(self.raw_events)} event{'s' * (len(self.raw_events) != 1)}"
        parts = [f"{self.status}, {self.log!r}, {events}, {self.statistics.steps} steps"]
        parts += [self.hint] if self.hint else []
        parts += [str(entry) for entry in self.in_python[:MOST_BLAMED]]
        return shortened(f"<Run of '{self.diagram.name}': {'; '.join(parts)}>")

    def _repr_html_(self) -> str:
        from stickslip.logs.notebook import image, paragraph, table

        return paragraph(repr(self)) + image(self.plot()) + table(self.log)

    def to_pandas(self) -> Any:
        """Return the log as a pandas data frame; see ``Log.to_pandas``."""
        return self.log.to_pandas()

    def response(self) -> ct.TimeResponseData:
        """Return the log as python-control's response: signals (p, n) as outputs, with labels; no inputs or states.

        >>> from stickslip.plant.loops import self_regulating_loop
        >>> response = simulate(self_regulating_loop(), 10.0, every=5.0).response()
        >>> response.output_labels, response.outputs.shape
        (['SP', 'OP', 'MV', 'PV'], (4, 3))
        """
        names = list(self.log.names)
        return ct.TimeResponseData(
            self.log.t, np.array([self.log[name] for name in names]).reshape(len(names), -1),
            output_labels=names, issiso=False, sysname=self.diagram.name, title=f"Simulation of {self.diagram.name}",
            success=self.ok, message=None if self.ok else self.hint,
        )  # fmt: skip

    def to_polars(self) -> "pl.DataFrame":
        """Return the log as a polars data frame; see ``Log.to_polars``."""
        return self.log.to_polars()

    @cached_property
    def events(self) -> tuple[Event, ...]:
        """The changes of mode in order of time, with names."""
        return named_events(self.diagram, self.raw_events.tolist())

    @cached_property
    def final(self) -> Diagram:
        """The diagram with states, memories, held outputs and dead times as they stand at the end."""
        return at_end(self.diagram, self.ends)

    @property
    def ok(self) -> bool:
        """Whether the run reached its end."""
        return self.status is Status.OK

    def plot(self, names: Sequence[str] | None = None) -> "Figure":
        """Plot the log with the events marked."""
        from stickslip.diagram.figures.trends import plot_run

        return plot_run(self, names)


def simulate(
    diagram: Diagram,
    duration: float,
    *,
    every: float | None = None,
    times: ArrayLike | None = None,
    inputs: Inputs | None = None,
    params: Mapping[str, float] | None = None,
    start: Mapping[str, float] | None = None,
    signals: Sequence[str] | None = None,
    t0: float = 0.0,
    settings: Settings | None = None,
    on_progress: Callable[[float], None] | None = None,
    branches: Branches | None = None,
    **changes: Unpack[Changes],
) -> Run:
    """Simulate ``duration`` seconds and log every signal, or the ``signals`` named.

    Parameters: ``every`` log interval [s] (default: 1000 intervals) or ``times`` [s]; ``inputs`` open input ->
    number, ``(t, values)`` (lines, ends held), log, table (held; ``stickslip.diagram.playback``) or source block, or a
    log or table alone for all open inputs that it has; ``params`` as in ``Diagram.with_params``; ``start`` as in
    ``Diagram.starting_at``; ``settings`` how to integrate, or its fields by name: ``rtol``, ``atol`` local error per
    step, ``method`` "auto", "explicit" or "stiff", ``max_steps`` budget (20 000 000), ``max_step`` the largest step [s]
    (None: functions of the time are tried before the run, and what bounds the steps is noted; ``math.inf``: no bound);
    ``t0`` [s] when the run begins (blocks that sample take their first sample at their ``offset``, so before 0 they
    hold their start values); ``on_progress`` called every few thousand steps with the time reached; a
    ``KeyboardInterrupt``, its own or Ctrl-C's, ends the run with status INTERRUPTED, and what is simulated so far is
    kept; ``branches`` of a diagram pinned to a log: modes to try where it does not fit
    (``stickslip.diagram.branches``).

    A diagram that goes on from a run (``run.final``) needs ``t0`` = its end, if anything is under way in it.

    Raises ``ValueError`` for a request that makes no sense, a run beyond the log played back, or a log beyond the
    machine's memory; numerical failure is a status, not an exception.  Warns (``ToleranceWarning``) if ``atol`` is too
    large for some blocks.

    >>> from stickslip.blocks import Step, FirstOrder
    >>> from stickslip.diagram import simulate, wire
    >>> run = simulate(wire([Step("MV", 1.0), FirstOrder(K=2.0, tau=5.0)]), 50.0, every=10.0)
    >>> run.log["PV"].round(4).tolist()
    [0.0, 1.7293, 1.9634, 1.995, 1.9993, 1.9999]
    """
    ready = set_up(diagram, inputs, params, start)
    wanted = wanted_signals(ready, signals)
    grid = log_times(duration, every, times, t0, len(wanted))
    settings = settings_of(simulate, settings, changes)
    if on_progress is not None and not callable(on_progress):
        raise ValueError(f"on_progress = {on_progress!r}, but it is called with the time reached; give a function of t")
    t0, t_end = float(t0), float(t0) + float(duration)  # the engine is compiled for these and no other numbers
    check_logged(ready.blocks, t0, t_end)
    past = resumed(ready.past, ready.blocks, t0)
    records = max(DELAY_RECORDS, 2 * past.records if past else 0)
    before = counts(ready)
    in_cells = branches is None
    choice = None if branches is None else branching(ready, branches, t0, t_end)
    while True:
        laid = ready.plan_in_cells(records) if in_cells else ready.plan(records)
        if len(wanted) < len(ready.signals):
            laid = replace(laid, components=tuple(logging_only(c, ready, wanted) for c in laid.components))
        outcomes, kept, bounds = _run(laid, ready, settings, grid, t0, t_end, on_progress, past, choice)
        if any(o.status is Status.DELAY_FULL for o in outcomes):
            records *= 4
        elif any(o.status is Status.TIGHT for o in outcomes):
            in_cells = False
        else:
            run = _collect(ready, laid, outcomes, grid, wanted, spent(ready, before))
            if choice is not None and kept is not None:
                run = replace(run, taken=taken(ready, choice, kept))
            return _noted(run, settings.atol, bounds)


def _words_for(given: Any) -> str:
    return f"block '{given.name}'" if isinstance(given, Block) else f"{given!r:.60}"


def set_up(
    diagram: Diagram,
    inputs: Inputs | None = None,
    params: Mapping[str, float] | None = None,
    start: Mapping[str, float] | None = None,
) -> Diagram:
    """Return the diagram with its inputs closed and values changed; refuse inputs left open."""
    if not isinstance(diagram, Diagram):
        alone = "; wire([block]) makes one of a block, drive(block, ...) runs it alone" * isinstance(diagram, Block)
        raise ValueError(f"{_words_for(diagram)} is no diagram{alone or '; wire([...]) makes one of blocks'}")
    examples = {"params": {"valve.F_s": 1750.0}, "start": {"process.PV": 0.5}}
    for name, values in {"params": params, "start": start}.items():
        if values is not None:
            by_name("simulate", name, values, examples[name])
    if inputs is not None:
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


def _run(
    laid: Plan,
    diagram: Diagram,
    settings: Settings,
    grid: Floats,
    t0: float,
    t_end: float,
    on_progress: Callable[[float], None] | None,
    past: Past | None,
    choice: Branching | None,
) -> tuple[list[Outcome], Kept | None, list[Bound]]:
    """Return what came out of each component, one after the other or cells together, and which branches were kept.

    And the bounds on the steps that functions of the time need.
    """
    starts = []
    bounds: list[Bound] = []
    for component in laid.components:
        I, W = prepare(component, settings, t0, -np.inf if past is None else past.t)
        start = Snapshot(component, I, W)
        laid.fill(start, diagram.blocks)
        if past is not None:
            past.put_back(diagram.blocks, laid.delays, start)
        if settings.max_step is None and component.unforeseen:
            bounds += bound_steps(component, I, W, t_end)
        starts.append((I, W))
    if laid.links:
        return run_windows(laid.components, laid.links, starts, grid, t_end, on_progress), None, bounds
    outcomes: list[Outcome] = []
    kept = None
    for component, (I, W) in zip(laid.components, starts, strict=True):
        if choice is not None and choice.block in component.blocks:
            outcome, kept = run_branching(component, I, W, grid, t_end, choice, on_progress)
            outcomes.append(outcome)
        else:
            outcomes.append(run(component, laid.flat, I, W, grid, t_end, on_progress))
    return outcomes, kept, bounds


def _collect(
    diagram: Diagram, laid: Plan, outcomes: Sequence[Outcome], grid: Floats, wanted: Sequence[str],
    in_python: tuple[InPython, ...],
) -> Run:  # fmt: skip
    columns: dict[str, Floats] = {}
    kept = set(wanted)
    grid.flags.writeable = False
    for component, outcome in zip(laid.components, outcomes, strict=True):
        outcome.log.flags.writeable = False  # so that the log need not copy it
        columns.update(zip((diagram.signals[c] for c in component.columns), outcome.log, strict=True))
    log = Log(
        t=grid,
        signals={signal: columns[signal] for signal in diagram.signals if signal in kept},
        units={s: u for s, u in diagram.signal_units.items() if u and s in kept},
        spans={s: span for s, span in diagram.signal_spans.items() if s in kept},
        origin=f"simulated: {diagram.name}",
        loops=LoopsLater(lambda: within(known_loops(diagram), kept)),
    )
    ends = tuple(Snapshot(component, o.I, o.W) for component, o in zip(laid.components, outcomes, strict=True))
    status, hint = _verdict(diagram, laid, outcomes, ends)
    return Run(
        log=log,
        raw_events=in_order([o.events for o in outcomes]),
        status=status,
        hint=hint,
        statistics=total([end.counts for end in ends]),
        diagram=diagram,
        ends=ends,
        in_python=in_python,
    )


def _noted(run: Run, atol: float, bounds: Sequence[Bound]) -> Run:
    """Return the run with notes: what bounds its steps, and an absolute tolerance too large for some of its blocks.

    Warns of the latter.
    """
    if bounds:
        run = replace(run, notes=bounded(run.diagram.blocks, bounds))
    if not run.ok:
        return run
    blocks, states = run.diagram.blocks, {}
    for end in run.ends:
        for b in end.component.blocks:
            if b < len(blocks) and len(blocks[b].x0):
                values = (*blocks[b].x0.tolist(), *end.states(b, len(blocks[b].x0)).tolist())
                states[blocks[b].name] = max(map(abs, values))

    def size(signal: str) -> float:
        return float(max(run.log[signal].max(), -run.log[signal].min()))

    note = too_coarse(blocks, run.log.names, size, states, atol)
    if not note:
        return run
    warnings.warn(note, ToleranceWarning, stacklevel=3)
    return replace(run, notes=(*run.notes, note))


def _verdict(diagram: Diagram, laid: Plan, outcomes: Sequence[Outcome], ends: Ends) -> tuple[Status, str]:
    """Return the status of a run and its hint: where the first component that failed did so, and what to try."""
    failed = next(((c, o) for c, o in zip(laid.components, outcomes, strict=True) if o.status is not Status.OK), None)
    if failed is None:
        return Status.OK, HINTS[Status.OK]
    component, outcome = failed
    when = f"at t = {outcome.t:.6g} s"
    if parts := troubles(diagram, ends):
        return Status.MODEL_ENDED, f"{parts} ({when})"
    involved = component.blocks
    if outcome.status is Status.CHATTERING and len(outcome.events):
        involved = tuple(dict.fromkeys(outcome.events[-MOST_BLAMED:, 1].astype(int).tolist()))
    culprits = [diagram.blocks[b].name for b in involved if b < len(diagram.blocks)]
    more = f" and {len(culprits) - MOST_BLAMED} more" if len(culprits) > MOST_BLAMED else ""
    return outcome.status, f"{HINTS[outcome.status]} ({when} in {', '.join(culprits[:MOST_BLAMED])}{more})"

"""One diagram over thousands of parameter sets, start values and seeds, on all cores.

The diagram is laid out once; a variant is a copy of its arrays with one row of numbers written in.  The engine runs
without Python's lock, so plain threads keep all cores busy.  See also: ``variants`` (what varies), ``simulate``.
"""

import warnings
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import FIRST_EXCEPTION, ThreadPoolExecutor, wait
from contextlib import suppress
from dataclasses import dataclass, replace
from threading import Lock
from typing import Unpack
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import ArrayLike
from stickslip.blocks.block import Block
from stickslip.diagram.branches import Branches, Taken, branching, taken
from stickslip.diagram.coarse import ToleranceWarning, too_coarse
from stickslip.diagram.diagram import Diagram
from stickslip.diagram.ends import troubles
from stickslip.diagram.ensembles.per_run import apart, grids
from stickslip.diagram.ensembles.result import Ensemble, freeze
from stickslip.diagram.ensembles.variants import Floats, Places, Target, Variants, variants_of
from stickslip.diagram.flatten import DELAY_RECORDS, Plan
from stickslip.diagram.inputs import Inputs
from stickslip.diagram.kept import logging_only, wanted_signals
from stickslip.diagram.past import Past, resumed
from stickslip.diagram.playback import check_logged
from stickslip.diagram.progress import Progress, reporting
from stickslip.diagram.run_events import in_order
from stickslip.diagram.settings import Changes, Settings, settings_of
from stickslip.diagram.simulation import set_up
from stickslip.diagram.strides import bounded
from stickslip.engine.branching import Branching, run_branching
from stickslip.engine.probing import Bound, bound_steps
from stickslip.engine.run import Outcome, prepare, run
from stickslip.engine.snapshot import COUNTERS, Snapshot, total
from stickslip.engine.status import Status
from stickslip.engine.table import Component
from stickslip.logs.processes import cores

Summary = Callable[[Floats, dict[str, Floats]], Mapping[str, float]]
LAYOUTS, GLANCE_S = 8, 0.1  # layouts of a diagram kept for its next ensembles; how often the progress is reported


def ensemble(
    diagram: Diagram,
    duration: float,
    *,
    params: Mapping[str, ArrayLike] | None = None,
    start: Mapping[str, ArrayLike] | None = None,
    seeds: ArrayLike | None = None,
    t0: ArrayLike = 0.0,
    every: float | None = None,
    times: ArrayLike | None = None,
    signals: Sequence[str] | None = None,
    inputs: Inputs | None = None,
    blocks: Mapping[str, Sequence[Block]] | None = None,
    settings: Settings | None = None,
    branches: Branches | None = None,
    workers: int | None = None,
    progress: Progress = None,
    keep_logs: bool = True,
    summary: Summary | None = None,
    **changes: Unpack[Changes],
) -> Ensemble:
    """Simulate the diagram once per variant; variant ``i`` equals ``simulate`` of the same values to the last bit.

    Parameters: ``params`` ``{"valve.F_s": (variants,)}``; ``start`` ``{"process.x": (variants,)}``; ``seeds``
    (variants,) integers: blocks with random numbers draw the streams of [seed, number of the block]; a single
    number holds for all variants.  ``t0`` [s] when a run begins, (variants,) or one for all; ``times`` [s] of the log,
    (rows,) for all or (variants, rows).  ``inputs`` as in ``simulate``; a list, or an array of numbers, gives one input
    to each variant.  ``blocks`` ``{"PV pin": [...]}``: one block a variant in place of the diagram's, of the same kind.
    ``signals`` to log (default all); ``workers`` threads (default all cores);
    ``progress`` True for a bar, False for none, a function of (done, variants), default a bar on a terminal;
    ``keep_logs`` False keeps no values; ``summary`` function ``(t, {signal: (rows,)}) -> {name: number}``, called
    for each variant that reached its end.  ``settings`` and ``branches`` as in ``simulate``.

    A variant that fails has its ``status``; Ctrl-C returns what is finished, the rest ``INTERRUPTED``.
    Raises ``ValueError`` for a request that makes no sense, before anything runs.

    >>> from stickslip.blocks.sources import Ramp
    >>> from stickslip.diagram import wire
    >>> from stickslip.diagram.ensembles import ensemble
    >>> feed = wire([Ramp("F", slope=1.0)], outputs=["F"])
    >>> result = ensemble(feed, 2.0, params={"F.slope": [0.5, 1.0, 2.0]}, every=1.0)
    >>> result.values["F"].tolist()
    [[0.0, 0.5, 1.0], [0.0, 1.0, 2.0], [0.0, 2.0, 4.0]]
    """
    first, own = apart(diagram, inputs)
    ready = set_up(diagram, first)
    wanted = wanted_signals(ready, signals)
    settings = settings_of(ensemble, settings, changes)
    variants = variants_of(ready, params, start, seeds, t0, times, {**own, **(blocks or {})})
    grid = grids(variants.t0, duration, every, times, len(wanted), keep_logs)
    for i, begin in enumerate(variants.t0.tolist()):
        check_logged(variants.blocks_of(i), begin, begin + float(duration))
    if not keep_logs and summary is None:
        raise ValueError("keep_logs=False without a summary leaves nothing; give summary=, or keep the logs")
    if workers is not None and not (isinstance(workers, int | np.integer) and workers >= 1):
        raise ValueError(
            f"workers = {workers!r}, but threads are a whole number of at least 1; leave it out to use all cores"
        )
    if summary is not None and not callable(summary):
        raise ValueError(f"summary = {summary!r}, but it is called for each variant; give a function (t, signals)")
    runs = _Runs(variants, wanted, grid, float(duration), settings, branches, keep_logs, summary)
    _work(runs, len(variants), workers or cores(), progress)
    return runs.result()


@dataclass(frozen=True)
class _Part:
    """One component that logs only the wanted signals, and where a variant's numbers go."""

    component: Component
    signals: tuple[str, ...]
    offsets: Places
    columns: Places


@dataclass(frozen=True)
class _Layout:
    laid: Plan
    parts: tuple[_Part, ...]


_Key = tuple[tuple[Target, ...], frozenset[int], tuple[str, ...], int, tuple[bool, ...]]
_kept: "WeakKeyDictionary[Diagram, dict[_Key, _Layout]]" = WeakKeyDictionary()


def _lay_out(variants: Variants, i: int, wanted: tuple[str, ...], records: int, shape: tuple[bool, ...]) -> _Layout:
    """Return the layout for variant ``i`` and all others with the same dead times in force: ``shape``.

    What differs between variants is written in for each run, so ensembles of one diagram in which the same values and
    blocks differ share it.
    """
    layouts = _kept.setdefault(variants.diagram, {})
    key = variants.targets, frozenset(variants.blocks), wanted, records, shape
    if key not in layouts:
        if len(layouts) >= LAYOUTS:
            layouts.clear()
        layouts[key] = _made(variants, i, wanted, records)
    return layouts[key]


def _made(variants: Variants, i: int, wanted: Sequence[str], records: int) -> _Layout:
    variants.diagram.plan()  # the copies below share it where it fits
    diagram = variants.diagram_of(i)
    laid = diagram.plan(records)
    parts = []
    for component in laid.components:
        reduced = logging_only(component, diagram, wanted)
        laid.fill(Snapshot(reduced, reduced.I, reduced.W), diagram.blocks)
        parts.append(
            _Part(reduced, tuple(diagram.signals[c] for c in reduced.columns), *variants.places(laid, component))
        )
    return _Layout(laid, tuple(parts))


def _pasts(variants: Variants) -> list[Past | None]:
    """Return with what each variant goes on: with all that the diagram's past holds, or afresh.

    Raises ``ValueError`` where something under way would be lost.
    """
    if variants.diagram.past is None:
        return [None] * len(variants)
    each = (variants.diagram_of(i) for i in range(len(variants)))
    return [resumed(one.past, one.blocks, float(t0)) for one, t0 in zip(each, variants.t0, strict=True)]


class _Runs:
    """The result in the making: threads call ``work``, which takes variant after variant until none is left."""

    def __init__(
        self, variants: Variants, wanted: tuple[str, ...], grid: Floats, duration: float, settings: Settings,
        branches: Branches | None, keep_logs: bool, summary: Summary | None,
    ) -> None:  # fmt: skip
        n = len(variants)
        self.branches = branches
        self.taken: list[tuple[Taken, ...]] = [()] * n
        self.variants, self.wanted, self.grid, self.duration, self.settings = variants, wanted, grid, duration, settings
        self._choice(0)  # what makes no sense is refused before anything runs
        self.summary = summary
        self.values = {signal: np.empty((n, grid.shape[-1])) for signal in wanted} if keep_logs else {}
        self.keep_logs = keep_logs
        self.status = np.full(n, Status.INTERRUPTED, dtype=np.int8)
        self.ended = np.zeros(n)
        self.counts = np.zeros((n, len(COUNTERS)), dtype=np.int64)
        self.events: list[Floats] = [np.empty((0, 4))] * n
        self.summaries: list[Mapping[str, float]] = [{}] * n
        self.troubles = [""] * n
        self.bounds: list[Bound] = []
        shapes, self.shape_of = np.unique(variants.shapes(), axis=0, return_inverse=True)
        self.shape_of = self.shape_of.ravel()
        self.pasts = _pasts(variants)
        records = max([DELAY_RECORDS, *(2 * past.records for past in self.pasts if past is not None)])
        self.layouts = [
            _lay_out(variants, self._first(s), wanted, records, tuple(shape)) for s, shape in enumerate(shapes.tolist())
        ]
        self.lock = Lock()
        self.waiting = iter(range(n))
        self.done = 0
        self.stop = False

    def _first(self, shape: int) -> int:
        return int(np.argmax(self.shape_of == shape))

    def work(self) -> None:
        """Simulate variants until none is left or somebody stops the work."""
        for i in self.waiting:
            if self.stop:
                return
            try:
                self._variant(i)
            except Exception as error:  # a block that runs in Python, or the summary, has a fault of its own
                error.add_note(f"variant {i} of the ensemble")
                raise
            with self.lock:
                self.done += 1

    def _variant(self, i: int) -> None:
        layout = self.layouts[self.shape_of[i]]
        outcomes = self._run(layout, i)
        while any(o.status is Status.DELAY_FULL for o in outcomes):
            layout = self._longer(layout, int(self.shape_of[i]))
            outcomes = self._run(layout, i)
        rows = {s: row for part, o in zip(layout.parts, outcomes, strict=True)
                for s, row in zip(part.signals, o.log, strict=True)}  # fmt: skip
        for signal, values in self.values.items():
            values[i] = rows[signal]
        failed = next((o for o in outcomes if o.status is not Status.OK), None)
        if self.summary is not None and failed is None:
            self.summaries[i] = self.summary(self.times(i), {signal: rows[signal] for signal in self.wanted})
        if self.keep_logs:
            self.events[i] = in_order([o.events for o in outcomes])
        ends = tuple(Snapshot(part.component, o.I, o.W) for part, o in zip(layout.parts, outcomes, strict=True))
        self.counts[i] = sum(end.counts for end in ends)
        self.ended[i] = min(o.t for o in outcomes)
        self.status[i] = Status.OK if failed is None else failed.status
        if failed is not None:
            self.troubles[i] = troubles(self.variants.diagram_of(i), ends)
            if self.troubles[i]:
                self.status[i] = Status.MODEL_ENDED

    def _run(self, layout: _Layout, i: int) -> list[Outcome]:
        outcomes = []
        t0, past, choice = float(self.variants.t0[i]), self.pasts[i], self._choice(i)
        t_end = t0 + self.duration
        for part in layout.parts:
            I, W = prepare(part.component, self.settings, t0, -np.inf if past is None else past.t)
            begun = Snapshot(part.component, I, W)
            begun.put(part.offsets, self.variants.table[i, part.columns])
            self.variants.point_to_tables(begun, i)
            if past is not None:
                past.put_back(self.variants.diagram.blocks, layout.laid.delays, begun)
            if self.settings.max_step is None and part.component.unforeseen:
                self.bounds += bound_steps(part.component, I, W, t_end)
            if choice is not None and choice.block in part.component.blocks:
                outcome, kept = run_branching(part.component, I, W, self.times(i), t_end, choice, self._listen)
                outcomes.append(outcome)
                self.taken[i] = taken(self.variants.diagram, choice, kept)
            else:
                outcomes.append(run(part.component, layout.laid.flat, I, W, self.times(i), t_end, self._listen))
        return outcomes

    def _choice(self, i: int) -> Branching | None:
        """Return the branches of variant ``i``, which has pins of its own, None if none are asked for."""
        if self.branches is None:
            return None
        begin = float(self.variants.t0[i])
        return branching(self.variants.diagram_of(i), self.branches, begin, begin + self.duration)

    def times(self, i: int) -> Floats:
        """Return the log times of variant ``i`` [s], (rows,)."""
        return self.grid if self.grid.ndim == 1 else self.grid[i]

    def _doubt(self) -> None:
        """Warn if the absolute tolerance is too large for some of the blocks."""
        whole = self.status == Status.OK
        if not (self.keep_logs and whole.any()):
            return

        def size(signal: str) -> float:
            kept = self.values[signal][whole]
            return float(max(kept.max(), -kept.min()))

        read = [b for b in self.variants.diagram.blocks if not self.values.keys().isdisjoint(b.output_labels)]
        note = too_coarse(read, self.values.keys(), size, {}, self.settings.atol)
        if note:
            warnings.warn(note, ToleranceWarning, stacklevel=3)

    def _listen(self, t: float) -> None:
        """Interrupt a variant on its way if somebody stopped the work."""
        if self.stop:
            raise KeyboardInterrupt

    def _longer(self, full: _Layout, shape: int) -> _Layout:
        """Return a layout with longer delay lines than the one that was full, for this and all later variants."""
        with self.lock:
            if self.layouts[shape] is full:
                self.layouts[shape] = _made(self.variants, self._first(shape), self.wanted, full.laid.records * 4)
            return self.layouts[shape]

    def result(self) -> Ensemble:
        """Return what is finished; variants that were not reached hold NaN."""
        missing = self.status == Status.INTERRUPTED
        for values in self.values.values():
            values[missing] = np.nan
        names = dict.fromkeys(name for one in self.summaries for name in one)
        table = {name: np.array([float(one.get(name, np.nan)) for one in self.summaries]) for name in names}
        freeze([self.grid, self.status, self.ended, *self.values.values(), *table.values()])
        self._doubt()
        cost = replace(total(list(self.counts)), components=len(self.layouts[0].parts))
        return Ensemble(
            t=self.grid, values=self.values, status=self.status, ended=self.ended, summary=table,
            event_counts=self.counts[:, -1], troubles=tuple(self.troubles), statistics=cost,
            variants=self.variants, settings=self.settings, duration=self.duration, raw_events=tuple(self.events),
            branches=self.branches, taken=tuple(self.taken),
            notes=bounded(self.variants.diagram.blocks, self.bounds),
        )  # fmt: skip


def _work(runs: _Runs, n: int, workers: int, progress: Progress) -> None:
    """Let the runs work while this thread tells the progress and hears Ctrl-C; what one does alone needs no other."""
    if min(workers, n) == 1 and progress is False:
        with suppress(KeyboardInterrupt):
            runs.work()
        return
    with reporting(progress, n, "variants") as tell, ThreadPoolExecutor(min(workers, n)) as pool:
        tasks = [pool.submit(runs.work) for _ in range(min(workers, n))]
        try:
            running = True
            while running:
                finished, waiting = wait(tasks, timeout=GLANCE_S, return_when=FIRST_EXCEPTION)
                tell(runs.done, n)
                running = bool(waiting) and not any(task.exception() for task in finished)
        except KeyboardInterrupt:
            pass
        finally:
            runs.stop = True
    for task in tasks:
        task.result()

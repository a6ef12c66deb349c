"""The study: every point of a design simulated, measured and kept, in parallel, and resumed where it stopped."""

import math
import platform
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import nullcontext
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Unpack

import numpy as np
from stickslip.blocks.ports import nearest
from stickslip.diagram.diagram import Diagram
from stickslip.diagram.ensembles.running import ensemble
from stickslip.diagram.kept import log_times
from stickslip.diagram.progress import Progress, reporting
from stickslip.diagram.settings import Changes, Settings, settings_of
from stickslip.engine.status import Status
from stickslip.logs.files.resumable import RowsFolder, joined, opened
from stickslip.logs.processes import cores
from stickslip.study.axes import StudyError, axes_of
from stickslip.study.cluster import made_on_cluster, parts_of
from stickslip.study.design import design
from stickslip.study.folder import KEPT, Memory, Store
from stickslip.study.measures import Measures, OwnMeasures, slips, valves
from stickslip.study.points import Batch, Points, Refusal, resolve
from stickslip.study.request import code, fingerprint, spelt
from stickslip.study.result import StudyResult
from stickslip.study.stop import stop_asked
from stickslip.study.subject import Subject, as_subject
from stickslip.study.table import Schema, rows_of

if TYPE_CHECKING:
    import polars as pl

FIRST_PART, LARGEST_PART = 4, 4000  # runs; the first a worker
PART_SECONDS = 2.0  # of work between two parts: what an interruption can cost
PART_BYTES = 50e6  # of logs held at once
MOST_ROWS = 1_000_000  # of one run's log
FEWEST_ROWS = 3  # from measure_from on
LONGEST = 24.0 * 3600.0  # s
IMPOSSIBLE = ("REFUSED", "INFEASIBLE")


def study(
    subject: Subject | Diagram,
    vary: Mapping[str, object] | None = None,
    *,
    plant: Mapping[str, object] | None = None,
    start: Mapping[str, object] | None = None,
    random: int | None = None,
    kicks: int | None = None,
    kick_size: float = 0.03,
    seed: int = 2009,
    duration: float,
    every: float,
    measure_from: float | None = None,
    signals: Sequence[str] | None = None,
    measures: OwnMeasures | None = None,
    settings: Settings | None = None,
    workers: int | None = None,
    progress: Progress = None,
    out: str | Path | None = None,
    fresh: bool = False,
    longest: float = LONGEST,
    cluster: str | None = None,
    **changes: Unpack[Changes],
) -> StudyResult:
    """Simulate a diagram over a grid or a random sample of parameters, from many starts, and measure every run.

    Parameters: ``vary`` parameters of the built diagram, ``{"PCS11.K_p": [5e-7, 8.8e-7]}``; ``plant`` quantities of
    the subject, which is then built at its new rest; ``start`` start values of states; each a list (lists form a
    grid) or a law such as ``uniform(1250, 2250)`` (laws share ``random`` points of a Latin hypercube).  ``kicks`` None
    starts as the subject does, 0 at rest, N makes N runs of every point, its kicked states times independent factors
    1 -+ ``kick_size``.  ``seed`` fixes hypercube and kicks.  ``duration``, ``every`` [s] of the run and its log;
    ``measure_from`` [s] (default: half of it); ``signals`` to measure; ``measures`` of your own in
    place of the usual ones.  ``settings`` how to integrate (default: as the subject says), or its fields by name, as in
    ``simulate``.  ``workers`` threads; ``progress`` True, False, a function of (done, runs), default a bar
    on a terminal.  ``out`` a folder for the rows: a call with the same request goes on where the last stopped, and
    gives the same bytes; ``fresh`` throws away what is there.  ``longest`` [s] the most the study may take.
    ``cluster`` address of a Dask scheduler ("tcp://10.0.0.5:8786"): the runs are made there, on ``workers`` threads
    each (default 1), and give the same rows; a worker that is lost costs its work only.

    A run that cannot be made is a row with a status and a reason.  Ctrl-C returns what is finished.
    Raises ``StudyError`` for a request that makes no sense.

    >>> from stickslip.plant.loops import integrating_loop
    >>> from stickslip.study import study
    >>> found = study(integrating_loop(), {"valve.F_s": [1750.0, 2250.0]}, start={"process.PV": 0.3},
    ...               duration=3000.0, every=1.0)
    >>> found.table["PV.amplitude"].round(3).to_list()  # analytic: about S/(2 K_p) = 0.143, 0.167
    [0.143, 0.167]
    """
    chosen = as_subject(subject)
    how = settings_of(study, settings or chosen.settings, changes)
    axes = [*axes_of("vary", vary), *axes_of("plant", plant), *axes_of("start", start)]
    _check(kick_size, longest, random=random, kicks=kicks, seed=seed, workers=workers)
    grid, since = _times(duration, every, measure_from)
    plain = chosen.build({})
    first = _first(Points(chosen, design(axes, random, seed, kicks), kicks, kick_size, seed), plain)
    axes = resolve(axes, chosen, first)
    plan = design(axes, random, seed, kicks)
    points = Points(chosen, plan, kicks, kick_size, seed)
    if kicks and not chosen.kicked:
        raise StudyError(f"'{chosen.name}' has no states that a kick could move; give start= values (--start) instead")
    wanted = _signals(chosen, first, signals)
    request: dict[str, Any] = {
        "subject": chosen.name, "fingerprint": fingerprint(plain), "code": code(), **spelt(axes), "random": random,
        "kicks": kicks, "kick_size": kick_size, "seed": seed, "duration": float(duration), "every": float(every),
        "measure_from": since, "signals": list(wanted), "rtol": how.rtol, "atol": how.atol, "method": how.method,
    }  # fmt: skip
    if measures is not None:
        request["measures"] = list(measures.names)
    schema = Schema.of(plan, [first, *_other_shapes(points)], wanted, None if measures is None else measures.names)
    options = {"duration": duration, "every": every, "settings": how}
    begun = time.perf_counter()
    held = nullcontext(Memory()) if out is None else opened(Path(out), request, KEPT, fresh)
    with held as store, reporting(progress, len(plan), "runs") as tell, stop_asked() as stopped:
        if isinstance(store, RowsFolder):
            store.note(status="running", runs=len(plan))
        work = _Work(points, schema, since, options, len(grid), workers or cores(), tell, longest, measures)
        complete = (
            work.all(store, stopped) if cluster is None else work.elsewhere(store, stopped, cluster, workers or 1)
        )
        tables = store.rows()
        table = joined(tables, "run") if tables else schema.empty()
        if complete and len(table) and table["status"].is_in(IMPOSSIBLE).all():
            if isinstance(store, RowsFolder):
                store.forget()
            raise StudyError(f"none of the {len(table)} runs is possible; the first: {table['reason'][0]}")
        seconds = time.perf_counter() - begun
        result = StudyResult(table, request, tuple(axes), wanted, chosen.stages, schema.units, complete, seconds)
        if isinstance(store, RowsFolder) and complete:
            store.finish(table)
        if isinstance(store, RowsFolder):
            store.note(
                status="complete" if complete else "interrupted",
                runs=len(plan),
                **result.counts(),
                versions=_versions(),
            )
    return result


class _Work:
    """Makes runs part after part, each some seconds of work, and stores their rows."""

    def __init__(
        self, points: Points, schema: Schema, since: float, options: Mapping[str, Any], rows: int, workers: int,
        tell: Callable[[int, int], None], longest: float, own: OwnMeasures | None = None,
    ) -> None:  # fmt: skip
        self.own, self.rows = own, rows
        self.points, self.schema, self.since, self.options = points, schema, since, options
        self.workers, self.tell, self.longest = workers, tell, longest
        self.most = int(min(LARGEST_PART, max(1.0, PART_BYTES / (8.0 * rows * len(schema.signals)))))
        self.measures: dict[object, Measures] = {}

    def missing(self, store: Store) -> list[int]:
        """Return the runs of which there is no row yet."""
        there = np.zeros(len(self.points.design), dtype=bool)
        for table in store.rows():
            there[table["run"].to_numpy()] = True
        return [int(run) for run in np.flatnonzero(~there)]

    def elsewhere(self, store: Store, stopped: Callable[[], bool], address: str, threads: int) -> bool:
        """Make what is not there yet on a cluster, until ``stopped``; return whether all is there."""
        points, runs, missing = self.points, len(self.points.design), self.missing(store)
        make = partial(
            _remade, (points.subject, points.design, points.kicks, points.size, points.seed), self.schema, self.since,
            self.options, self.rows, threads, self.own,
        )  # fmt: skip
        done = runs - len(missing)
        self.tell(done, runs)
        try:
            for table in made_on_cluster(make, parts_of(missing, self.most), address) if missing else ():
                store.add(table)
                done += len(table)
                self.tell(done, runs)
                if stopped() and done < runs:
                    return False
        except KeyboardInterrupt:
            return False
        return True

    def all(self, store: Store, stopped: Callable[[], bool]) -> bool:
        """Make what is not there yet, until ``stopped``; return whether all is there."""
        runs, missing = len(self.points.design), self.missing(store)
        done, size, parts = runs - len(missing), FIRST_PART * self.workers, 0
        while missing:
            part, missing = missing[: min(size, self.most)], missing[min(size, self.most) :]
            begun = time.perf_counter()
            try:
                table = self.part(part, done)
            except KeyboardInterrupt:
                return False
            if len(table):
                store.add(table)
            done += len(table)
            self.tell(done, runs)
            if len(table) < len(part) or (stopped() and missing):
                return False
            pace = (time.perf_counter() - begun) / len(part)
            parts += 1
            if parts > 1 and pace * len(missing) > self.longest:  # the first part may hold a compilation
                raise StudyError(
                    f"{len(missing):,} runs of {1e3 * pace:.3g} ms on {self.workers} threads would take about "
                    f"{_long(pace * len(missing))}, more than the {_long(self.longest)} allowed; take fewer values or "
                    "a shorter duration, or raise longest (--longest)"
                )
            size = max(FIRST_PART * self.workers, int(PART_SECONDS / max(pace, 1e-6)))
        return True

    def part(self, runs: Sequence[int], done: int) -> "pl.DataFrame":
        """Return the rows of these runs, of the finished ones if interrupted."""
        batches, refused = self.points.split(runs)
        rows = {run: self.schema.refusal(run, refusal) for run, refusal in refused.items()}
        for batch in batches:
            found = self._simulated(batch, self._counting(done + len(rows)))
            rows |= found
            if len(found) < len(batch.runs):
                break
        return rows_of(self.schema, [rows[run] for run in sorted(rows)])

    def _counting(self, known: int) -> Callable[[int, int], None]:
        return lambda done, _: self.tell(known + done, len(self.points.design))

    def _simulated(self, batch: Batch, tell: Callable[[int, int], None]) -> dict[int, list[Any]]:
        key = (id(batch.reference), batch.limits)
        if self.own is None and key not in self.measures:
            self.measures[key] = Measures(batch.reference, self.schema.signals, self.since, dict(batch.limits))
        result = ensemble(
            batch.reference, signals=self.schema.signals, params=batch.params or None, start=batch.start or None,
            seeds=batch.seeds, workers=self.workers, progress=tell, keep_logs=self.own is None,
            summary=self.measures[key] if self.own is None else self.own.function, **self.options,
        )  # fmt: skip
        sticky = valves(batch.reference)
        rows = {}
        for i, run in enumerate(batch.runs):
            status = Status(int(result.status[i]))
            if status is Status.INTERRUPTED:
                continue
            numbers = {name: float(column[i]) for name, column in result.summary.items()}
            if status is Status.OK and self.own is None:
                numbers |= {f"{valve}.slips": n for valve, n in slips(result.raw_events[i], sticky, self.since).items()}
            rows[run] = self.schema.row(run, status.name, result.hint(i), float(result.ended[i]), numbers)
        return rows


def _remade(
    points: tuple[Any, ...], schema: Schema, since: float, options: Mapping[str, Any], rows: int, threads: int,
    own: OwnMeasures | None,
) -> _Work:  # fmt: skip
    """Return the work of a study on another machine: what is cached stays behind."""
    return _Work(Points(*points), schema, since, options, rows, threads, lambda done, runs: None, LONGEST, own)


def _check(kick_size: float, longest: float, *, seed: int, workers: int | None, **counts: int | None) -> None:
    if not 0.0 < kick_size < 1.0:
        raise StudyError(f"kick_size = {kick_size!r}, but it is a share of the start value, 0 < kick_size < 1")
    if not longest > 0.0:
        raise StudyError(f"longest = {longest!r}, but a study takes some time; give seconds above 0")
    for name, count in {**counts, "seed": seed, "workers": workers}.items():
        if not isinstance(count, int | np.integer) and (count is not None or name == "seed"):
            raise StudyError(f"{name} = {count!r}, but it is a whole number; give one")
    if seed < 0:
        raise StudyError(f"seed = {seed}, but a seed is a whole number of 0 or more")
    if workers is not None and workers < 1:
        raise StudyError(f"workers = {workers}, but at least one thread is needed; leave it out to use all cores")


def _times(duration: float, every: float, measure_from: float | None) -> tuple[Any, float]:
    """Return the log times and from when on a run is measured [s]."""
    if math.isfinite(duration) and every > 0.0 and duration / every > MOST_ROWS:
        raise StudyError(
            f"{duration:g} s logged every {every:g} s are {duration / every:.3g} rows a run, but a study measures at "
            f"most {MOST_ROWS:,}; give a longer every (--every)"
        )
    grid = log_times(duration, every, None, 0.0)
    since = 0.5 * duration if measure_from is None else float(measure_from)
    if not 0.0 <= since < float(grid[-1]):
        raise StudyError(f"measure_from = {since:g} s, but it must lie within the run, 0 <= from < {grid[-1]:g} s")
    rows = int((grid >= since - 1e-9 * max(1.0, since)).sum())
    if rows < FEWEST_ROWS:
        raise StudyError(
            f"measure_from = {since:g} s leaves {rows} rows of the log, but an amplitude needs at least {FEWEST_ROWS}; "
            "measure from earlier on (--from), or log more often (--every)"
        )
    return grid, since


def _first(points: Points, plain: Diagram) -> Diagram:
    """Return the diagram of the first point that can be built: the names of parameters are looked up there."""
    for point in range(min(points.design.points, 50)):
        values = zip(points.design.axes, points.design.at(point), strict=True)
        known = tuple((a.name, v) for a, v in values if a.kind == "plant")
        if any(name not in points.subject.quantities for name, _ in known):
            break
        built = points.built(known)
        if not isinstance(built, Refusal):
            return built[0]
    return plain


def _other_shapes(points: Points) -> list[Diagram]:
    """Return the diagrams that words build, one for each: they may have other valves."""
    axes = [axis for axis in points.design.axes if axis.kind == "plant"]
    found = []
    for axis in axes:
        for word in (value for value in axis.values if isinstance(value, str)):
            others = {other.name: other.values[0] for other in axes if other.values}
            built = points.built(tuple({**others, axis.name: word}.items()))
            if not isinstance(built, Refusal):
                found.append(built[0])
    return found


def _signals(subject: Subject, diagram: Diagram, given: Sequence[str] | None) -> tuple[str, ...]:
    listed = (given,) if isinstance(given, str) else given
    chosen = tuple(dict.fromkeys(listed if listed is not None else subject.signals or diagram.signals))
    for signal in chosen:
        if signal not in diagram.signals:
            raise StudyError(f"'{subject.name}' has no signal '{signal}'; {nearest(signal, list(diagram.signals))}")
    if not chosen:
        raise StudyError("there is no signal to measure; name one")
    return chosen


def _versions() -> dict[str, str]:
    from importlib.metadata import version

    return {
        "python": platform.python_version(),
        **{name: version(name) for name in ("numpy", "numba", "polars", "scipy")},
    }


def _long(seconds: float) -> str:
    return f"{seconds / 3600.0:.3g} h" if seconds >= 3600.0 else f"{seconds:.3g} s"

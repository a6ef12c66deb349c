"""A diagram as a diagnosis uses it: its noise and loads are separate, and its set points come from the log.

Nuisances are blocks that draw random numbers (``sd`` > 0): sensor noise, loads that nobody measures.  For a replay they
are silenced, for runs without a gap they draw.
"""

import copy
import math
from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from stickslip.blocks.block import Block
from stickslip.blocks.compiled_step import compiled_step
from stickslip.blocks.noise import Noise, Seeded, seeded
from stickslip.blocks.role import Role
from stickslip.blocks.sampled_function import SampledFunction
from stickslip.blocks.sources import Constant
from stickslip.diagram.diagram import Diagram
from stickslip.engine.call import address, in_python
from stickslip.gap.insertion.paths import noise_of
from stickslip.gap.insertion.scales import ends
from stickslip.gap.records.record import FEWEST, GapError, Record
from stickslip.gap.records.regular import with_inputs_held, with_rows_filled
from stickslip.logs import Log

SHARE, PERCENT = 1.5, 100.0  # an output beyond the former is in percent
LONGEST = 1000.0  # times of rows x interval; a model is replayed through every gap of a log
RANDOM = frozenset(seeded(0))  # memories of random numbers
ELSEWHERE = 1.0  # times its range, by which an output beyond its limits is in another unit
SIZES = ("sd", "correlation_time")  # parameters of a block that draws random numbers
# factors within which stated loads and their times are believed, and by which white noise may be less or more than
# stated: twice as much or half is a note, more is a noisier sensor
LOAD, TIME, LESS, MORE = 4.0, 5.0, 2.2, 2.05
# of its step, from which on the noise of a sensor makes noise of its rounding: the mean errs by 1.4 % of a step at most
DITHER = 0.4


@dataclass(frozen=True)
class Nuisance:
    """One source of random numbers: its block, standard deviation ``sd`` and correlation time [s] (0: white).

    ``rounding`` is the standard deviation of what a sensor rounds off behind it, where that is noise as well.
    """

    block: str
    sd: float
    correlation_time: float
    rounding: float = 0.0

    def __str__(self) -> str:
        colour = f", correlation time {self.correlation_time:g} s" if self.correlation_time else ", white"
        return f"{self.block} (standard deviation {self.sd:g}{colour})"


def smooth_memories(block: Block) -> tuple[str, ...]:
    """Return the memories of a block that may have any value near theirs: no mode, no count, no random number.

    >>> from stickslip.blocks import Lookup1D, SampledFilter
    >>> smooth_memories(SampledFilter("y", "u", 2.0, dt=1.0))
    ('y',)
    >>> smooth_memories(Lookup1D("y", "u", [0.0, 1.0], [0.0, 2.0]))
    ()
    """
    return tuple(name for name in block.memory_names if name not in RANDOM and name not in block.discrete)


def nuisances(diagram: Diagram) -> tuple[Nuisance, ...]:
    """Return the sources of random numbers in a diagram.

    >>> from stickslip.blocks import Noise
    >>> from stickslip.diagram import wire
    >>> print(*nuisances(wire([Noise("D", sd=0.1, dt=1.0, correlation_time=60.0)], outputs=["D"])))
    D (standard deviation 0.1, correlation time 60 s)
    """
    found = []
    for block in diagram.blocks:
        values = dict(zip(block.param_names, block.p, strict=False))
        if isinstance(block, Seeded) and values.get("sd", 0.0) > 0.0:
            sd, T = float(values["sd"]), float(values.get("correlation_time", 0.0))
            step = float(values.get("step", 0.0)) if T == 0.0 and block.role is Role.SENSOR else 0.0
            found.append(Nuisance(block.name, sd, T, step / math.sqrt(12.0) if step <= sd / DITHER else 0.0))
    return tuple(found)


def smoothed(diagram: Diagram) -> Diagram:
    """Return the silenced diagram as a filter follows it: sensors whose rounding is noise do not round the mean."""
    smooth = {f"{one.block}.step": 0.0 for one in nuisances(diagram) if one.rounding > 0.0}
    return silenced(diagram.with_params(smooth) if smooth else diagram)


def silenced(diagram: Diagram) -> Diagram:
    """Return the diagram without the random numbers of its nuisances, and without blocks that only look on.

    A noise that is a block of its own becomes its mean, which costs a replay nothing.
    """
    quiet = {}
    for nuisance in nuisances(diagram):
        block = diagram[nuisance.block]
        if isinstance(block, Noise):
            mean = Constant(str(block.output_labels[0]), block.params["mean"], name=block.name).with_role(block.role)
            diagram = diagram.replace(block.name, mean)
        else:
            quiet[f"{nuisance.block}.sd"] = 0.0
    watching = [block.name for block in diagram.blocks if block.role is Role.HISTORIAN]
    if watching:
        diagram = diagram.without(*watching)
    return diagram.with_params(quiet) if quiet else diagram


def known_within(diagram: Diagram) -> dict[str, tuple[float, float]]:
    """Return the parameters of a diagram that are known within a tolerance only: block.parameter -> (low, high).

    Those of noise and loads are not among them (``stated_about``).

    >>> from stickslip.cases.models import ideal_flow
    >>> known_within(ideal_flow().with_tolerances({"process.K": 0.5}))
    {'process.K': (1.5, 4.5)}
    """
    found = {}
    for key, share in diagram.tolerances.items():
        block, _, name = key.rpartition(".")
        if not (isinstance(diagram[block], Seeded) and name in SIZES):
            value = float(diagram.params[key])
            found[key] = (value - share * abs(value), value + share * abs(value))
    return found


def stated_about(diagram: Diagram) -> dict[str, tuple[float, float]]:
    """Return what a diagram states of its noise and loads, which nobody knows exactly: block.parameter -> (low, high).

    A tolerance, where the diagram has one, says how well.

    >>> from stickslip.blocks import Noise
    >>> from stickslip.diagram import wire
    >>> load = Noise("D", sd=0.2, dt=1.0, correlation_time=60.0).with_tolerances(correlation_time=0.5)
    >>> stated_about(wire([load], outputs=["D"]))
    {'D.sd': (0.05, 0.8), 'D.correlation_time': (30.0, 90.0)}
    """
    found = {}
    for one in nuisances(diagram):
        coloured = one.correlation_time > 0.0
        sizes = [("sd", one.sd, LOAD, LOAD) if coloured else ("sd", one.sd, LESS, MORE)]
        sizes += [("correlation_time", one.correlation_time, TIME, TIME)] if coloured else []
        for name, value, less, more in sizes:
            key = f"{one.block}.{name}"
            share = diagram.tolerances.get(key)
            found[key] = (value / less, value * more) if share is None else (value * (1 - share), value * (1 + share))
    return found


def stated(diagram: Diagram, keys: Iterable[str]) -> dict[str, float]:
    """Return what a diagram states of parameters, block.parameter -> value."""
    parts = [(key, *key.rpartition(".")[::2]) for key in keys]
    return {key: float(diagram[block].params[name]) for key, block, name in parts}


def with_logged_sources(diagram: Diagram, log: Log) -> Diagram:
    """Return the diagram with the sources that the log knows (set points) replaced by open inputs of their names."""
    known = [
        block.name
        for block in diagram.blocks
        if block.role is Role.SOURCE and not block.ports_in and set(block.output_labels) <= set(log.names)
    ]
    return diagram.without(*known) if known else diagram


def compiled(diagram: Diagram) -> Diagram:
    """Return the diagram with sampled functions as blocks that the engine compiles, where it can.

    Such a function may be the controller of somebody who knows its program; in Python no filter follows it.
    """
    for block in diagram.blocks:
        if isinstance(block, SampledFunction):
            twin = compiled_step(block)
            address(twin.kernels.step)
            if in_python(twin.kernels.step) is None and twin is not block:
                diagram = diagram.replace(block.name, twin)
    return diagram


def in_percent(diagram: Diagram, log: Log) -> tuple[Diagram, Log]:
    """Return the diagram with outputs of controllers from 0 to 100 whose span nobody states and whose log says so."""
    for block in diagram.blocks:
        op = block.loop_signal("OP")
        if block.role is not Role.CONTROLLER or op is None or op not in log or ends(diagram, str(op)) is not None:
            continue
        values = log[op][log.good(op)]
        if len(values) and SHARE < float(np.max(values)) <= PERCENT:
            other = copy.copy(block)
            port = next(p.name for p, s in zip(block.ports_out, block.output_labels, strict=True) if s == op)
            other.spans = {**block.spans, port: (0.0, PERCENT)}
            diagram = diagram.replace(block.name, other)
            note = f"{op} is taken to go from 0 to {PERCENT:g}, since no block states its span and the log says so."
            log = replace(log, notes=(*log.notes, note))
    return diagram, log


def _noises(diagram: Diagram) -> set[str]:
    """Return the signals that are white noise of a sensor: a simulation writes them, a plant does not know them."""
    white = {nuisance.block for nuisance in nuisances(diagram) if nuisance.correlation_time == 0.0}
    read_by = {s for block in diagram.blocks if block.role is Role.SENSOR for s in block.input_labels}
    return {str(diagram[name].output_labels[0]) for name in white} & read_by


def _refuse_other_unit(diagram: Diagram, log: Log, signal: str) -> None:
    """Raise ``GapError`` for an output that the log has far from where its controller keeps it, as percent are."""
    block = diagram.blocks[diagram.driven[signal][0]]
    if block.role is not Role.CONTROLLER or block.limit_params is None:
        return
    low, high = block.limits
    usual = float(np.median(log[signal][log.good(signal)]))
    if not low - ELSEWHERE * (high - low) <= usual <= high + ELSEWHERE * (high - low):
        raise GapError(
            f"{signal} is about {usual:.3g} in the log, but {block.name!r} of the model keeps it within {low:g} and "
            f"{high:g}; bring the log to the model's unit, e.g. percent to a share by a factor of 0.01"
        )


def read(diagram: Diagram, log: Log) -> tuple[Diagram, Record]:
    """Return the diagram with its logged sources open, and the record of the signals that both have.

    Missing values of open inputs are taken as held, missing rows as rows of nothing
    (``stickslip.gap.records.regular``).  The noise of a sensor, if a simulation logged it, is not used.

    Raises ``GapError`` if log and diagram share no driven signal, an open input is not logged, a column differs from a
    signal by small and capital letters only, or rows are too few.
    """
    if len(log) < FEWEST:
        raise GapError(f"the log has {len(log)} rows, which is too few to find a gap; give at least {FEWEST}")
    if log.duration > LONGEST * log.dt * len(log):
        raise GapError(
            f"the log has {len(log)} rows over {log.duration:.3g} s, though a row every {log.dt:.3g} s is the rule; "
            "mend its times, or cut it at the gaps"
        )
    opened, log = in_percent(compiled(with_logged_sources(diagram, log)), log)
    known = {str(s).casefold(): str(s) for s in (*opened.signals, *opened.open_inputs) if s not in log}
    for name in log.names:
        meant = known.get(name.casefold())
        if meant is not None and name not in opened.signals and name not in opened.open_inputs:
            raise GapError(f"the log has a column {name!r}, the model a signal {meant!r}; rename the column to that")
    missing = [s for s in opened.open_inputs if s not in log]
    if missing:
        raise GapError(
            f"the model's input {missing[0]!r} is not in the log, which has {', '.join(log.names) or 'no signals'}; "
            "log it, rename a column, or close the input in the model"
        )
    empty = [s for s in opened.open_inputs if not log.good(s).any()]
    if empty:
        raise GapError(f"the model's input {empty[0]!r} has no good value in the log; log it, or close it in the model")
    scans = min((b.period for b in opened.blocks if b.sampled), default=0.0)
    log = with_rows_filled(with_inputs_held(log, opened.open_inputs), opened.open_inputs, scans)
    usable = [s for s in opened.signals if s in log and s not in _noises(opened) and log.good(s).sum() >= FEWEST]
    if not usable:
        raise GapError(
            f"the log has none of the signals that the model drives: it has {', '.join(log.names) or 'none'}, the "
            f"model drives {', '.join(opened.signals[:20])}; rename the columns to these"
        )
    bad = [s for s in usable if np.isnan(log[s]).all()]
    for signal in usable:
        _refuse_other_unit(opened, log, signal)
    pinned = tuple(s for s in usable if s not in bad)
    return opened, Record(log, tuple(opened.open_inputs), pinned, fresh=_fresh(opened, pinned))


def _fresh(diagram: Diagram, signals: Iterable[str]) -> dict[str, tuple[float, float]]:
    """Return the signals of sensors whose noise is white, with (period, first time) [s] of its draws.

    None beside a load that nobody measures: what that has done to a row lasts longer than the noise there.
    """
    drawing = nuisances(diagram)
    if any(one.correlation_time > 0.0 for one in drawing):
        return {}
    white = {one.block for one in drawing}
    found = {}
    for s in signals:
        sensor = diagram.blocks[diagram.driven[s][0]]
        name = noise_of(diagram, sensor) if sensor.role is Role.SENSOR else None
        if name in white:
            drawn = diagram[name]
            first = float(drawn.params[drawn.offset_param]) if drawn.offset_param else 0.0
            found[s] = (drawn.period, first)
    return found

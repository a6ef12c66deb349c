"""Turn points of a design into ensembles: one reference diagram, and the numbers in which a point differs from it.

Every point is built anew where quantities of the plant vary.  Points whose diagrams differ in numbers only share a
reference, the first of their kind, so that one ensemble runs them together; others form an ensemble of their own.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from stickslip.blocks.block import Block
from stickslip.blocks.ports import nearest
from stickslip.diagram.diagram import Diagram
from stickslip.diagram.ensembles.variants import Reseedable
from stickslip.logs.arrays import Values
from stickslip.plant.rest import InfeasibleFeed
from stickslip.study.axes import Axis, StudyError, Value
from stickslip.study.design import Design
from stickslip.study.measures import limiting
from stickslip.study.subject import Subject, start_kicks

BUILT = 512  # diagrams kept: neighbouring points share them


@dataclass(frozen=True)
class Refusal:
    """A run that cannot be made: INFEASIBLE (the plant cannot rest there) or REFUSED (a block rejects a value)."""

    status: str
    reason: str


@dataclass(frozen=True, eq=False)
class Prepared:
    """A run: its reference diagram and what it has other than that, as an ensemble takes it."""

    reference: Diagram
    params: Mapping[str, float]
    start: Mapping[str, float]


@dataclass(frozen=True)
class Batch:
    """Runs of one ensemble, with their columns, and the values of the limits of measured signals that they share."""

    reference: Diagram
    runs: tuple[int, ...]
    params: Mapping[str, Values]
    start: Mapping[str, Values]
    seeds: NDArray[np.int64] | None
    limits: tuple[tuple[str, float], ...]


class Points:
    """Prepares the runs of a design.

    ``kicks`` None: start as the subject does; 0: at rest; more: that many kicks of ``size`` a point.
    """

    def __init__(self, subject: Subject, design: Design, kicks: int | None, size: float, seed: int) -> None:
        self.subject, self.design, self.kicks, self.size, self.seed = subject, design, kicks, size, seed
        self.references: dict[object, Diagram] = {}
        self.limiting: dict[int, frozenset[str]] = {}
        self.built = lru_cache(BUILT)(self._build)

    def split(self, runs: Sequence[int]) -> tuple[list[Batch], dict[int, Refusal]]:
        """Return the ensembles that make up these runs, and the runs that are refused."""
        ready: dict[int, Prepared] = {}
        refused: dict[int, Refusal] = {}
        points: dict[int, Prepared | Refusal] = {}
        for run in runs:
            point = run // self.design.kicks
            if point not in points:
                points[point] = self.at(point)
            prepared = points[point]
            if isinstance(prepared, Refusal):
                refused[run] = prepared
            else:
                ready[run] = self._kick(prepared, run % self.design.kicks) if self.kicks else prepared
        together: dict[object, list[int]] = {}
        for run, one in ready.items():
            together.setdefault((id(one.reference), self._limits(one)), []).append(run)  # one batch, one set of limits
        return [self._batch(group, ready) for group in together.values()], refused

    def at(self, point: int) -> Prepared | Refusal:
        """Return a point without its kicks, or why it cannot be run."""
        chosen = list(zip(self.design.axes, self.design.at(point), strict=True))
        try:
            built = self.built(tuple((a.name, v) for a, v in chosen if a.kind == "plant"))
            if isinstance(built, Refusal):
                return built
            diagram, reference, params, start = built
            params = params | _accepted(diagram, ((a, v) for a, v in chosen if a.kind == "vary"))
            start = start | _known(diagram, ((a, v) for a, v in chosen if a.kind == "start"))
        except ValueError as fault:
            return Refusal("REFUSED", str(fault))
        return Prepared(reference, params, start)

    def _build(
        self, values: tuple[tuple[str, Value], ...]
    ) -> tuple[Diagram, Diagram, dict[str, float], dict[str, float]] | Refusal:
        try:
            rest = self.subject.build(dict(values))
        except InfeasibleFeed as fault:
            return Refusal("INFEASIBLE", str(fault))
        except (ValueError, ArithmeticError) as fault:
            return Refusal("REFUSED", str(fault))
        diagram = rest if self.kicks is not None else self.subject.start(rest)
        reference = self.references.setdefault(_shape(diagram), diagram)
        return diagram, reference, *_differences(diagram, reference)

    def _kick(self, prepared: Prepared, kick: int) -> Prepared:
        """Return the prepared moved by one kick: the kicks are the same at every point."""
        rest = np.array([
            prepared.start[name] if name in prepared.start else _start_of(prepared.reference, name)
            for name in self.subject.kicked
        ])  # fmt: skip
        moved = start_kicks(rest, self.design.kicks, self.seed, self.size)[kick]
        return Prepared(
            prepared.reference,
            prepared.params,
            {**prepared.start, **dict(zip(self.subject.kicked, moved, strict=True))},
        )

    def _limits(self, one: Prepared) -> tuple[tuple[str, float], ...]:
        """Return the parameters of a run that limit signals, so far as they differ from the reference's."""
        key = id(one.reference)
        if key not in self.limiting:
            pairs = limiting(one.reference, one.reference.signals).values()
            self.limiting[key] = frozenset(name for pair in pairs for name in pair)
        return tuple((name, value) for name, value in one.params.items() if name in self.limiting[key])

    def _batch(self, runs: Sequence[int], ready: Mapping[int, Prepared]) -> Batch:
        reference = ready[runs[0]].reference
        params = _columns([ready[run].params for run in runs], lambda key: _param_of(reference, key))
        start = _columns([ready[run].start for run in runs], lambda key: _start_of(reference, key))
        noisy = any(isinstance(block, Reseedable) for block in reference.blocks)
        seeds = (
            np.array([self.seed + run % self.design.kicks for run in runs]) if noisy or not (params or start) else None
        )
        return Batch(reference, tuple(runs), params, start, seeds, self._limits(ready[runs[0]]))


def resolve(axes: Iterable[Axis], subject: Subject, design_of_one: Diagram | None) -> list[Axis]:
    """Return the axes with names checked.

    A ``vary`` name that is no parameter of the diagram but a quantity of the subject, e.g. ``VPCS1.F_s``, is taken as
    that.  Raises ``StudyError`` with the nearest name for what is neither.
    """
    found = []
    for axis in axes:
        if axis.kind == "plant" and axis.name not in subject.quantities:
            if not subject.quantities:
                raise StudyError(
                    f"'{subject.name}' has no quantity '{axis.name}', and no other to rebuild it with; vary BLOCK.PARAM"
                )
            raise StudyError(
                f"'{subject.name}' has no quantity '{axis.name}'; {nearest(axis.name, list(subject.quantities))}"
            )
        if axis.kind == "vary" and design_of_one is not None:
            known = _names(design_of_one, "params")
            if axis.name not in known:
                if axis.name not in subject.quantities:
                    block = axis.name.rpartition(".")[0]
                    near = [name for name in known if name.rpartition(".")[0] == block] or known
                    raise StudyError(
                        f"'{subject.name}' has no parameter '{axis.name}'; {nearest(axis.name, near)}; "
                        "write BLOCK.PARAM"
                    )
                axis = replace(axis, kind="plant", as_vary=True)
        if axis.kind == "start" and design_of_one is not None:
            states = _names(design_of_one, "start")
            if axis.name not in states:
                raise StudyError(f"'{subject.name}' has no state '{axis.name}'; {nearest(axis.name, states)}")
        found.append(axis)
    return found


def _names(diagram: Diagram, what: str) -> list[str]:
    return [
        f"{block.name}.{name}"
        for block in diagram.blocks
        for name in (block.param_names if what == "params" else (*block.state_names, *block.memory_names))
    ]


def _accepted(diagram: Diagram, wanted: Iterable[tuple[Axis, Value]]) -> dict[str, float]:
    """Return the parameters if the blocks accept them together; otherwise pass on the block's error."""
    grouped: dict[str, dict[str, float]] = {}
    for axis, value in wanted:
        block, _, name = axis.name.rpartition(".")
        grouped.setdefault(block, {})[name] = float(value)
    for block, params in grouped.items():
        diagram[block].with_params(**params)
    return {f"{block}.{name}": value for block, params in grouped.items() for name, value in params.items()}


def _known(diagram: Diagram, wanted: Iterable[tuple[Axis, Value]]) -> dict[str, float]:
    found = {}
    for axis, value in wanted:
        diagram.starting_at({axis.name: float(value)})  # refuses unknown names and what cannot be a start
        found[axis.name] = float(value)
    return found


def _param_of(diagram: Diagram, key: str) -> float:
    block, _, name = key.rpartition(".")
    return float(diagram[block].p[diagram[block].param_index(name)])


def _start_of(diagram: Diagram, key: str) -> float:
    name, _, state = key.rpartition(".")
    block = diagram[name]
    block.starting_at(**{state: 0.0})  # refuses unknown names
    return float(
        block.x0[block.state_names.index(state)]
        if state in block.state_names
        else block.d0[block.memory_names.index(state)]
    )


def _shape(diagram: Diagram) -> object:
    """Return what two diagrams must share for one layout to serve both: all but numbers that have a name."""
    return (tuple(_block_shape(block) for block in diagram.blocks), diagram.open_inputs)


def _block_shape(block: Block) -> object:
    table = block.p[len(block.param_names) :].tobytes()
    return (
        type(block), block.name, tuple(block.input_labels), tuple(block.output_labels), block.kernels,
        block.param_names, block.state_names, block.memory_names, tuple(block.modes.items()), id(block.host),
        table, block.y0.tobytes(),
    )  # fmt: skip


def _differences(diagram: Diagram, reference: Diagram) -> tuple[dict[str, float], dict[str, float]]:
    """Return the parameters and start values in which a diagram differs from another of its shape."""
    params: dict[str, float] = {}
    start: dict[str, float] = {}
    for block, other in zip(diagram.blocks, reference.blocks, strict=True):
        for found, names, mine, its in (
            (params, block.param_names, block.p, other.p),
            (start, block.state_names, block.x0, other.x0),
            (start, block.memory_names, block.d0, other.d0),
        ):
            if mine is not its:
                for k in np.flatnonzero(mine[: len(names)] != its[: len(names)]).tolist():
                    found[f"{block.name}.{names[k]}"] = float(mine[k])
    return params, start


def _columns(rows: Sequence[Mapping[str, float]], default: Callable[[str], float]) -> dict[str, Values]:
    """Return one column a name, with the reference's value where a row has none."""
    names = dict.fromkeys(name for row in rows for name in row)
    found = {}
    for name in names:
        usual = default(name)
        found[name] = np.array([row.get(name, usual) for row in rows])
    return found

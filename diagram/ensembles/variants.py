"""The variants of an ensemble: a table of the numbers in which they differ, one row a variant.

Each column belongs to one value of one block: a parameter, a start state or a memory.  The blocks themselves
check every variant before anything runs; the engine's arrays then get each row in a single assignment.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray
from stickslip.blocks.arguments import by_name
from stickslip.blocks.block import Block
from stickslip.diagram.diagram import Diagram
from stickslip.diagram.flatten import Plan
from stickslip.engine.snapshot import Snapshot, offset
from stickslip.engine.table import Component

Floats = NDArray[np.float64]
Places = NDArray[np.intp]
Kind = Literal["p", "x0", "d0"]
Target = tuple[int, Kind, int]  # block, which of its arrays, index there


@runtime_checkable
class Reseedable(Protocol):
    """A block that draws random numbers."""

    def reseeded(self, seed: Sequence[int]) -> Block:
        """Return a copy that draws another stream."""


def reseeded(diagram: Diagram, seed: int) -> Diagram:
    """Return the diagram with the random numbers of ``seed``: block number b draws the stream of [seed, b].

    ``numpy.random.SeedSequence`` makes streams of different seeds and blocks independent.
    """
    return diagram.with_blocks(
        [
            block.reseeded((seed, b)) if isinstance(block, Reseedable) else block
            for b, block in enumerate(diagram.blocks)
        ]
    )


@dataclass(frozen=True)
class Variants:
    """The variants of an ensemble of ``diagram``.

    ``params``, ``start``, ``seeds``: what was asked for, each column (variants,).
    ``table[i, c]``: what variant ``i`` has at ``targets[c]``; shape (variants, columns).  ``t0``: when each run begins
    [s], (variants,).  ``blocks[b]``: what stands in place of block ``b`` in each variant.
    """

    diagram: Diagram
    params: Mapping[str, Floats]
    start: Mapping[str, Floats]
    seeds: NDArray[np.int64] | None
    table: Floats
    targets: tuple[Target, ...]
    t0: Floats
    blocks: Mapping[int, Sequence[Block]]

    def __len__(self) -> int:
        return len(self.table)

    def blocks_of(self, i: int) -> tuple[Block, ...]:
        """Return the blocks of variant ``i``, with the parameters of the diagram."""
        own = {b: given[i] for b, given in self.blocks.items()}
        blocks = self.diagram.blocks
        return tuple(own.get(b, block) for b, block in enumerate(blocks)) if own else tuple(blocks)

    def diagram_of(self, i: int) -> Diagram:
        """Return variant ``i`` as a diagram of its own."""
        diagram = self.diagram.with_blocks(self.blocks_of(i)) if self.blocks else self.diagram
        diagram = diagram.with_params({key: float(column[i]) for key, column in self.params.items()})
        if self.seeds is not None:
            diagram = reseeded(diagram, int(self.seeds[i]))
        return diagram.starting_at({key: float(column[i]) for key, column in self.start.items()})

    def point_to_tables(self, run: Snapshot, i: int) -> None:
        """Let the blocks that differ between the variants read the timetables of variant ``i``."""
        for b, given in self.blocks.items():
            timetable = given[i].timetable
            if b in run.component.blocks and timetable is not None:
                run.point_to(b, timetable)

    def shapes(self) -> NDArray[np.bool_]:
        """Tell which varied dead times are in force, (variants, varied dead times): one plan serves one such row."""
        theta = [c for c, target in enumerate(self.targets) if _is_dead_time(self.diagram.blocks, target)]
        return self.table[:, theta] > 0.0

    def places(self, laid: Plan, component: Component) -> tuple[Places, Places]:
        """Return (places in the run, columns of the table): ``Snapshot.put(places, table[i, columns])`` makes one."""
        pairs: list[tuple[int, int]] = []
        for c, (b, kind, index) in enumerate(self.targets):
            if b in component.blocks:
                pairs.append((offset(component, kind, b, index), c))
            if kind == "p":
                name = (
                    self.diagram.blocks[b].param_names[index] if index < len(self.diagram.blocks[b].param_names) else ""
                )
                dead_time, before = self.diagram.blocks[b].dead_time_param, self.diagram.blocks[b].before_param
                for f in laid.delays.get(b, ()):
                    if f in component.params and name in (dead_time, before):
                        pairs.append((offset(component, "p", f, int(name != dead_time)), c))
        return np.array([w for w, _ in pairs], dtype=np.intp), np.array([c for _, c in pairs], dtype=np.intp)


def variants_of(
    diagram: Diagram,
    params: Mapping[str, ArrayLike] | None,
    start: Mapping[str, ArrayLike] | None,
    seeds: ArrayLike | None,
    t0: ArrayLike = 0.0,
    times: ArrayLike | None = None,
    blocks: Mapping[str, Sequence[Block]] | None = None,
) -> Variants:
    """Return the variants asked for; single numbers hold for all.  ``times`` only tells how many there are.

    Raises ``ValueError`` if lengths differ, a name is unknown, or a block refuses the values of a variant (the
    message names the variant).
    """
    by_name("ensemble", "params", params or {}, {"valve.F_s": [1750.0, 2250.0]})
    by_name("ensemble", "start", start or {}, {"process.PV": [0.0, 0.5]})
    given = [(key, _numbers(key, v)) for key, v in [*(params or {}).items(), *(start or {}).items()]]
    if seeds is not None:
        given.append(("seeds", np.asarray(seeds)))
    given.append(("t0", _numbers("t0", t0)))
    if times is not None and np.ndim(times) == 2:
        given.append(("times", np.zeros(len(np.asarray(times)))))
    given += [(name, np.zeros(len(own))) for name, own in (blocks or {}).items()]
    n = _count(given)
    wanted = {key: _column(values, n) for key, values in (params or {}).items()}
    starts = {key: _column(values, n) for key, values in (start or {}).items()}
    for key, column in starts.items():
        if not np.isfinite(column).all():
            i = int(np.argmin(np.isfinite(column)))
            raise ValueError(f"'{key}' is to start at {column[i]} in variant {i}, but a start value is a finite number")
    streams = None if seeds is None else _seeds(seeds, n)
    columns: dict[Target, Floats] = {}
    own = {diagram.block_index(name): tuple(each) for name, each in (blocks or {}).items()}
    for b, each in own.items():
        columns |= _differing(diagram.blocks[b], b, each)
    for b, names in _grouped(diagram, wanted).items():
        columns |= _checked(diagram.blocks[b], b, names, n)
    if streams is not None:
        for b, block in enumerate(diagram.blocks):
            if isinstance(block, Reseedable):
                drawn = np.array([block.reseeded((int(seed), b)).d0 for seed in streams])
                columns |= {(b, "d0", k): drawn[:, k] for k in np.flatnonzero((drawn != block.d0).any(axis=0)).tolist()}
    for b, names in _grouped(diagram, starts).items():
        block = diagram.blocks[b]
        block.starting_at(**dict.fromkeys(names, 0.0))  # refuses unknown names
        for name, column in names.items():
            state = name in block.state_names
            index = (block.state_names if state else block.memory_names).index(name)
            columns[b, "x0" if state else "d0", index] = column
    table = np.stack(list(columns.values()), axis=1) if columns else np.zeros((n, 0))
    return Variants(diagram, wanted, starts, streams, table, tuple(columns), _column(t0, n), own)


def _differing(block: Block, b: int, given: Sequence[Block]) -> dict[Target, Floats]:
    """Return what differs between the blocks that the variants have in place of one block.

    Raises ``ValueError`` unless they differ in numbers only: same kernels, labels and sizes.
    """
    for i, other in enumerate(given):
        alike = isinstance(other, Block) and (other.kernels, other.input_labels, other.output_labels) == (
            block.kernels, block.input_labels, block.output_labels
        )  # fmt: skip
        if not (alike and (len(other.p), len(other.x0), len(other.d0)) == (len(block.p), len(block.x0), len(block.d0))):
            raise ValueError(
                f"in place of '{block.name}' variant {i} has {other!r:.80}, but variants differ in numbers only; give "
                f"blocks of the same kind with the labels {', '.join([*block.input_labels, *block.output_labels])}"
            )
    found: dict[Target, Floats] = {}
    kinds: tuple[Kind, ...] = ("p", "x0", "d0")
    for kind in kinds:
        values = np.array([getattr(other, kind) for other in given]).reshape(len(given), -1)
        places = np.flatnonzero((values != getattr(block, kind)).any(axis=0)).tolist()
        found |= {(b, kind, k): values[:, k] for k in places}
    return found


def _numbers(key: str, values: ArrayLike) -> Floats:
    try:
        return np.asarray(values, dtype=float)
    except (TypeError, ValueError):
        raise ValueError(
            f"'{key}' = {values!r}, but it is one number a variant; give a flat array of numbers"
        ) from None


def _count(given: Sequence[tuple[str, NDArray[np.generic]]]) -> int:
    for key, values in given:
        if values.ndim > 1:
            raise ValueError(
                f"'{key}' has shape {values.shape}, but it must be one number a variant; give a flat array"
            )
    lengths = {key: values.size for key, values in given if values.ndim == 1}
    if not lengths:
        raise ValueError(
            "nothing says how many variants there are; give params, start, seeds, t0 or inputs at least one array"
        )
    if len(set(lengths.values())) > 1:
        parts = ", ".join(f"'{key}' {length}" for key, length in lengths.items())
        raise ValueError(
            f"the variants disagree in number: {parts}; give arrays of one length (single numbers hold for all)"
        )
    if not next(iter(lengths.values())):
        raise ValueError("there are 0 variants; give arrays of at least one value")
    return next(iter(lengths.values()))


def _column(values: ArrayLike, n: int) -> Floats:
    column = np.array(np.broadcast_to(np.asarray(values, dtype=float), (n,)))
    column.flags.writeable = False
    return column


def _seeds(seeds: ArrayLike, n: int) -> NDArray[np.int64]:
    given = np.asarray(seeds)
    if given.dtype.kind not in "iu" or (given < 0).any():
        raise ValueError(
            f"seeds are {given.dtype} from {given.min()}, but must be integers >= 0; e.g. seeds=range(1000)"
        )
    streams = np.array(np.broadcast_to(given.astype(np.int64), (n,)))
    streams.flags.writeable = False
    return streams


def _grouped(diagram: Diagram, columns: Mapping[str, Floats]) -> dict[int, dict[str, Floats]]:
    """Sort ``{"valve.F_s": column}`` by block; the diagram refuses names it does not know."""
    groups: dict[int, dict[str, Floats]] = {}
    for key, column in columns.items():
        name, _, what = key.rpartition(".")
        groups.setdefault(diagram.block_index(name), {})[what] = column
    return groups


def _checked(block: Block, b: int, names: Mapping[str, Floats], n: int) -> dict[Target, Floats]:
    """Let the block check the parameters of every variant, and return what it made of them."""
    indices = [block.param_index(name) for name in names]
    made = np.empty((n, len(names)))
    rows = zip(*(column.tolist() for column in names.values()), strict=True)
    for i, row in enumerate(rows):
        try:
            made[i] = block.with_params(**dict(zip(names, row, strict=True))).p[indices]
        except ValueError as error:
            error.add_note(f"variant {i} of the ensemble")
            raise
    return {(b, "p", index): made[:, k] for k, index in enumerate(indices)}


def _is_dead_time(blocks: Sequence[Block], target: Target) -> bool:
    b, kind, index = target
    name = blocks[b].dead_time_param
    return kind == "p" and name is not None and blocks[b].param_index(name) == index

"""A diagram: blocks wired by signal names, a ``control.InterconnectedSystem`` and at the same time a value.

It can be taken apart (``blocks``, ``part``), changed (``with_params``, ``replace``, ``starting_at``, ``in_mode``)
and nested; every change returns a new diagram and leaves the old one as it was.
"""

import copy
import math
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Self

import control as ct
import numpy as np
from numpy.typing import ArrayLike, NDArray

from blocks.arguments import by_name, text, texts
from blocks.block import NO_APPEND, Block
from blocks.control_system import as_block
from blocks.dry_run import dry_run
from blocks.parameters import Parametrised
from blocks.ports import nearest, number, shortened
from diagram.connections import ConnectionMap
from diagram.past import Past, together
from diagram.wiring import WiringError, check_readers, check_units, drivers, feeds_now, flow_order

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from diagram.flatten import Plan


class Diagram(Parametrised, ct.InterconnectedSystem):  # type: ignore[misc]
    """Blocks joined by signal names; build one with ``wire``.

    Attributes: ``blocks`` (leaves, in the order given), ``signals`` (all driven signals), ``signal_units``,
    ``driven`` (signal -> (block, port)), ``order`` (signal-flow order).  Every kernel is tried once, see
    ``blocks.dry_run``.  As a python-control system its inputs are
    the open inputs, its outputs the declared outputs, and it sees each block's ``smooth()`` view.
    """

    connect_map = ConnectionMap()
    input_map = ConnectionMap()
    output_map = ConnectionMap()

    def _owner(self) -> str:
        return ""

    def __init__(
        self, blocks: Sequence[Block], inputs: Sequence[str] = (), outputs: Sequence[str] | None = None,
        name: str = "diagram",
    ) -> None:  # fmt: skip
        self.blocks = tuple(blocks)
        text("diagram", "name", name)
        self.open_inputs = texts(name, "inputs", inputs)
        outputs = None if outputs is None else texts(name, "outputs", outputs)
        for block in self.blocks:
            dry_run(block)
        self.driven = drivers(self.blocks, self.open_inputs)
        self.declared_outputs = None if outputs is None else tuple(outputs)
        self.chosen_outputs = tuple(self.driven) if outputs is None else tuple(outputs)
        check_readers(self.blocks, self.driven, self.open_inputs, self.declared_outputs or ())
        self.signal_units = check_units(self.blocks, self.driven)
        self.order = tuple(flow_order(self.blocks, self.driven))
        self.signals = tuple(self.driven)
        self._plan: Plan | None = None
        self._cells: Plan | None = None
        self._past: Past | None = None
        seen = [block.smooth() for block in self.blocks]
        states = [f"{block.name}[{state}]" for block in seen for state in block.seen_states()]
        super().__init__(
            seen, inputs=list(self.open_inputs), outputs=list(self.chosen_outputs), states=states, name=name, dt=0,
        )  # fmt: skip
        self._fix_params(_all_params(seen))
        self.updfcn, self.outfcn = self._update, self._output
        for wired in ("connect_map", "input_map", "output_map"):
            del self.__dict__[wired]  # without connections python-control has filled them with zeros

    def __repr__(self) -> str:
        kinds = ", ".join(f"{type(block).__name__} '{block.name}'" for block in self.blocks)
        open_ = f"; open inputs {', '.join(self.open_inputs)}" if self.open_inputs else ""
        signals = shortened(f"signals {', '.join(self.signals)}")
        return shortened(f"<Diagram '{self.name}' of {len(self.blocks)} blocks{open_}: {kinds}; {signals}>")

    def _repr_html_(self) -> str:
        from logs.notebook import image

        return image(self.plot())

    def append(self, other: object) -> None:
        """Say what to use in place of ``ct.append``, which stacks linear systems only.

        Raises ``TypeError``, always.
        """
        raise TypeError(f"'{self.name}': {NO_APPEND}")

    # --- look ---------------------------------------------------------------------------------------------
    def __getitem__(self, name: str) -> Block:
        """Return a block by name."""
        return self.blocks[self.block_index(name)]

    def block_index(self, name: str) -> int:
        """Return the position of a block; raise ``WiringError`` with the nearest name if there is none."""
        for b, block in enumerate(self.blocks):
            if block.name == name:
                return b
        known = [block.name for block in self.blocks]
        raise WiringError(f"the diagram has no block '{name}'; {nearest(name, known)}")

    @property
    def signal_spans(self) -> dict[str, tuple[float, float]]:
        """Instrument spans of the signals that have one, low and high in the unit of the signal."""
        return {
            signal: block.spans[port.name]
            for block in self.blocks
            for port, signal in zip(block.ports_out, block.output_labels, strict=True)
            if port.name in block.spans
        }

    @property
    def x0(self) -> NDArray[np.float64]:
        """Start state as python-control counts states, shape (nstates,)."""
        return np.concatenate([np.zeros(0), *(block.seen_start() for block in self.syslist)])

    @property
    def past(self) -> Past | None:
        """What a run that ended here left under way (dead times, samples taken); None if the diagram starts afresh."""
        return self._past

    def plot(self) -> "Figure":
        """Draw the diagram: one box per block, one arrow per signal."""
        from diagram.figures.drawing import draw

        return draw(self)

    # --- change -------------------------------------------------------------------------------------------
    def with_past(self, past: Past | None) -> Self:
        """Return the diagram going on from a run with this past (``run.final.past``), or starting afresh with None.

        Changed copies keep what still fits: what is in the dead times of blocks of the same name, samples taken.
        """
        other = self._copy()
        other._past = past
        return other

    def with_params(self, changes: Mapping[str, float]) -> Self:
        """Return the diagram with other parameter values, given as ``{"valve.F_s": 1750.0}``."""
        by_name(self.name, "params", changes, {"valve.F_s": 1750.0})
        return self._with_blocks(self._changed(changes, "with_params"))

    def starting_at(self, values: Mapping[str, float]) -> Self:
        """Return the diagram with other start values of states or memories, ``{"process.x": 0.5}``.

        Raises ``WiringError`` for an unknown block or state, or a value that is not finite.
        """
        for key, value in by_name(self.name, "start", values, {"process.PV": 0.5}).items():
            if not math.isfinite(number("start", key, value)):
                raise WiringError(f"'{key}' is to start at {float(value):g}, but it must be finite; give a number")
        return self._with_blocks(self._changed(values, "starting_at"))

    def in_mode(self, modes: str | Mapping[str, str]) -> Self:
        """Return the diagram with blocks in a mode: one name for all that have it, or block -> mode.

        A stuck stem linearises to zero; ``ct.linearize(loop.in_mode("ideal"), ...)`` shows the loop behind it.
        Raises ``WiringError`` for a mode that no block has, ``BlockError`` for one that the named block has not.
        """
        if isinstance(modes, str):
            having = {block.name: modes for block in self.blocks if modes in block.modes}
            if not having:
                known = sorted({m for block in self.blocks for m in block.modes})
                raise WiringError(f"no block of the diagram has a mode '{modes}'; {nearest(modes, known)}")
            modes = having
        changed = list(self.blocks)
        for name, mode in by_name(self.name, "modes", modes, {"valve": "ideal"}).items():
            b = self.block_index(name)
            changed[b] = changed[b].in_mode(mode)
        return self._with_blocks(changed)

    def at_state(self, x: ArrayLike) -> Self:
        """Return the diagram starting from a python-control state vector (e.g. of ``find_operating_point``)."""
        given = [number("at_state", "x", value) for value in np.ravel(x).tolist()]
        if len(given) != self.nstates:
            raise WiringError(
                f"{len(given)} values are given, but python-control counts {self.nstates} states: "
                f"{', '.join(self.state_labels)}; give one value for each"
            )
        values = dict(zip(self.state_labels, given, strict=True))
        plain = {
            f"{block.name}.{state}": values[label]
            for block in self.blocks
            for state in (*block.state_names, *block.memory_names)
            if (label := f"{block.name}[{state}]") in values
        }
        return self.starting_at(plain)

    def replace(self, name: str, block: Block | ct.InputOutputSystem) -> "Diagram":
        """Return the diagram with one block replaced; the new one takes over name and labels, port by port.

        The new one may be any system that ``wire`` takes, but not a diagram.

        Raises ``WiringError`` if there is no such block, or if the new one has other numbers of ports.
        """
        if isinstance(block, Diagram) or not isinstance(block, ct.InputOutputSystem):
            raise WiringError(
                f"'{name}' cannot be replaced by {type(block).__name__}: it is no block; take the old blocks out with "
                "without(), and wire() a diagram in their place"
            )
        block = as_block(block)
        b = self.block_index(name)
        old = self.blocks[b]
        if len(block.ports_in) != len(old.ports_in) or len(block.ports_out) != len(old.ports_out):
            raise WiringError(
                f"block '{name}' has {len(old.ports_in)} inputs and {len(old.ports_out)} outputs, its replacement "
                f"'{block.name}' {len(block.ports_in)} and {len(block.ports_out)}; they must agree"
            )
        new = block.relabelled(name, list(old.input_labels), list(old.output_labels))
        past = self._past
        if past is not None and new.sampled:
            new = new.holding(old.y0) if old.sampled else new  # until the next sample
            past = past if old.sampled else past.without(name)
        changed = [*self.blocks[:b], new, *self.blocks[b + 1 :]]
        return Diagram(changed, self.open_inputs, self.declared_outputs, self.name).with_past(past)

    def part(self, names: Iterable[str], name: str = "part") -> "Diagram":
        """Return the named blocks as a diagram of their own; signals from elsewhere become open inputs."""
        kept = [self[n] for n in texts(self.name, "names", names if isinstance(names, str) else _listed(names))]
        driven = {s for block in kept for s in block.output_labels}
        inputs = dict.fromkeys(s for block in kept for s in block.input_labels if s not in driven)
        return Diagram(kept, list(inputs), None, name).with_past(self._past)

    def without(self, *names: str) -> "Diagram":
        """Return the diagram without some blocks; what they drove becomes an open input where it is read.

        A source that only they read, e.g. the set point of a controller, goes with them.
        """
        for n in names:
            self.block_index(n)
        kept = [block for block in self.blocks if block.name not in names]
        gone = {signal for block in self.blocks if block.name in names for signal in block.input_labels}
        read = {signal for block in kept for signal in block.input_labels}
        idle = gone - read
        return self.part([b.name for b in kept if b.ports_in or not idle.issuperset(b.output_labels)], self.name)

    def named(self, name: str, **inputs: str) -> "Diagram":
        """Return the diagram under another name, its open inputs relabelled (``SP="SP1"``), for nesting.

        Raises ``WiringError`` for an input that is not open.
        """
        for key, signal in inputs.items():
            text(self.name, key, signal)
            if key not in self.open_inputs:
                raise WiringError(
                    f"diagram '{self.name}' has no open input '{key}'; {nearest(key, list(self.open_inputs))}"
                )
        blocks = [
            block.relabelled(block.name, [inputs.get(s, s) for s in block.input_labels], list(block.output_labels))
            for block in self.blocks
        ]
        opened = [inputs.get(s, s) for s in self.open_inputs]
        return Diagram(blocks, opened, self.declared_outputs, name).with_past(self._past)

    def leaves(self) -> list[Block]:
        """Return the blocks as they appear inside another diagram: names and signals behind ``name/``."""
        prefix = f"{self.name}/"
        return [
            block.relabelled(
                prefix + block.name,
                [prefix + s if s in self.driven else s for s in block.input_labels],
                [prefix + s for s in block.output_labels],
            )
            for block in self.blocks
        ]

    def _changed(self, values: Mapping[str, float], change: str) -> list[Block]:
        grouped: dict[int, dict[str, float]] = {}
        for key, value in values.items():
            name, _, what = key.rpartition(".")
            if not name:
                raise WiringError(f"'{key}' does not say which block; write 'block.name', e.g. 'valve.F_s'")
            grouped.setdefault(self.block_index(name), {})[what] = value
        blocks = list(self.blocks)
        for b, group in grouped.items():
            blocks[b] = getattr(blocks[b], change)(**group)
        return blocks

    def _with_blocks(self, blocks: Sequence[Block]) -> Self:
        """Return a copy with blocks that differ only in values; wiring and plan are shared.

        A dead time that becomes or ceases to be zero changes the signal flow: then everything is checked afresh.
        """
        seen = [block.smooth() for block in blocks]
        same_flow = all(feeds_now(new) == feeds_now(old) for new, old in zip(blocks, self.blocks, strict=True))
        if not same_flow or [b.seen_states() for b in seen] != [b.seen_states() for b in self.syslist]:
            other = type(self)(blocks, self.open_inputs, self.declared_outputs, self.name)
            other._past = self._past
            return other
        other = self._copy()
        other.blocks = tuple(blocks)
        other.syslist = seen
        other._fix_params(_all_params(seen))
        return other

    def _copy(self) -> Self:
        other = copy.copy(self)
        other._plan, other._cells = self._plan, self._cells
        other.updfcn, other.outfcn = other._update, other._output
        return other

    def __getstate__(self) -> dict[str, Any]:
        """Leave the plans behind: they hold addresses of compiled code, which are worth nothing in another process."""
        return self.__dict__ | {"_plan": None, "_cells": None}

    def _update_params(self, params: Mapping[str, float] | None) -> None:
        """Take the diagram's own parameters; in an interconnection python-control hands over those of others too."""
        given = params or {}
        joined = self.params.keys() <= given.keys()
        for key in given.keys() - self.params.keys():
            if not joined or any(key.startswith(f"{block.name}.") for block in self.blocks):
                raise WiringError(f"the diagram has no parameter '{key}'; {nearest(key, list(self.params))}")
        super()._update_params({key: value for key, value in given.items() if key in self.params})

    def _update(self, t: float, x: Any, u: Any, params: Any) -> Any:
        self._update_params(params)
        return self._rhs(t, x, u)

    def _output(self, t: float, x: Any, u: Any, params: Any) -> Any:
        self._update_params(params)
        return self._out(t, x, u)


def _all_params(blocks: Iterable[Block]) -> dict[str, float]:
    return {f"{block.name}.{key}": value for block in blocks for key, value in block.params.items()}


def _listed(items: Any) -> list[Any]:
    """Return what is given in a list or the like as a list."""
    if isinstance(items, Iterable) and not isinstance(items, str | Block | Diagram):
        return list(items)
    raise WiringError(f"{items!r:.60} is no list; give several things as one, e.g. [valve, process]")


def wire(
    items: Iterable[Block | Diagram | ct.InputOutputSystem],
    inputs: Sequence[str] = (),
    outputs: Sequence[str] | None = None,
    name: str = "diagram",
) -> Diagram:
    """Join blocks, diagrams and python-control systems by signal name into one diagram.

    A signal is driven by exactly one output label and read by every input with the same label.  A nested diagram
    ``loop`` shows its signals as ``loop/PV`` and reads its open inputs by name.

    Parameters: ``items`` blocks, diagrams and systems of python-control (``ct.tf``, ``ct.zpk``, ``ct.ss``,
    ``ct.nlsys``, continuous or sampled, see ``blocks.control_system``), whose ports are called by their labels;
    ``inputs`` signals left open on purpose; ``outputs`` the outputs of the python-control system (default: all).

    Raises ``WiringError`` for unknown, dangling, doubly driven or unit-mismatched signals and algebraic loops,
    ``BlockError`` for what is no such item, or a system that cannot be simulated (improper, dt = True).

    >>> from blocks import PI, FirstOrder, Step
    >>> loop = wire([Step("SP", 0.5), PI(K_p=0.4, T_i=10.0, outputs="MV"), FirstOrder(K=3.0, tau=10.0)])
    >>> loop.signals
    ('SP', 'MV', 'PV')
    """
    leaves: list[Block] = []
    pasts: list[Past] = []
    for item in _listed(items):
        if isinstance(item, Diagram):
            leaves += item.leaves()
            pasts += [item.past.inside(item.name)] if item.past is not None else []
        else:
            leaves.append(as_block(item))
    return Diagram(leaves, inputs, outputs, name).with_past(together(pasts))

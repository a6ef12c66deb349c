"""A diagram: blocks wired by signal names, a ``control.InterconnectedSystem`` and at the same time a value.

It can be taken apart (``blocks``, ``part``, ``cut``, ``segments``), changed (``with_params``, ``replace``, ``insert``,
``rewire``, ``starting_at``, ``in_mode``) and nested; a change returns a new diagram and leaves the old one as it is.
"""

import copy
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Self

import control as ct
import numpy as np
from numpy.typing import ArrayLike, NDArray

from blocks.arguments import text, texts
from blocks.block import NO_APPEND, Block
from blocks.dry_run import dry_run
from blocks.parameters import Parametrised
from blocks.ports import nearest, shortened
from diagram import changes, cuts
from diagram.connections import ConnectionMap, own_params
from diagram.past import Past
from diagram.wiring import WiringError, check_readers, check_units, drivers, feeds_now, flow_order, spans

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from diagram.flatten import Plan
    from diagram.segments import Segment
    from logs import Log


class Diagram(Parametrised, ct.InterconnectedSystem):  # type: ignore[misc]
    """Blocks joined by signal names; build one with ``wire``.

    Attributes: ``blocks`` (leaves, in the order given), ``signals`` (all driven signals), ``signal_units``,
    ``input_units``, ``signal_spans`` (of instruments), ``driven`` (signal -> (block, port)), ``order`` (signal-flow
    order).  Every kernel is tried once, see ``blocks.dry_run``.  As a python-control system its inputs are the open
    inputs, its outputs the declared outputs, and it sees each block's ``smooth()`` view.
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
        units = check_units(self.blocks)
        self.signal_units = {signal: units[signal] for signal in self.driven}
        self.input_units = {signal: units[signal] for signal in self.open_inputs}
        self.signal_spans = spans(self.blocks)
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
    def x0(self) -> NDArray[np.float64]:
        """Start state as python-control counts states, shape (nstates,)."""
        return np.concatenate([np.zeros(0), *(block.seen_start() for block in self.syslist)])

    def plan(self, records: int = 0) -> "Plan":
        """Return how the diagram is laid out for the engine, made once and shared by all that differ only in values.

        ``records``: how many records its dead times have to hold at least.
        """
        from diagram.flatten import DELAY_RECORDS, plan

        self._plan = plan(self, max(records, DELAY_RECORDS), self._plan)
        return self._plan

    def plan_in_cells(self, records: int = 0) -> "Plan":
        """Return the plan with the diagram cut into cells that take steps of their own, where that pays."""
        from diagram.flatten import DELAY_RECORDS, plan_in_cells

        self._cells = plan_in_cells(self, max(records, DELAY_RECORDS), self._cells)
        if not self._cells.links:
            self._plan = self._cells
        return self._cells

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

    def with_params(self, values: Mapping[str, float]) -> Self:
        """Return the diagram with other parameter values, given as ``{"valve.F_s": 1750.0}``."""
        return self.with_blocks(changes.blocks_with_params(self, values))

    def with_tolerances(self, shares: Mapping[str, float]) -> Self:
        """Return the diagram with the tolerances of parameters, ``{"process.K": 0.05}`` for within 5 % of its value.

        They say how well the model is known, change no run, and travel with every copy; ``tolerances`` reads them back.
        Raises ``BlockError`` for a share that is not from 0 (none) to below 1, or of a parameter that is 0 or infinite.
        """
        return self.with_blocks(changes.blocks_with_tolerances(self, shares))

    @property
    def tolerances(self) -> dict[str, float]:
        """Tolerances of parameters by full name, as shares of their values.

        >>> from plant.loops import self_regulating_loop
        >>> self_regulating_loop().with_tolerances({"process.K": 0.05, "process.tau": 0.1}).cut("PV").tolerances
        {'process.K': 0.05, 'process.tau': 0.1}
        """
        return {f"{block.name}.{key}": share for block in self.blocks for key, share in block.tolerances.items()}

    def starting_at(self, values: Mapping[str, float]) -> Self:
        """Return the diagram with other start values of states or memories, ``{"process.x": 0.5}``.

        Raises ``WiringError`` for an unknown block or state, or a value that is not finite.
        """
        return self.with_blocks(changes.blocks_starting_at(self, values))

    def in_mode(self, modes: str | Mapping[str, str]) -> Self:
        """Return the diagram with blocks in a mode: one name for all that have it, or block -> mode.

        A stuck stem linearises to zero; ``ct.linearize(loop.in_mode("ideal"), ...)`` shows the loop behind it.
        Raises ``WiringError`` for a mode that no block has, ``BlockError`` for one that the named block has not.
        """
        return self.with_blocks(changes.blocks_in_mode(self, modes))

    def at_state(self, x: ArrayLike) -> Self:
        """Return the diagram starting from a python-control state vector (e.g. of ``find_operating_point``)."""
        return self.starting_at(changes.start_values(self, x))

    def replace(self, name: str, block: Block | ct.InputOutputSystem) -> "Diagram":
        """Return the diagram with one block replaced; the new one takes over name and labels, port by port.

        The new one may be any system that ``wire`` takes, but not a diagram.

        Raises ``WiringError`` if there is no such block, or if the new one has other numbers of ports.
        """
        return changes.replaced(self, name, block)

    def pinned(self, log: "Log", signals: Sequence[str] | None = None) -> "Diagram":
        """Return the diagram held to a log: logged signals are set right at each logged time (``diagram.pins``).

        ``signals``: those to pin, by default all that the log has too.  Of a sensor's PV, ``PV:sensor`` is then what
        the sensor gives and ``PV:offset`` what the pin adds.  Open inputs that are logged are driven by the log, held
        between samples.  What is missing or marked bad in the log is not pinned there.

        Raises ``WiringError`` if log and diagram share no signal, or for a signal that one of them has not.
        """
        from diagram.pins import pinned

        return pinned(self, log, signals)

    def part(self, names: Iterable[str], name: str = "part") -> "Diagram":
        """Return the named blocks as a diagram of their own; signals from elsewhere become open inputs."""
        return changes.part(self, names, name)

    def without(self, *names: str) -> "Diagram":
        """Return the diagram without some blocks; what they drove becomes an open input where it is read.

        A source that only they read, e.g. the set point of a controller, goes with them.
        """
        return changes.without(self, names)

    def cut(self, signals: str | Iterable[str]) -> "Diagram":
        """Return the diagram with signals cut: blocks that read one now read an open input of its name.

        What drives it goes on under its name and the block's, ``PV:sensor``, also where the signal is a declared
        output.  An open input stays one.  Between the two the loop is open: ``ct.linearize(loop.cut("PV"), ...)``.

        Raises ``WiringError`` for a signal that is unknown or that no block reads.

        >>> from plant.loops import self_regulating_loop
        >>> opened = self_regulating_loop().cut("PV")
        >>> opened.open_inputs, opened.signals
        (('PV',), ('SP', 'OP', 'MV', 'PV:process'))
        """
        return cuts.cut(self, signals)

    def segments(self, logged: str | Iterable[str]) -> "tuple[Segment, ...]":
        """Return the maximal pieces between logged signals: what each reads and drives, and the piece alone.

        Every block is in one segment.  Raises ``WiringError`` for a signal that is unknown.

        >>> from plant.loops import self_regulating_loop
        >>> for segment in self_regulating_loop().segments(["SP", "OP", "PV"]):
        ...     print(segment)
        <Segment SP: reads nothing, drives SP>
        <Segment controller: reads SP, PV, drives OP>
        <Segment valve, process: reads OP, drives PV>
        """
        from diagram.segments import segments

        return segments(self, logged)

    def insert(
        self, signal: str, block: "Block | Diagram | ct.InputOutputSystem", readers: str | Iterable[str] | None = None,
        inputs: Sequence[str] = (),
    ) -> "Diagram":  # fmt: skip
        """Return the diagram with a block, or a small diagram, in the path of a signal.

        Without ``readers`` all see the new block, a log included: it drives the signal, and what drove it before goes
        on as ``PV:sensor``.  With ``readers`` (names of blocks), and at an open input, the signal stays what it was,
        and the readers read ``PV:`` and the new block's name.

        The block's labels do not matter if it has one input and one output; of several the one of the signal's name
        lies in the path, the others are wired by name, or left open on purpose with ``inputs``.

        Raises ``WiringError`` for an unknown signal, a block that does not read it, or a path that is not clear.

        >>> from blocks import Gain
        >>> from plant.loops import self_regulating_loop
        >>> biased = self_regulating_loop().insert("PV", Gain("bias", "in", 1.0, offset=0.02))
        >>> biased["bias"].input_labels, biased["bias"].output_labels
        (['PV:process'], ['PV'])
        """
        return cuts.inserted(self, signal, block, readers, inputs)

    def rewire(self, block: str, port: str, signal: str, inputs: Sequence[str] = ()) -> "Diagram":
        """Return the diagram with an input of a block, named by its port or label, reading another signal.

        A signal that nothing drives is left open on purpose with ``inputs``; an open input that no block reads any
        more goes.  Raises ``WiringError`` for an unknown block, port or signal, and for an algebraic loop.

        >>> from plant.loops import self_regulating_loop
        >>> self_regulating_loop().rewire("controller", "PV", "MV")["controller"].input_labels
        ['SP', 'MV']
        """
        return cuts.rewired(self, block, port, signal, inputs)

    def named(self, name: str, **inputs: str) -> "Diagram":
        """Return the diagram under another name, its open inputs relabelled (``SP="SP1"``), for nesting.

        Raises ``WiringError`` for an input that is not open.
        """
        return changes.named(self, name, inputs)

    def leaves(self) -> list[Block]:
        """Return the blocks as they appear inside another diagram: names and signals behind ``name/``."""
        return changes.nested_blocks(self)

    def with_blocks(self, blocks: Sequence[Block]) -> Self:
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
        super()._update_params(own_params(self, params or {}))

    def _update(self, t: float, x: Any, u: Any, params: Any) -> Any:
        self._update_params(params)
        return self._rhs(t, x, u)

    def _output(self, t: float, x: Any, u: Any, params: Any) -> Any:
        self._update_params(params)
        return self._out(t, x, u)


def _all_params(blocks: Iterable[Block]) -> dict[str, float]:
    return {f"{block.name}.{key}": value for block in blocks for key, value in block.params.items()}

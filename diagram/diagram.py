"""A diagram: blocks wired by signal names, a ``control.InterconnectedSystem`` and at the same time a value.

It can be taken apart (``blocks``, ``part``, ``cut``, ``segments``), changed (``with_params``, ``replace``, ``insert``,
``rewire``, ``starting_at``, ``in_mode``) and nested; a change returns a new diagram and leaves the old one as it is.
"""

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Self

import control as ct
from numpy.typing import ArrayLike
from stickslip.blocks.block import Block
from stickslip.diagram import changes, cuts
from stickslip.diagram.cells import MANY
from stickslip.diagram.wired import Wired

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from stickslip.diagram.flatten import Plan
    from stickslip.diagram.segments import Segment
    from stickslip.logs import Log


class Diagram(Wired):
    """Blocks joined by signal names; build one with ``wire``.

    Attributes: ``blocks`` (leaves, in the order given), ``signals`` (all driven signals), ``signal_units``,
    ``input_units``, ``signal_spans`` (of instruments), ``loops`` (controller -> its signals),
    ``driven`` (signal -> (block, port)), ``order`` (signal-flow
    order).  Every kernel is tried once, see ``stickslip.blocks.dry_run``.  As a python-control system its inputs are
    the open inputs, its outputs the declared outputs, and it sees each block's ``seen()`` view.
    """

    _plan: "Plan | None" = None
    _cells: "Plan | None" = None

    def _repr_html_(self) -> str:
        from stickslip.logs.notebook import image

        return image(self.plot())

    # --- look ---------------------------------------------------------------------------------------------
    def plan(self, records: int = 0) -> "Plan":
        """Return how the diagram is laid out for the engine, made once and shared by all that differ only in values.

        ``records``: how many records its dead times have to hold at least.
        """
        from stickslip.diagram.flatten import DELAY_RECORDS, plan

        self._plan = plan(self, max(records, DELAY_RECORDS), self._plan)
        return self._plan

    def plan_in_cells(self, records: int = 0) -> "Plan":
        """Return the plan with the diagram cut into cells that take steps of their own, where that pays."""
        from stickslip.diagram.flatten import DELAY_RECORDS, plan_in_cells

        if len(self.blocks) < MANY:
            return self.plan(records)
        self._cells = plan_in_cells(self, max(records, DELAY_RECORDS), self._cells)
        if not self._cells.links:
            self._plan = self._cells
        return self._cells

    def plot(self, units: Mapping[str, Sequence[str]] | None = None) -> "Figure":
        """Draw the diagram: one box per block, one arrow per signal.

        ``units``: name -> names of the blocks that are drawn as one box, for a diagram that is too large to read.
        Raises ``WiringError`` for a block that is not there.
        """
        from stickslip.diagram.figures.drawing import draw

        return draw(self, units=units)

    # --- change -------------------------------------------------------------------------------------------
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

        >>> from stickslip.plant.loops import self_regulating_loop
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

    def pinned(
        self, log: "Log", signals: Sequence[str] | None = None, fresh: Mapping[str, tuple[float, float]] | None = None
    ) -> "Diagram":
        """Return the diagram held to a log: logged signals are set right at each logged time
        (``stickslip.diagram.pins``).

        ``signals``: those to pin, by default all that the log has too.  Of a sensor's PV, ``PV:sensor`` is then what
        the sensor gives and ``PV:offset`` what the pin adds.  Open inputs that are logged are driven by the log, held
        between samples.  What is missing or marked bad in the log is not pinned there.  ``fresh``: signal -> (period,
        first time) [s] of noise that is drawn anew: its offset ends when the next is drawn, of which no row tells.

        Raises ``WiringError`` if log and diagram share no signal, or for a signal that one of them has not.
        """
        from stickslip.diagram.pinning import pinned

        return pinned(self, log, signals, fresh)

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

        >>> from stickslip.plant.loops import self_regulating_loop
        >>> opened = self_regulating_loop().cut("PV")
        >>> opened.open_inputs, opened.signals
        (('PV',), ('SP', 'OP', 'MV', 'PV:process'))
        """
        return cuts.cut(self, signals)

    def segments(self, logged: str | Iterable[str]) -> "tuple[Segment[Self], ...]":
        """Return the maximal pieces between logged signals: what each reads and drives, and the piece alone.

        Every block is in one segment.  Raises ``WiringError`` for a signal that is unknown.

        >>> from stickslip.plant.loops import self_regulating_loop
        >>> for segment in self_regulating_loop().segments(["SP", "OP", "PV"]):
        ...     print(segment)
        <Segment SP: reads nothing, drives SP>
        <Segment controller: reads SP, PV, drives OP>
        <Segment valve, process: reads OP, drives PV>
        """
        from stickslip.diagram.segments import segments

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

        >>> from stickslip.blocks import Gain
        >>> from stickslip.plant.loops import self_regulating_loop
        >>> biased = self_regulating_loop().insert("PV", Gain("bias", "in", 1.0, offset=0.02))
        >>> biased["bias"].input_labels, biased["bias"].output_labels
        (['PV:process'], ['PV'])
        """
        return cuts.inserted(self, signal, block, readers, inputs)

    def rewire(self, block: str, port: str, signal: str, inputs: Sequence[str] = ()) -> "Diagram":
        """Return the diagram with an input of a block, named by its port or label, reading another signal.

        A signal that nothing drives is left open on purpose with ``inputs``; an open input that no block reads any
        more goes.  Raises ``WiringError`` for an unknown block, port or signal, and for an algebraic loop.

        >>> from stickslip.plant.loops import self_regulating_loop
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

    def _copy(self) -> Self:
        other = super()._copy()
        other._plan, other._cells = self._plan, self._cells
        return other

    def __getstate__(self) -> dict[str, Any]:
        """Leave the plans behind: they hold addresses of compiled code, which are worth nothing in another process."""
        return self.__dict__ | {"_plan": None, "_cells": None}

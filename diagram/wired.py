"""Wired blocks: what a diagram is before anything is asked of it, and what all that changes or reads it goes by.

``Diagram`` adds what users call; the functions behind that (``changes``, ``cuts``, ``flatten``, ...) know only this.
"""

import copy
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, Self, TypeVar

import control as ct
import numpy as np
from numpy.typing import NDArray
from stickslip.blocks.arguments import text, texts
from stickslip.blocks.block import Block
from stickslip.blocks.control_view import NO_APPEND
from stickslip.blocks.dry_run import dry_run
from stickslip.blocks.parameters import Parametrised
from stickslip.blocks.ports import nearest, shortened
from stickslip.diagram.connections import ConnectionMap, own_params
from stickslip.diagram.loops import loops_of
from stickslip.diagram.past import Past
from stickslip.diagram.unseen import warn_of_unseen
from stickslip.diagram.wiring import (
    WiringError,
    check_readers,
    check_units,
    drivers,
    flow_order,
    followed,
    seen_followed,
    spans,
)

D = TypeVar("D", bound="Wired")

_Step = tuple[int, slice, NDArray[np.intp], slice]
UNNAMED = "diagram"  # the name of a diagram to which nobody gave one


class Wired(Parametrised, ct.InterconnectedSystem):  # type: ignore[misc]
    """Blocks joined by signal names, checked; see ``Diagram``, which is the one to use."""

    connect_map = ConnectionMap()
    input_map = ConnectionMap()
    output_map = ConnectionMap()

    def _owner(self) -> str:
        return ""

    def __init__(
        self, blocks: Sequence[Block], inputs: Sequence[str] = (), outputs: Sequence[str] | None = None,
        name: str = UNNAMED,
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
        self.loops = loops_of(self.blocks, self.signal_units)
        self.order = tuple(flow_order(self.blocks, self.driven))
        self.signals = tuple(self.driven)
        self._past: Past | None = None
        self._seen_flow: list[_Step] | None = None
        self._for_slopes = False
        self._shown = False
        seen = [block.seen() for block in self.blocks]
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

    def __str__(self) -> str:
        """List the blocks, one a line, each with its signals: python-control would show the twins that it sees."""
        open_ = f", open inputs {', '.join(self.open_inputs)}" if self.open_inputs else ""
        lines = [
            f"  {type(block).__name__} '{block.name}': {', '.join(block.input_labels) or 'nothing'} -> "
            f"{', '.join(block.output_labels) or 'nothing'}"
            for block in self.blocks
        ]
        return "\n".join([f"Diagram '{self.name}' of {len(self.blocks)} blocks{open_}", *lines])

    def append(self, other: object) -> None:
        """Say what to use in place of ``ct.append``, which stacks linear systems only.

        Raises ``TypeError``, always.
        """
        raise TypeError(f"'{self.name}': {NO_APPEND}")

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

    @property
    def past(self) -> Past | None:
        """What a run that ended here left under way (dead times, samples taken); None if the diagram starts afresh."""
        return self._past

    def with_past(self, past: Past | None) -> Self:
        """Return the diagram going on from a run with this past (``run.final.past``), or starting afresh with None.

        Changed copies keep what still fits: what is in the dead times of blocks of the same name, samples taken.
        """
        other = self._copy()
        other._past = past
        return other

    def with_blocks(self, blocks: Sequence[Block]) -> Self:
        """Return a copy with blocks that differ only in values; wiring and plan are shared.

        A dead time that becomes or ceases to be zero changes the signal flow: then everything is checked afresh.
        """
        seen = [block.seen() for block in blocks]
        same_flow = all(followed(new) == followed(old) for new, old in zip(blocks, self.blocks, strict=True))
        if not same_flow or [b.seen_states() for b in seen] != [b.seen_states() for b in self.syslist]:
            other = type(self)(blocks, self.open_inputs, self.declared_outputs, self.name)
            other._past = self._past
            return other
        other = self._copy()
        other.blocks = tuple(blocks)
        other.syslist, other._seen_flow = seen, None
        other._fix_params(_all_params(seen))
        return other

    def _copy(self) -> Self:
        other = copy.copy(self)
        other.updfcn, other.outfcn = other._update, other._output
        return other

    def _update_params(self, params: Mapping[str, float] | None) -> None:
        """Take the diagram's own parameters; in an interconnection python-control hands over those of others too."""
        if not self._for_slopes:
            warn_of_unseen(self.blocks)
        super()._update_params(own_params(self, params or {}))

    def linearize(self, x0: Any, u0: Any = None, t: float = 0.0, params: Any = None, **keywords: Any) -> ct.StateSpace:
        """Return python-control's linear model (``ct.linearize``), blocks that sample seen as their continuous twins.

        Raises ``WiringError`` for a diagram without open inputs that has one state or one output, of which
        python-control cannot make a model.
        """
        if not self.ninputs and 1 in (self.nstates, self.noutputs):
            raise WiringError(
                f"'{self.name}' has no open inputs, and python-control makes no model of one state or one output "
                f"without inputs; open one, e.g. diagram.cut('{self.signals[0]}'), "
                "or use stickslip.diagram.linear.linearise"
            )
        other = self._copy()
        other.syslist, other._for_slopes, other._seen_flow = [block.twin for block in self.syslist], True, None
        other._fix_params(_all_params(other.syslist))
        return super(Wired, other).linearize(x0, u0, t, params, **keywords)

    def _out(self, t: float, x: Any, u: Any) -> Any:
        """Return the outputs; python-control asks for them when it has simulated, and else for rates."""
        self._shown = True
        try:
            return super()._out(t, x, u)
        finally:
            self._shown = False

    def _compute_static_io(self, t: float, x: Any, u: Any) -> tuple[Any, Any]:
        """Return what all inputs and outputs of the blocks are: each block once, in the order of signal flow.

        Python-control sweeps all blocks until no signal changes.  A signal that is no number never settles so, and was
        called an algebraic loop.  Where continuous twins act at once in a circle it still has to.
        """
        if self._seen_flow is None:
            self._seen_flow = self._flow()
        if not self._seen_flow:
            return super()._compute_static_io(t, x, u)  # type: ignore[no-any-return]
        *steps, (_, _, reads, said) = self._seen_flow
        values = np.zeros(said.stop + 1)
        given = np.ravel(u)[: said.start]
        values[: len(given)] = given
        for b, own, inputs, outputs in steps:
            values[outputs] = np.ravel(self.syslist[b].out_now(t, x[own], values[inputs], self._shown))
        ulist = values[reads]  # those that do not act at once came first
        return ulist, np.concatenate([values[said], ulist])

    def _flow(self) -> list["_Step"]:
        """Return each block in the order of signal flow, with its places in the states and in one array of values.

        The values are the open inputs, then all outputs, then 0 for what nobody gives.  The last step is of the whole
        diagram.  There is none where continuous twins act at once in a circle.
        """
        try:
            order = flow_order(self.syslist, self.driven, seen_followed)
        except WiringError:
            return []
        says = [list(block.output_labels) for block in self.blocks]
        at = {s: k for k, s in enumerate([*self.open_inputs, *(s for labels in says for s in labels)])}
        states = np.cumsum([0, *(block.nstates for block in self.syslist)])
        outputs = np.cumsum([len(self.open_inputs), *map(len, says)])
        reads = [np.array([at.get(s, len(at)) for s in block.input_labels], dtype=np.intp) for block in self.blocks]
        steps = [(b, slice(states[b], states[b + 1]), reads[b], slice(outputs[b], outputs[b + 1])) for b in order]
        whole = slice(0, states[-1]), np.concatenate([np.zeros(0, np.intp), *reads]), slice(outputs[0], outputs[-1])
        return [*steps, (-1, *whole)] if steps else []

    def _update(self, t: float, x: Any, u: Any, params: Any) -> Any:
        self._update_params(params)
        return self._rhs(t, x, u)

    def _output(self, t: float, x: Any, u: Any, params: Any) -> Any:
        self._update_params(params)
        return self._out(t, x, u)


def _all_params(blocks: Iterable[Block]) -> dict[str, float]:
    return {f"{block.name}.{key}": value for block in blocks for key, value in block.params.items()}

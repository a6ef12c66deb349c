"""The block: a python-control nonlinear I/O system made of pure kernels.

A block is data (parameters ``p``, start states ``x0``, modes and memories ``d0``), what it declares of itself
(``declared``) and pure functions (``kernels``).  Python-control calls them interpreted (``control_view``), the engine
compiled.  Nothing is kept inside a block, so a call never changes it; what changes a value returns a changed copy.
"""

import copy
import keyword
import math
from collections.abc import Mapping
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike
from stickslip.blocks.arguments import by_name, checked, text
from stickslip.blocks.control_view import ControlView
from stickslip.blocks.declared import FREE_MODE
from stickslip.blocks.kernels import Floats, Host, Kernel, Kernels
from stickslip.blocks.named_kernels import Names, in_arrays
from stickslip.blocks.ports import BlockError, Labels, check_names, labelled, nearest, number, require, shortened
from stickslip.blocks.role import Role
from stickslip.blocks.stated import check_role, checked_span, checked_tolerances, one_each, start_values

__all__ = ["Block", "Floats", "Host", "Kernel", "Kernels"]


class Block(ControlView):
    """Base of all blocks; see the module docstring.  Subclasses fill in the class data (see ``Declared``) and call
    ``__init__``.

    ``tolerances`` (parameter -> share of its value within which the true one lies; see ``with_tolerances``) travel with
    every copy.

    ``timetable`` (rows, 1 + values): times [s], strictly increasing, and the values in force from each time on, of the
    first row also before.  Kernels read the values in force behind the parameters in ``p``; nothing else of the table
    is copied, however many runs read it.  A block with a timetable and a kernel ``step`` takes a sample at each time.
    """

    def __setattr__(self, key: str, value: Any) -> None:
        """Set an attribute; an array becomes a read-only copy of its own.

        What is written into it later would change the runs of every diagram with this block, past the checks of
        ``with_params`` and ``starting_at``, while ``params`` says otherwise.
        """
        if isinstance(value, np.ndarray) and value.flags.writeable:
            value = value.copy()
            value.flags.writeable = False
        super().__setattr__(key, value)

    def __init_subclass__(cls, **keywords: Any) -> None:
        super().__init_subclass__(**keywords)
        if "__init__" in cls.__dict__:
            setattr(cls, "__init__", checked(cls.__dict__["__init__"]))  # noqa: B010 - a method cannot be assigned

    def __init__(
        self,
        *,
        name: str,
        params: Mapping[str, float],
        states: Mapping[str, float] | None = None,
        memory: Mapping[str, float] | None = None,
        start_output: ArrayLike | None = None,
        table: ArrayLike = (),
        timetable: Floats | None = None,
        inputs: Labels = None,
        outputs: Labels = None,
        units: Mapping[str, str] | None = None,
        spans: Mapping[str, tuple[float, float]] | None = None,
    ) -> None:
        text(type(self).__name__, "name", name)
        by_name(name, "units", units or {}, {"PV": "bar"})
        by_name(name, "spans", spans or {}, {"PV": (0.0, 1.0)})
        states, memory = dict(states or {}), dict(memory or {})
        check_names(name, self.ports_in, self.ports_out, [*states, *memory])
        self.param_names = tuple(params)
        self.state_names = tuple(states)
        self.memory_names = tuple(memory)
        named = np.array([number(name, key, value) for key, value in params.items()], dtype=float)
        self.timetable = None if timetable is None else np.ascontiguousarray(timetable, dtype=float)
        row: ArrayLike = [] if self.timetable is None else self.timetable[0, 1:]
        self.p: Floats = np.concatenate([named, np.asarray(table, dtype=float).ravel(), np.asarray(row)])
        self.y0: Floats = (
            np.zeros(len(self.ports_out)) if start_output is None else one_each(start_output, self.ports_out, name)
        )
        self.units: dict[str, str] = {port.name: port.unit for port in (*self.ports_in, *self.ports_out)}
        for key, unit in (units or {}).items():
            if key not in self.units:
                raise BlockError(f"block '{name}' has no port '{key}'; {nearest(key, list(self.units))}")
            self.units[key] = text(name, f"unit of {key}", unit)
        self.check(dict(zip(self.param_names, named.tolist(), strict=True)), name)
        self.spans = {key: checked_span(name, key, span, self.units) for key, span in (spans or {}).items()}
        for key, value in (*states.items(), *memory.items()):
            rule = math.isfinite(number(name, key, value))
            require(rule, name, key, value, "it must start at a finite number", "give one as start")
        self.x0: Floats = np.array(list(states.values()), dtype=float)
        self.d0: Floats = np.array(list(memory.values()), dtype=float)
        self._p_now = self.p
        self._make_kernels(name)
        super().__init__(
            self._update,
            self._output,
            inputs=labelled(name, "input", self.ports_in, inputs),
            outputs=labelled(name, "output", self.ports_out, outputs),
            states=list(self.seen_states()),
            dt=self.period if self.sampled else 0,
            name=name,
        )
        self._fix_params(dict(zip(self.param_names, named.tolist(), strict=True)))

    def _make_kernels(self, name: str) -> None:
        """Let kernels that are written with names read the arrays in which the names have their places."""
        inputs = tuple(port.name + "_" * keyword.iskeyword(port.name) for port in self.ports_in)  # "in" is "in_"
        outputs = tuple(port.name for port in self.ports_out)
        names = Names(self.state_names, self.memory_names, inputs, self.param_names, outputs)
        start = np.concatenate([self.x0, self.d0, self.p[: len(self.param_names)]]).tolist()
        keys = (*self.state_names, *self.memory_names, *self.param_names)
        made = in_arrays(self.kernels, name, names, dict(zip(keys, start, strict=True)))
        if made is not self.kernels:
            self._written, self.kernels = self.kernels, made

    def __getstate__(self) -> dict[str, Any]:
        """Leave out kernels that were made from functions of names: they are made again from them."""
        state = {key: value for key, value in self.__dict__.items() if key != "_smoothed"}
        if "_written" in state:
            state["kernels"] = state.pop("_written")
            if state["kernels"] is type(self).kernels:
                del state["kernels"]
        return state

    def __setstate__(self, state: dict[str, Any]) -> None:
        for key, value in state.items():  # one by one: arrays come back writeable
            setattr(self, key, value)
        self._make_kernels(self.name)

    def __copy__(self) -> Self:
        other = type(self).__new__(type(self))
        other.__dict__.update(self.__dict__)
        return other

    def __repr__(self) -> str:
        ports = f"{', '.join(self.input_labels)} -> {', '.join(self.output_labels)}"
        values = [f"{key} = {value:g}" for key, value in zip(self.param_names, self.p.tolist(), strict=False)]
        return shortened(f"<{type(self).__name__} '{self.name}': {ports}; {', '.join(values)}>")

    def going_by(self, p: Floats) -> Self:
        """Return a copy that goes by the parameters ``p`` until python-control gives others."""
        other = self._copy()
        other._p_now = p
        return other

    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` unless the parameters make sense together."""

    def trouble(self) -> str:
        """Return why the block's equations end at its start values, with the numbers; "" if they do not."""
        return ""

    def settled(self, u: Floats, y: Floats) -> Self:
        """Return the block as it is when ``u`` has entered for long and it gives ``y``, if its memory can be told."""
        return self

    def smooth(self) -> "Block":
        """Return the continuous block of which slopes are taken (its own continuous limit).

        A sampled block that names no better twin is seen taking its samples.
        """
        return SampledView(self) if self.sampled else self

    def seen(self) -> "Block":
        """Return what python-control simulates in a diagram: the continuous twin, or the samples if that has no state.

        A source stays what its twin is: random numbers would be jumps that a solver has to find.
        """
        first: Block | None = self._smoothed
        if first is None:
            twin = self.smooth()
            samples = self.takes_samples and not twin.seen_states() and bool(twin.ports_in)
            first = SampledView(self, twin) if samples else twin
            self._smoothed = None if first is self else first
        shared = first is self or not (first.samples_kept or first.remembers)
        return first if shared else first.with_params()  # a copy: what keeps a past stands in one diagram

    def unseen(self) -> str:
        """Return what python-control's simulator does not see of the block, "" if it sees all of it."""
        seen = self.seen()
        return f"the samples, but a continuous {type(seen).__name__}," if self.sampled and not seen.samples_kept else ""

    def with_role(self, role: str, **plays: str) -> Self:
        """Return a copy with another role, for a general block: which port is ``SP``, ``PV``, ``OP`` or ``MV``.

        Roles: source, disturbance, controller, valve, process, sensor, filter, historian, detector, arithmetic
        (``stickslip.blocks.role`` says what each does).  Effects of a gap go by them: a controller has SP, PV and OP;
        a valve that reads more than OP, or gives more than MV, says which these are.

        Raises ``BlockError`` for a role that is none of ``Role``, a part that is none, or a port that is not there.

        >>> from stickslip.blocks import Equations
        >>> law = Equations("PC", out=lambda r, y: 2.0 * (r - y), inputs=["r", "y"], outputs="u")
        >>> law.with_role("controller", SP="r", PV="y", OP="u").loop_signal("PV")
        'y'
        """
        check_role(self, role, plays)
        other = self._copy()
        other.role, other.plays = Role(role), {**self.plays, **plays}
        return other

    def without_friction(self) -> Self:
        """Return a copy in the mode "ideal" if the block has one, else the block itself."""
        return self.in_mode(FREE_MODE) if FREE_MODE in self.modes else self

    def as_it_starts(self) -> "Block":
        """Return a copy to take slopes of: a stem keeps the mode in which it starts, whatever pulls at it."""
        other = self._copy()
        other.keeps_mode = True
        return other

    def with_params(self, **changes: float) -> Self:
        """Return a copy with other parameter values.

        Raises ``BlockError`` for an unknown name or a value that breaks the block's rules.
        """
        p = self.p.copy()
        for key, value in changes.items():
            p[self.param_index(key)] = number(self.name, key, value)
        other = self._copy()
        other.p = other._p_now = p
        other._fix_params(dict(zip(self.param_names, p.tolist(), strict=False)))
        other.check(other.params, self.name)
        if self.sampled:
            other.dt = other.period
        return other

    def with_tolerances(self, **shares: float) -> Self:
        """Return a copy that says how well its parameters are known: ``K=0.05`` for within 5 % of the value.

        A share of 0 takes a tolerance away.  Raises ``BlockError`` for an unknown parameter, a share that is not from 0
        to below 1, or a parameter that is 0 or infinite, of which there is no share.

        >>> from stickslip.blocks import FirstOrder
        >>> FirstOrder(K=3.0, tau=10.0).with_tolerances(K=0.05).relabelled("a", ["u"], ["y"]).tolerances
        {'K': 0.05}
        """
        given = checked_tolerances(self, shares)
        other = self._copy()
        other.tolerances = {key: share for key, share in {**self.tolerances, **given}.items() if share > 0.0}
        return other

    def in_mode(self, mode: str) -> Self:
        """Return a copy that starts (and, for python-control, stays) in the named mode.

        Raises ``BlockError`` with the nearest mode if there is none of that name.
        """
        if mode not in self.modes:
            raise BlockError(f"block '{self.name}' has no mode '{mode}'; {nearest(mode, list(self.modes))}")
        other = self._copy()
        memory = self.d0.copy()
        memory[0] = self.modes[mode]
        other.d0 = memory
        return other

    def starting_at(self, **values: float) -> Self:
        """Return a copy with other start values of states or memories.

        Raises ``BlockError`` for an unknown name, a value that is no number, or a mode that is none of ``modes``.
        """
        other = self._copy()
        other.x0, other.d0 = start_values(self, values)
        return other

    def holding(self, outputs: ArrayLike) -> Self:
        """Return a copy of a sampled block whose outputs stand at ``outputs`` until its first sample.

        Raises ``BlockError`` unless there is one value per output.
        """
        other = self._copy()
        other.y0 = one_each(outputs, self.ports_out, self.name)
        return other

    def relabelled(self, name: str, inputs: list[str], outputs: list[str]) -> Self:
        """Return a copy under another name with other port labels (what nesting does).

        Raises ``BlockError`` for labels too many or too few, or one given twice.
        """
        other = self._copy()
        other.name = name
        other._fix_params(self.params)
        other.set_inputs(labelled(name, "input", self.ports_in, inputs))
        other.set_outputs(labelled(name, "output", self.ports_out, outputs))
        return other

    def with_units(self, units: Mapping[str, str]) -> Self:
        """Return a copy whose ports state these units, given as ``{"PV": "bar"}``; "" fits every unit.

        Raises ``BlockError`` for a port that is not there.
        """
        for key in units:
            if key not in self.units:
                raise BlockError(f"block '{self.name}' has no port '{key}'; {nearest(key, list(self.units))}")
        other = self._copy()
        other.units = {**self.units, **units}
        return other

    def _copy(self) -> Self:
        other = copy.copy(self)
        other.updfcn, other.outfcn = other._update, other._output
        other.samples = other.seen_modes = other._smoothed = None
        return other


class SampledView(Block):
    """A sampled ``block`` in a continuous diagram of python-control; it takes samples at the solver's own steps.

    See ``seen_samples``.  NaN counts as 0.  ``twin`` is the continuous block that gives the slopes.
    """

    def __init__(self, block: Block, twin: Block | None = None) -> None:
        self.block, self._twin = block, twin or self
        self.role, self.plays = block.role, block.plays
        self.ports_in, self.ports_out = block.ports_in, block.ports_out
        self.kernels = Kernels(feeds=block.kernels.feeds)
        super().__init__(
            name=block.name, params=block.params, start_output=block.y0, timetable=block.timetable, units=block.units,
            inputs=list(block.input_labels), outputs=list(block.output_labels), spans=block.spans,
        )  # fmt: skip
        self.p = self._p_now = block.p  # with the tables behind the parameters
        self._taking = block.going_by(block.p)

    def _copy(self) -> Self:
        other = super()._copy()
        other._taking = self.block.going_by(self.block.p)
        if self._twin.samples_kept:
            other._twin = other if self._twin is self else self._twin.with_params()
        return other

    @property
    def twin(self) -> Block:
        """The block from which python-control takes slopes."""
        return self._twin

    @property
    def samples_kept(self) -> bool:
        """Whether the view takes samples: always."""
        return True

    def as_it_starts(self) -> Block:
        """Return what slopes are taken of."""
        return self._twin

    def _update_params(self, params: Mapping[str, float] | None) -> None:
        super()._update_params(params)
        self._taking = self.block.going_by(self._p_now)

    def _out(self, t: float, x: Floats, u: Floats) -> Floats:
        return self._taking.out_after_samples(t, u)

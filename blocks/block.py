"""The block: a python-control nonlinear I/O system made of pure kernels.

A block is data (parameters ``p``, start states ``x0``, modes and memories ``d0``) plus kernels, plain functions
of one shape ``(t, x, d, u, p, out)`` that read arrays and write ``out``:

    out        outputs y(t, x, u)                  der   state rates dx/dt
    zc         event functions, fire when > 0      jump  the transition of event ``out[0]``: changes d and x
    step       one sample: changes d, writes y     next_time  next discontinuity of a source, largest step

Python-control calls them interpreted (``updfcn``, ``outfcn``); the engine calls the same functions compiled.
Nothing is kept inside a block, so a call never changes it.
"""

import copy
import math
import warnings
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol, Self

import control as ct
import numpy as np
from numpy.typing import ArrayLike, NDArray

from blocks.arguments import by_name, checked, text
from blocks.parameters import Parametrised
from blocks.ports import BlockError, Labels, Port, check_names, labelled, nearest, number, require, shortened
from blocks.role import Role

Floats = NDArray[np.float64]
NO_APPEND = (
    "ct.append stacks linear systems only; use diagram.wire([...], inputs=[...]), or ct.interconnect([...], "
    "inplist=..., outlist=...), or give ct.append its linearisation, ct.linearize(system, x0, u0)"
)
STUCK_MODE, FREE_MODE = "stuck", "ideal"  # the names that these two modes of a valve have in every block
PARTS = ("SP", "PV", "OP", "MV")
Kernel = Callable[[float, Any, Any, Any, Any, Any], None]


@dataclass(frozen=True)
class Kernels:
    """The functions of a block and what the engine must know about them.

    ``n_events``: how many event functions ``zc`` writes.  ``feeds``: whether outputs depend on inputs at the
    same instant.  ``timed``: whether ``out`` or ``der`` reads the time ``t``.  ``rates``: whether ``zc`` and ``jump``
    want the input rates behind the inputs in ``u``; ``rate_modes``: the modes, whole numbers, in which ``zc`` looks at
    them (none named: in all).  ``jumps``: whether outputs jump when an event fires, as a stem without mass does when
    it slips.  ``linear``: whether ``out`` and ``der`` are affine in states, inputs and time, in each mode, while no
    event function is positive and between the instants of ``next_time``; such blocks run faster.
    """

    out: Kernel | None = None
    der: Kernel | None = None
    zc: Kernel | None = None
    jump: Kernel | None = None
    step: Kernel | None = None
    next_time: Kernel | None = None
    n_events: int = 0
    feeds: bool = True
    rates: bool = False
    rate_modes: tuple[float, ...] = ()
    timed: bool = False
    jumps: bool = False
    linear: bool = False


class Host(Protocol):
    """What a sampled block runs in Python, between two calls of the engine: a filter, a detector.

    The state is any value; it goes in and comes out, so the block itself never changes.
    """

    def init(self, p: Floats) -> Any:
        """Return the state before the first sample."""

    def step(self, t: float, state: Any, u: Floats, p: Floats) -> tuple[Any, Sequence[float]]:
        """Take the sample ``u`` at time ``t`` [s]; return the next state and the outputs to hold."""


class Block(Parametrised, ct.NonlinearIOSystem):  # type: ignore[misc]
    """Base of all blocks; see the module docstring.  Subclasses fill in the class data and call ``__init__``.

    Class data: ``role``, ``ports_in``, ``ports_out``, ``kernels``, ``modes`` (name -> value of ``d[0]``),
    ``period_param`` and ``offset_param`` (sampled blocks), ``dead_time_param`` (delays all inputs in the engine) and
    ``before_param`` (what they were before the start), ``limit_params`` (low and high end of the output),
    ``plays`` (part in a loop -> port that plays it, where the port has another name; see ``loop_signal``).

    ``timetable`` (rows, 1 + values): times [s], strictly increasing, and the values in force from each time on, of the
    first row also before.  Kernels read the values in force behind the parameters in ``p``; nothing else of the table
    is copied, however many runs read it.  A block with a timetable and a kernel ``step`` takes a sample at each time.
    """

    role: Role = Role.PROCESS
    plays: Mapping[str, str] = {}
    ports_in: tuple[Port, ...] = ()
    ports_out: tuple[Port, ...] = ()
    kernels: Kernels = Kernels()
    modes: Mapping[str, float] = {}
    period_param: str | None = None
    offset_param: str | None = None
    dead_time_param: str | None = None
    before_param: str | None = None
    limit_params: tuple[str, str] | None = None
    host: "Host | None" = None

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
            np.zeros(len(self.ports_out)) if start_output is None else self._checked_outputs(start_output, name)
        )
        self.units: dict[str, str] = {port.name: port.unit for port in (*self.ports_in, *self.ports_out)}
        for key, unit in (units or {}).items():
            if key not in self.units:
                raise BlockError(f"block '{name}' has no port '{key}'; {nearest(key, list(self.units))}")
            self.units[key] = text(name, f"unit of {key}", unit)
        self.check(dict(zip(self.param_names, named.tolist(), strict=True)), name)
        self.spans: dict[str, tuple[float, float]] = {
            key: self._span(name, key, span) for key, span in (spans or {}).items()
        }
        for key, value in (*states.items(), *memory.items()):
            rule = math.isfinite(number(name, key, value))
            require(rule, name, key, value, "it must start at a finite number", "give one as start")
        self.x0: Floats = np.array(list(states.values()), dtype=float)
        self.d0: Floats = np.array(list(memory.values()), dtype=float)
        self._p_now = self.p
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

    def _owner(self) -> str:
        return str(self.name)

    def _span(self, name: str, key: str, span: Any) -> tuple[float, float]:
        """Return low and high end of an instrument's span, refusing what is none."""
        if key not in self.units:
            raise BlockError(f"block '{name}' has no port '{key}'; {nearest(key, list(self.units))}")
        ends = [number(name, f"span of {key}", end) for end in np.ravel(span).tolist()]
        rule = len(ends) == 2 and ends[0] < ends[1]
        require(rule, name, f"span of {key}", span, "it is a low and a higher end", "give e.g. (0.0, 1.0)")
        return ends[0], ends[1]

    def __repr__(self) -> str:
        ports = f"{', '.join(self.input_labels)} -> {', '.join(self.output_labels)}"
        values = zip(self.param_names, self.p.tolist(), strict=False)
        return shortened(f"<{type(self).__name__} '{self.name}': {'; '.join([ports, _listed(values)])}>")

    def _repr_html_(self) -> None:
        """Leave it to ``repr``: python-control would show matrices."""

    def append(self, other: object) -> None:
        """Say what to use in place of ``ct.append``, which stacks linear systems only.

        Raises ``TypeError``, always.
        """
        raise TypeError(f"'{self.name}': {NO_APPEND}")

    # --- what subclasses may refine -----------------------------------------------------------------------
    @staticmethod
    def check(params: Mapping[str, float], name: str) -> None:
        """Raise ``BlockError`` unless the parameters make sense together."""

    def trouble(self) -> str:
        """Return why the block's equations end at its start values, with the numbers; "" if they do not."""
        return ""

    def smooth(self) -> "Block":
        """Return the continuous block that python-control sees in a diagram (its own continuous limit).

        A sampled block that names no better twin is seen holding its start output.
        """
        return Held(self) if self.sampled else self

    def seen_states(self) -> tuple[str, ...]:
        """Return the names of the states that python-control sees."""
        return self.memory_names if self.sampled else self.state_names

    def seen_start(self) -> Floats:
        """Return the start values of the states that python-control sees."""
        if self.host is not None:
            return np.zeros(0)
        return self.d0 if self.sampled else self.x0

    def seen_memory(self, x: Floats, u: Floats) -> Floats:
        """Return the modes and memories that python-control sees while the states are ``x`` and the inputs ``u``.

        Python-control knows no events: unless a block says otherwise it stays as it starts.
        """
        return self.d0

    # --- facts --------------------------------------------------------------------------------------------
    @property
    def sampled(self) -> bool:
        """Whether the block runs at its own sampling instants."""
        return self.period_param is not None

    @property
    def takes_samples(self) -> bool:
        """Whether the block does something at sampling instants, be they periodic or listed in its timetable."""
        return self.sampled or (self.timetable is not None and self.kernels.step is not None)

    @property
    def period(self) -> float:
        """Sampling period [s]; 0 for a continuous block."""
        return float(self.p[self.param_names.index(self.period_param)]) if self.period_param else 0.0

    @property
    def dead_time(self) -> float:
        """Dead time of all inputs [s]; 0 if there is none."""
        return float(self.p[self.param_names.index(self.dead_time_param)]) if self.dead_time_param else 0.0

    @property
    def value_before(self) -> float:
        """What stood at the inputs before the start, for the dead time to let out; 0 unless a parameter says."""
        return float(self.p[self.param_names.index(self.before_param)]) if self.before_param else 0.0

    @property
    def limits(self) -> tuple[float, float]:
        """Low and high end of the output in its unit, infinite where there is none."""
        if self.limit_params is None:
            return -math.inf, math.inf
        low, high = (float(self.p[self.param_names.index(key)]) for key in self.limit_params)
        return low, high

    def loop_signal(self, part: str) -> str | None:
        """Return the signal at the port that plays ``part`` in a loop (SP, PV, OP or MV), None if no port does.

        A port plays the part it is named after, unless the block's ``plays`` says that another does.

        >>> from blocks import AntiSurge, PI
        >>> PI(1.0, 10.0, inputs=["level_SP", "level"]).loop_signal("PV"), AntiSurge().loop_signal("PV")
        ('level', 'q')
        """
        wanted = self.plays.get(part, part)
        ports = zip((*self.ports_in, *self.ports_out), (*self.input_labels, *self.output_labels), strict=True)
        return next((str(label) for port, label in ports if port.name == wanted), None)

    @property
    def can_stick(self) -> bool:
        """Whether the block is a valve with a mode in which its stem is stuck."""
        return self.role is Role.VALVE and STUCK_MODE in self.modes

    @property
    def mode(self) -> str | None:
        """Name of the present mode, if the block has modes."""
        return next((m for m, value in self.modes.items() if self.d0[0] == value), None) if self.modes else None

    # --- changed copies -----------------------------------------------------------------------------------
    def with_role(self, role: str, **plays: str) -> Self:
        """Return a copy with another role, for a general block: which port is ``SP``, ``PV``, ``OP`` or ``MV``.

        Raises ``BlockError`` for a role that is none of ``Role``, a part that is none, or a port that is not there.

        >>> from blocks import Equations
        >>> law = Equations("PC", out=lambda r, y: 2.0 * (r - y), inputs=["r", "y"], outputs="u")
        >>> law.with_role("controller", SP="r", PV="y", OP="u").loop_signal("PV")
        'y'
        """
        roles = [str(known) for known in Role]
        if role not in roles:
            raise BlockError(f"{self.name}: role = {role!r} is none; {nearest(role, roles)}")
        ports = [port.name for port in (*self.ports_in, *self.ports_out)]
        for part, port in plays.items():
            if part not in PARTS:
                raise BlockError(f"{self.name}: '{part}' is no part in a loop; {nearest(part, PARTS)}")
            if port not in ports:
                raise BlockError(f"block '{self.name}' has no port '{port}'; {nearest(port, ports)}")
        other = self._copy()
        other.role, other.plays = Role(role), {**self.plays, **plays}
        return other

    def without_friction(self) -> Self:
        """Return a copy in the mode "ideal" if the block has one, else the block itself."""
        return self.in_mode(FREE_MODE) if FREE_MODE in self.modes else self

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

    def in_mode(self, mode: str) -> Self:
        """Return a copy that starts (and, for python-control, stays) in the named mode.

        Raises ``BlockError`` with the nearest mode if there is none of that name.
        """
        if mode not in self.modes:
            raise BlockError(f"block '{self.name}' has no mode '{mode}'; {nearest(mode, list(self.modes))}")
        other = self._copy()
        other.d0 = self.d0.copy()
        other.d0[0] = self.modes[mode]
        return other

    def starting_at(self, **values: float) -> Self:
        """Return a copy with other start values of states or memories.

        Raises ``BlockError`` for an unknown name, a value that is no number, or a mode that is none of ``modes``.
        """
        if self.modes and "mode" in values and values["mode"] not in self.modes.values():
            modes = ", ".join(f"{value:g} ({name})" for name, value in self.modes.items())
            raise BlockError(f"{self.name}: mode = {values['mode']!r}, but the modes are {modes}; give one of them")
        other = self._copy()
        other.x0, other.d0 = self.x0.copy(), self.d0.copy()
        for key, value in values.items():
            if key in self.state_names:
                other.x0[self.state_names.index(key)] = number(self.name, key, value)
            elif key in self.memory_names:
                other.d0[self.memory_names.index(key)] = number(self.name, key, value)
            else:
                known = [*self.state_names, *self.memory_names]
                raise BlockError(f"block '{self.name}' has no state '{key}'; {nearest(key, known)}")
        return other

    def holding(self, outputs: ArrayLike) -> Self:
        """Return a copy of a sampled block whose outputs stand at ``outputs`` until its first sample.

        Raises ``BlockError`` unless there is one value per output.
        """
        other = self._copy()
        other.y0 = self._checked_outputs(outputs, self.name)
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

    def _checked_outputs(self, given: ArrayLike, name: str) -> Floats:
        outputs = np.array([number(name, "output held", value) for value in np.ravel(given).tolist()])
        rule, n = len(outputs) == len(self.ports_out), len(self.ports_out)
        require(rule, name, "start_output", outputs.tolist(), f"the block has {n} outputs", "give one value per output")
        return outputs

    def _copy(self) -> Self:
        other = copy.copy(self)
        other.updfcn, other.outfcn = other._update, other._output
        return other

    def param_index(self, key: str) -> int:
        """Return where a parameter stands in ``p``; raise ``BlockError`` with the nearest name if it does not."""
        if key not in self.param_names:
            known = list(self.param_names)
            raise BlockError(f"block '{self.name}' has no parameter '{key}'; {nearest(key, known)}")
        return self.param_names.index(key)

    # --- python-control -----------------------------------------------------------------------------------
    def _update_params(self, params: Mapping[str, float] | None) -> None:
        """Take parameters as ``block.name``, and by their own name where no other system can mean them.

        Python-control hands every system of an interconnection the parameters of all: others' are not ours, even
        where they are called alike.
        """
        given, prefix = params or {}, self.params.prefix
        joined = all(prefix + key in given for key in self.param_names)
        p = self.p.copy()
        for key, value in given.items():
            if key.startswith(prefix):
                p[self.param_index(key.removeprefix(prefix))] = value
            elif not joined:
                p[self.param_index(key)] = value
            elif key in self.param_names:
                warnings.warn(
                    f"parameter '{key}' of an interconnection is not taken by block '{self.name}', because every "
                    f"system has its own; to change the block's write '{prefix}{key}'",
                    stacklevel=2,
                )
        self._p_now = p

    def _rhs(self, t: float, x: Floats, u: Floats) -> Floats:
        if self.sampled:
            after = np.array(x, dtype=float)
            self._sample(t, after, u)
            return after
        rates = np.zeros(len(self.x0))
        if self.kernels.der is not None:
            self.kernels.der(t, x, self.seen_memory(x, u), u, self._p_at(t), rates)
        return rates

    def _out(self, t: float, x: Floats, u: Floats) -> Floats:
        if self.sampled:
            return self._sample(t, np.array(x, dtype=float), u)
        y = np.zeros(len(self.ports_out))
        if self.kernels.out is not None:
            self.kernels.out(t, x, self.seen_memory(x, u), u, self._p_at(t), y)
        return y

    def _p_at(self, t: float) -> Floats:
        """Return parameters and, behind them, the values of the timetable that are in force at ``t`` [s]."""
        if self.timetable is None:
            return self._p_now
        passed = int(np.searchsorted(self.timetable[:, 0], t, side="right"))
        p = self._p_now.copy()
        p[len(p) - self.timetable.shape[1] + 1 :] = self.timetable[max(0, passed - 1), 1:]
        return p

    def _sample(self, t: float, memory: Floats, u: Floats) -> Floats:
        if self.host is not None:
            return np.asarray(self.host.step(t, self.host.init(self._p_now), u, self._p_now)[1], dtype=float)
        y = np.zeros(len(self.ports_out))
        if self.kernels.step is not None:
            self.kernels.step(t, self.x0, memory, u, self._p_now, y)
        return y

    def _update(self, t: float, x: Floats, u: Floats, params: Mapping[str, float]) -> Floats:
        self._update_params(params)
        return self._rhs(t, x, u)

    def _output(self, t: float, x: Floats, u: Floats, params: Mapping[str, float]) -> Floats:
        self._update_params(params)
        return self._out(t, x, u)


def _listed(values: Iterable[tuple[str, float]]) -> str:
    return ", ".join(f"{key} = {value:g}" for key, value in values)


class Held(Block):
    """What python-control sees of a sampled block without a continuous twin: its start output, standing still."""

    def __init__(self, block: Block) -> None:
        self.ports_in, self.ports_out = block.ports_in, block.ports_out
        self.role, self.plays = block.role, block.plays
        super().__init__(
            name=block.name,
            params={},
            start_output=block.y0,
            inputs=list(block.input_labels),
            outputs=list(block.output_labels),
        )

    def _out(self, t: float, x: Floats, u: Floats) -> Floats:
        return self.y0

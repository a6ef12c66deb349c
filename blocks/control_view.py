"""A block as python-control sees it: a nonlinear I/O system whose functions run the kernels in plain Python."""

import copy
import math
import warnings
from collections.abc import Mapping, Sequence
from typing import Any

import control as ct
import numpy as np
from stickslip.blocks.declared import Declared
from stickslip.blocks.kernels import Floats
from stickslip.blocks.parameters import Parametrised
from stickslip.blocks.seen_modes import Call, SeenModes
from stickslip.blocks.seen_samples import EARLY, SeenSamples

NO_APPEND = (
    "ct.append stacks linear systems only; use stickslip.diagram.wire([...], inputs=[...]), or ct.interconnect([...], "
    "inplist=..., outlist=...), or give ct.append its linearisation, ct.linearize(system, x0, u0)"
)


class ControlView(Declared, Parametrised, ct.NonlinearIOSystem):  # type: ignore[misc]
    """A block as python-control calls it (``updfcn``, ``outfcn``): a call never changes what the next one gives.

    Python-control knows no events: a block is seen in the mode that ``seen_memory`` gives, or ``seen_after``, where it
    depends on the mode before (``remembers``).  A sampled block alone is a discrete-time system with its memories as
    states.  One that runs in Python has a state that is no number: it keeps the samples of the present response
    (``seen_samples``).  Modes and samples are forgotten when python-control begins anew.
    """

    state_names: tuple[str, ...]
    memory_names: tuple[str, ...]
    x0: Floats
    y0: Floats
    _p_now: Floats
    _given_names: tuple[str, ...] = ()  # what python-control gave last, whose it is, and where it goes
    _own_given: Sequence[tuple[str, int]] = ()
    _others_given: Sequence[str] = ()
    keeps_mode = False  # of a stem, when slopes are taken of it
    remembers = False  # whether the modes depend on what they were
    samples: SeenSamples | None = None
    seen_modes: SeenModes | None = None
    _smoothed: Any = None  # what python-control simulates in its place, once a diagram has asked

    def _owner(self) -> str:
        return str(self.name)

    def _repr_html_(self) -> None:
        """Leave it to ``repr``: python-control would show matrices."""

    def append(self, other: object) -> None:
        """Say what to use in place of ``ct.append``, which stacks linear systems only.

        Raises ``TypeError``, always.
        """
        raise TypeError(f"'{self.name}': {NO_APPEND}")

    def seen_states(self) -> tuple[str, ...]:
        """Return the names of the states that python-control sees."""
        if self.host is not None:
            return ()
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

    def seen_after(self, before: Call | None, x: Floats, u: Floats) -> Floats:
        """Return the same for a block that ``remembers``, after the call ``before`` if the response has had one."""
        return self.seen_memory(x, u)

    def _memory(self, t: float, x: Floats, u: Floats) -> Floats:
        """Return the modes and memories that python-control sees at ``t`` [s]."""
        if not self.remembers:
            return self.seen_memory(x, u)
        if self.seen_modes is None:
            self.seen_modes = SeenModes()
        return self.seen_modes.at(self, t, x, u)

    @property
    def twin(self) -> "ControlView":
        """The system from which python-control takes slopes: this view itself, unless it takes samples."""
        return self

    @property
    def samples_kept(self) -> bool:
        """Whether the view takes samples and keeps them, for python-control has no place for them."""
        return self.host is not None

    def out_now(self, t: float, x: Floats, u: Floats, shown: bool = False) -> Floats:
        """Return the outputs with the parameters that python-control gave last; ``shown``: of a response it has."""
        memory = self.seen_modes.shown(t) if shown and self.seen_modes is not None else None
        return self._out(t, x, u) if memory is None else self.out_with(t, x, u, memory)

    def out_with(self, t: float, x: Floats, u: Floats, memory: Floats) -> Floats:
        """Return the outputs of a continuous block in these modes and memories."""
        y = np.zeros(len(self.ports_out))
        if self.kernels.out is not None:
            self.kernels.out(t, x, memory, u, self._p_at(t), y)
        return y

    def _update_params(self, params: Mapping[str, float] | None) -> None:
        """Take parameters as ``block.name``, and by their own name where no other system can mean them.

        Python-control hands every system of an interconnection the parameters of all: others' are not ours, even
        where they are called alike.
        """
        given = params or {}
        if (names := (self.params.prefix, *given)) != self._given_names:  # mostly the same again, many thousand times
            self._given_names, self._own_given, self._others_given = names, *self._own_of(given)
        p = self.p.copy()
        for key, place in self._own_given:
            p[place] = given[key]
        for key in self._others_given:
            warnings.warn(
                f"parameter '{key}' of an interconnection is not taken by block '{self.name}', because every "
                f"system has its own; to change the block's write '{names[0]}{key}'",
                stacklevel=2,
            )
        self._p_now = p
        self.samples = self.seen_modes = None

    def _own_of(self, given: Mapping[str, float]) -> tuple[list[tuple[str, int]], list[str]]:
        """Return the keys that are parameters of this block, with their places, and those that only seem to be."""
        prefix, own, others = self.params.prefix, [], []
        joined = all(prefix + key in given for key in self.param_names)
        for key in given:
            if key.startswith(prefix) or not joined:
                own.append((key, self.param_index(key.removeprefix(prefix))))
            elif key in self.param_names:
                others.append(key)
        return own, others

    def _rhs(self, t: float, x: Floats, u: Floats) -> Floats:
        if self.host is not None:
            return np.zeros(0)
        if self.sampled:
            return np.asarray(self.take(t, x, u)[0], dtype=float)
        rates = np.zeros(len(self.x0))
        if self.kernels.der is not None:
            self.kernels.der(t, x, self._memory(t, x, u), u, self._p_at(t), rates)
        return rates

    def _out(self, t: float, x: Floats, u: Floats) -> Floats:
        if self.host is not None:
            return self.out_after_samples(t, u)
        if self.sampled:
            return self.take(t, x, u)[1]
        return self.out_with(t, x, u, self._memory(t, x, u))

    def _p_at(self, t: float) -> Floats:
        """Return parameters and, behind them, the values of the timetable that are in force at ``t`` [s]."""
        if self.timetable is None:
            return self._p_now
        passed = int(np.searchsorted(self.timetable[:, 0], t, side="right"))
        p = self._p_now.copy()
        p[len(p) - self.timetable.shape[1] + 1 :] = self.timetable[max(0, passed - 1), 1:]
        return p

    def out_after_samples(self, t: float, u: Floats) -> Floats:
        """Return the outputs at ``t`` [s] after the samples of the present response; what is no number is 0."""
        if self.samples is None:
            self.samples = SeenSamples(self.y0)
        taken = self.samples.at(self, t, u)
        y = taken.said if self.sampled or self.kernels.out is None else self.out_with(t, self.x0, u, taken.state)
        return np.nan_to_num(y, nan=0.0)

    def state_before(self) -> Any:
        """Return the state before the first sample."""
        return self.d0 if self.host is None else self.host.init(self._p_now)

    def take(self, t: float, state: Any, u: Floats) -> tuple[Any, Floats]:
        """Take the sample ``u`` at ``t`` [s]; return the next state and the outputs, and leave ``state`` alone."""
        if self.host is not None:
            after, said = self.host.step(t, copy.deepcopy(state), u, self._p_now)
            return after, np.asarray(said, dtype=float)
        memory, y = np.array(state, dtype=float), np.zeros(len(self.ports_out))
        if self.kernels.step is not None:
            self.kernels.step(t, self.x0, memory, u, self._p_at(t), y)
        return memory, y

    def next_sample(self, t: float, later: bool = False) -> float:
        """Return the first sampling instant at ``t`` [s] or later, or the first one really ``later``."""
        if self.sampled:
            offset = float(self.p[self.param_index(self.offset_param)]) if self.offset_param else 0.0
            k = (t - offset) / self.period
            return offset + max(0, math.floor(k + EARLY) + 1 if later else math.ceil(k - EARLY)) * self.period
        times = self.timetable[:, 0] if self.timetable is not None else np.zeros(0)
        row = int(np.searchsorted(times, t, side="right" if later else "left"))
        return float(times[row]) if row < len(times) else math.inf

    def _update(self, t: float, x: Floats, u: Floats, params: Mapping[str, float]) -> Floats:
        self._update_params(params)
        return self._rhs(t, x, u)

    def _output(self, t: float, x: Floats, u: Floats, params: Mapping[str, float]) -> Floats:
        self._update_params(params)
        return self._out(t, x, u)

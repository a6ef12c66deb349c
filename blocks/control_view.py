"""What python-control sees of a block: a nonlinear I/O system whose functions run the kernels in plain Python."""

import warnings
from collections.abc import Mapping

import control as ct
import numpy as np

from blocks.declared import Declared
from blocks.kernels import Floats
from blocks.parameters import Parametrised

NO_APPEND = (
    "ct.append stacks linear systems only; use diagram.wire([...], inputs=[...]), or ct.interconnect([...], "
    "inplist=..., outlist=...), or give ct.append its linearisation, ct.linearize(system, x0, u0)"
)


class ControlView(Declared, Parametrised, ct.NonlinearIOSystem):  # type: ignore[misc]
    """A block as python-control calls it (``updfcn``, ``outfcn``): nothing is kept, so a call never changes it.

    One view keeps something: that of a block that runs in Python (``hosted_view``) keeps the samples it took, for its
    state is no number; it forgets those behind the time at which it is called.

    Python-control knows neither events nor samples: a block is seen in the mode that ``seen_memory`` gives, a sampled
    one with its memories as states.
    """

    state_names: tuple[str, ...]
    memory_names: tuple[str, ...]
    x0: Floats
    _p_now: Floats
    keeps_mode = False  # of a stem, when slopes are taken of it

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

    def out_now(self, t: float, x: Floats, u: Floats) -> Floats:
        """Return the outputs with the parameters that python-control gave last."""
        return self._out(t, x, u)

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

"""A plain Python function called every dt: a Kalman filter, a model predictive controller, a program of your own.

    y_k = step(...)                       at t_k = offset + k dt, y held until t_(k+1)
    state_(k+1), y_k = step(state, ...)   if step takes ``state``

Every argument of ``step`` is the name of an input, a parameter, ``t``, the time [s], or ``state``.  It returns one
value per output, as a number or as a sequence.  The state is any Python value; each run begins with a copy of it.

The function runs in Python between two calls of the engine, so it may use anything: solvers, files, classes.
Python-control's solver goes back, so there each sample is given a copy of the state.  A run that goes on from
``run.final`` begins with a new state.
Valid for anything that samples; not for events between samples.  See also: equations (continuous, compiled).
"""

import copy
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from stickslip.blocks.block import Block, Floats, Kernels
from stickslip.blocks.kernel_source import arguments, names, where, with_defaults
from stickslip.blocks.ports import BlockError, Labels, Port, nearest
from stickslip.blocks.role import Role
from stickslip.blocks.rules import check_scan


@dataclass(frozen=True)
class _Call:
    """Calls the function: ``wanted`` says for each argument in which group of values it stands, and where."""

    block: str
    function: Callable[..., Any]
    wanted: tuple[tuple[str, int], ...]
    state: Any
    count: int

    def init(self, p: Floats) -> Any:
        """Return the state before the first sample."""
        return copy.deepcopy(self.state)

    def step(self, t: float, state: Any, u: Floats, p: Floats) -> tuple[Any, Sequence[float]]:
        """Call the function with the sample ``u`` at ``t`` [s]; return the next state and the outputs."""
        groups: dict[str, Any] = {"t": (t,), "u": u.tolist(), "p": p.tolist(), "state": (state,)}
        try:
            given = self.function(*(groups[group][i] for group, i in self.wanted))
        except Exception as error:
            error.add_note(f"{self.block}: step failed at t = {t:g} s with inputs {groups['u']}")
            raise
        has_state = any(group == "state" for group, _ in self.wanted)
        if has_state and not (isinstance(given, tuple) and len(given) == 2):
            raise BlockError(f"{self.block}: step takes state, but returns {given!r}; return (next state, outputs)")
        state, outputs = given if has_state else (state, given)
        try:
            values = np.asarray([] if outputs is None else outputs, dtype=float).ravel()
        except (TypeError, ValueError):  # not numbers
            values = np.empty(0)
        if len(values) != self.count:
            raise BlockError(
                f"{self.block}: step returns {outputs!r}, but has {self.count} outputs; return one number each"
            )
        return state, values.tolist()


class SampledFunction(Block):
    """A Python function called every ``dt`` [s], first at ``offset`` [s]; see the module docstring.

    ``start_output``: what the outputs are before the first sample (default 0).  ``inputs`` and ``outputs`` name the
    ports, and the signals unless ``labels`` says otherwise.  Raises ``BlockError`` for an argument that is none of the
    names, a name used twice, or dt <= 0; when it runs, for another number of values than there are outputs.

    ``start_output`` [units of the outputs].

    >>> from stickslip.diagram import drive
    >>> def mean(state, PV, share=0.5):
    ...     state += share * (PV - state)
    ...     return state, state
    >>> drive(SampledFunction("filter", mean, dt=1.0, inputs="PV", outputs="PV_f", state=0.0), 2.0, every=1.0,
    ...       PV=8.0).log["PV_f"].tolist()
    [4.0, 6.0, 7.0]
    """

    role = Role.PROCESS
    period_param = "dt"
    offset_param = "offset"

    def __init__(
        self,
        name: str,
        step: Callable[..., Any],
        *,
        dt: float,
        inputs: str | Sequence[str] = (),
        outputs: str | Sequence[str],
        params: Mapping[str, float] | None = None,
        state: Any = None,
        offset: float = 0.0,
        start_output: Sequence[float] | float = 0.0,
        labels: Mapping[str, str] | None = None,
        units: Mapping[str, str] | None = None,
    ) -> None:
        ins, outs = names(inputs), names(outputs)
        given = {**with_defaults(name, (step,), params, {*ins, "t", "state"}), "dt": dt, "offset": offset}
        where(name, {"u": ins, "p": given, "state": ("state",)})
        places = {"t": ("t", 0), "state": ("state", 0)}
        places |= {key: (group, i) for group, keys in (("u", ins), ("p", given)) for i, key in enumerate(keys)}
        wanted = arguments(name, "step", step)
        for key in wanted:
            if key not in places:
                raise BlockError(
                    f"{name}: step takes '{key}', which is no input or parameter; {nearest(key, list(places))}"
                )
        self.ports_in, self.ports_out = tuple(map(Port, ins)), tuple(map(Port, outs))
        if not ins:
            self.role = Role.SOURCE
        self.kernels = Kernels(feeds=any(places[key][0] == "u" for key in wanted))
        self.host = _Call(name, step, tuple(places[key] for key in wanted), state, len(outs))
        shown = labels or {}
        super().__init__(
            name=name, params=given, start_output=np.broadcast_to(start_output, len(outs)),
            inputs=_shown(ins, shown), outputs=_shown(outs, shown), units=units,
        )  # fmt: skip

    check = staticmethod(check_scan)


def _shown(ports: Sequence[str], labels: Mapping[str, str]) -> Labels:
    return [labels.get(port, port) for port in ports]

"""Kernels written with names: ``def der(L, F, A, k)`` in place of ``(t, x, d, u, p, out)`` and ``p[1]``.

Each argument is the name of a state, a memory, an input or a parameter of the block (a port called ``in`` is
``in_``), or ``t``, the time [s]; in ``jump`` also ``event``, the number of the event that fired (0, 1, ...).
What a function returns, as a number where it is one, else as a tuple:

    out        one value per output             der   one rate per state          zc  one value per event function
    step       the memories after the sample, then the outputs
    jump       the memories after the event, then the states
    next_time  the next discontinuity [s]

Such functions are pure: they change nothing that they are given.  What they take says what they depend on, so
``feeds`` and ``timed`` need not be stated for ``out`` and ``der``.  Without ``out``, outputs that have the names of
states are these states.  Both kinds may stand side by side; arrays remain for tables and for ports by number.
"""

import inspect
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from types import FunctionType
from typing import Any

from stickslip.blocks.kernel_source import SHAPE, arguments, called, copied, generated_for, where
from stickslip.blocks.kernels import Kernel, Kernels, fed_by

_known: dict[tuple[Kernels, "Names"], Kernels] = {}
KINDS = ("out", "der", "zc", "jump", "step", "next_time")


@dataclass(frozen=True)
class Names:
    """The names that stand in a block: states, memories, inputs and parameters in their order, and its outputs."""

    states: tuple[str, ...]
    memories: tuple[str, ...]
    inputs: tuple[str, ...]
    params: tuple[str, ...]
    outputs: tuple[str, ...]


def by_names(kernel: Any) -> bool:
    """Return whether a kernel is written with names.

    >>> by_names(lambda L, F, A, k: (F - k * L) / A), by_names(lambda t, x, d, u, p, y: None)
    (True, False)
    """
    return isinstance(kernel, FunctionType) and tuple(inspect.signature(kernel).parameters)[: len(SHAPE)] != SHAPE


def in_arrays(kernels: Kernels, block: str, names: Names, start: Mapping[str, float]) -> Kernels:
    """Return the kernels with those that are written with names made to read arrays; the others as they are.

    ``start``: the values of states, memories and parameters to try them with once.

    Raises ``BlockError`` for an argument that is none of the names, a name that stands for two things, or another
    number of values than is needed.
    """
    key = (kernels, names)
    if key not in _known:
        _known[key] = _in_arrays(kernels, block, names, start)
    return _known[key]


def _in_arrays(kernels: Kernels, block: str, names: Names, start: Mapping[str, float]) -> Kernels:
    written = {kind: function for kind in KINDS if by_names(function := getattr(kernels, kind))}
    shown = not kernels.out and not kernels.step and names.outputs and set(names.outputs) <= set(names.states)
    if not written and not shown:
        return kernels
    places = where(block, {"x": names.states, "d": names.memories, "u": names.inputs, "p": names.params})
    values = {**dict.fromkeys((*names.inputs, "t", "event"), 0.0), **start}
    made: dict[str, Any] = {
        kind: _made(kind, block, function, places, values, _targets(kind, kernels, names))
        for kind, function in written.items()
    }
    if shown and kernels.der is not None:
        made["out"] = generated_for(kernels.der, copied(places, names.outputs), "_out")  # type: ignore[arg-type]
        made["feeds"] = False
    if "out" in written:
        made["feeds"] = fed_by(key in arguments(block, "out", written["out"]) for key in names.inputs)
    reads = [arguments(block, kind, written[kind]) for kind in ("out", "der") if kind in written]
    return replace(kernels, **made, timed=kernels.timed or any("t" in wanted for wanted in reads))


def _made(
    kind: str, block: str, function: FunctionType, places: Mapping[str, str], values: Mapping[str, float],
    targets: Sequence[str],
) -> Kernel:  # fmt: skip
    if kind == "jump":
        places = {**places, "event": "out[0]"}
    lines = called(block, kind, function, places, values, targets)
    if kind == "next_time":
        lines = [*lines, "out[1] = math.inf"]  # it limits no step
    return generated_for(function, lines, kind)


def _targets(kind: str, kernels: Kernels, names: Names) -> list[str]:
    """Return where the values that a function of this kind returns belong."""
    memories = [f"d[{i}]" for i in range(len(names.memories))]
    if kind == "jump":
        return [*memories, *(f"x[{i}]" for i in range(len(names.states)))]
    values = {"out": len(names.outputs), "step": len(names.outputs), "der": len(names.states), "zc": kernels.n_events}
    outputs = [f"out[{i}]" for i in range(values.get(kind, 1))]
    return memories + outputs if kind == "step" else outputs

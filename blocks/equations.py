"""A block from one or two plain Python functions, whose arguments are read by name.

    dx/dt = der(...)          y = out(...)

Every argument of ``der`` and ``out`` is the name of a state, an input, a parameter, or ``t``, the time [s]; an argument
with a default is a parameter.  ``der`` returns one rate per state, ``out`` one value per output, as a number or as a
tuple.  Without ``out`` the outputs are states.  If ``out`` takes an input, the outputs follow it at once.

The functions are compiled for the engine and may use numbers, ``math``, ``numpy`` and other such functions; numbers
from outside are taken as they are at the first run.  A function that cannot be compiled is called in Python instead,
and ``run.in_python`` says how often, for how long and why.

Valid for equations that do not switch; not for events (subclass ``Block`` with ``zc`` and ``jump`` for those).
See also: sampled_function (a function called every dt), state_space, transfer_function.
"""

import inspect
from collections.abc import Callable, Mapping, Sequence
from types import FunctionType
from typing import Any

import numpy as np

from blocks.block import Block, Kernel, Kernels
from blocks.ports import BlockError, Port, nearest
from blocks.role import Role

Function = Callable[..., Any]
_made: dict[tuple[object, ...], Kernel] = {}


class Equations(Block):
    """A continuous block from the functions ``der`` and ``out``; see the module docstring.

    ``states`` maps each state to its start value, ``params`` each parameter to its value; ``inputs`` and ``outputs``
    are the names of the ports, and the signals unless ``labels`` says otherwise (``labels={"h": "level"}``).

    Raises ``BlockError`` for an argument that is none of these names, a name used twice, or a function that returns
    another number of values than there are states or outputs.

    >>> from diagram import drive
    >>> lag = Equations(
    ...     "lag", der=lambda PV, MV, K, tau: (K * MV - PV) / tau,
    ...     states={"PV": 0.0}, inputs=["MV"], params={"K": 3.0, "tau": 10.0},
    ... )
    >>> drive(lag, 20.0, every=10.0, MV=1.0).log["PV"].round(4).tolist()  # 3 (1 - exp(-t/10))
    [0.0, 1.8964, 2.594]
    """

    role = Role.PROCESS

    def __init__(
        self,
        name: str,
        *,
        der: Function | None = None,
        out: Function | None = None,
        states: Mapping[str, float] | None = None,
        inputs: str | Sequence[str] = (),
        outputs: str | Sequence[str] | None = None,
        params: Mapping[str, float] | None = None,
        labels: Mapping[str, str] | None = None,
        units: Mapping[str, str] | None = None,
    ) -> None:
        states = dict(states or {})
        ins = names(inputs)
        outs = names(outputs) if outputs is not None else tuple(states)
        given = with_defaults((der, out), params, {*states, *ins, "t"})
        places = where(name, {"x": states, "u": ins, "p": given})
        if (der is None) != (not states):
            raise BlockError(f"{name}: der gives the rates of the states; give both der= and states=, or neither")
        if not outs or (out is None and not set(outs) <= set(states)):
            raise BlockError(f"{name}: outputs = {list(outs)!r} are not all states; give out= for them")
        values = {**states, **given, **dict.fromkeys((*ins, "t"), 0.0)}
        self.ports_in, self.ports_out = tuple(map(Port, ins)), tuple(map(Port, outs))
        self.kernels = Kernels(
            der=None if der is None else kernel(name, "der", der, places, values, len(states)),
            out=copies(places, outs) if out is None else kernel(name, "out", out, places, values, len(outs)),
            feeds=out is not None and not set(arguments(name, "out", out)).isdisjoint(ins),
            timed=any(f is not None and "t" in arguments(name, what, f) for what, f in (("der", der), ("out", out))),
        )
        if not ins and not states:
            self.role = Role.SOURCE
        signals = dict(labels or {})
        for key in signals:
            if key not in (*ins, *outs):
                raise BlockError(f"block '{name}' has no port '{key}'; {nearest(key, [*ins, *outs])}")
        super().__init__(
            name=name, params=given, states=states, inputs=[signals.get(key, key) for key in ins],
            outputs=[signals.get(key, key) for key in outs], units=units,
        )  # fmt: skip


def names(given: str | Sequence[str]) -> tuple[str, ...]:
    """Return one name or several as a tuple."""
    return (given,) if isinstance(given, str) else tuple(given)


def with_defaults(
    functions: Sequence[Function | None], params: Mapping[str, float] | None, taken: set[str]
) -> dict[str, float]:
    """Return the parameters, those that are defaults of arguments included."""
    found = {
        key: argument.default
        for function in functions
        if function is not None
        for key, argument in inspect.signature(function).parameters.items()
        if argument.default is not argument.empty and key not in taken
    }
    given = dict(params or {})
    return given | {key: value for key, value in found.items() if key not in given}


def where(name: str, groups: Mapping[str, Sequence[str] | Mapping[str, float]]) -> dict[str, str]:
    """Return what stands for each name in a kernel; refuse a name used twice."""
    places = {"t": "t"}
    for array, group in groups.items():
        for i, key in enumerate(group):
            if key in places:
                raise BlockError(
                    f"{name}: '{key}' is used twice; time (t), states, inputs and parameters need names of their own"
                )
            places[key] = f"{array}[{i}]"
    return places


def arguments(name: str, what: str, function: Function) -> list[str]:
    """Return the names of a function's arguments; refuse ``*args`` and the like."""
    found = inspect.signature(function).parameters
    for key, argument in found.items():
        if argument.kind not in (argument.POSITIONAL_ONLY, argument.POSITIONAL_OR_KEYWORD):
            raise BlockError(
                f"{name}: {what} takes '{argument}', but its arguments are read by name; name '{key}' plainly"
            )
    return list(found)


def kernel(
    name: str, what: str, function: Function, places: Mapping[str, str], values: Mapping[str, float], count: int
) -> Kernel:
    """Return the kernel that calls ``function`` with what stands at the places of its arguments.

    ``values`` are those it is tried with once, to see how many it returns; a function that fails there is not judged.
    """
    wanted = arguments(name, what, function)
    for key in wanted:
        if key not in places:
            raise BlockError(
                f"{name}: {what} takes '{key}', which is no state, input or parameter; {nearest(key, list(places))}"
            )
    many = count > 1
    try:
        shape = np.shape(function(*(values[key] for key in wanted)))
    except Exception:  # at these values only, perhaps: a division by an input that is zero
        pass
    else:
        if shape not in ((count,), ()) or (shape == () and many):
            said = "1 value" if shape == () else f"{shape[0]} values" if len(shape) == 1 else f"an array {shape}"
            raise BlockError(f"{name}: {what} returns {said}, but {count} are needed; return a tuple of {count}")
        many = shape != ()
    call = f"function({', '.join(places[key] for key in wanted)})"
    lines = [f"values = {call}", *(f"out[{i}] = values[{i}]" for i in range(count))] if many else [f"out[0] = {call}"]
    return generated(lines, function)


def copies(places: Mapping[str, str], outputs: Sequence[str]) -> Kernel:
    """Return the kernel that puts states out as they are."""
    return generated([f"out[{i}] = {places[key]}" for i, key in enumerate(outputs)])


def generated(lines: Sequence[str], function: Function | None = None, output: Function | None = None) -> Kernel:
    """Return the kernel with these lines, in which ``function`` and ``output`` are known by these names.

    The same kernel is returned for the same functions, so that it is compiled once: for one object, or for functions
    made by one line of source without values from around it.
    """
    key = (*_same(function), *_same(output), *lines)
    if key not in _made:
        body = "\n    ".join(lines)
        known: dict[str, Any] = {"function": function, "output": output, "np": np}
        exec(f"def kernel(t, x, d, u, p, out):\n    {body}\n", known)
        made = known["kernel"]
        made.may_run_in_python = True
        _made[key] = made
    return _made[key]


def _same(function: Function | None) -> tuple[object, ...]:
    """Return what two functions have in common if they do the same."""
    if isinstance(function, FunctionType) and function.__closure__ is None:
        return function.__code__, id(function.__globals__)
    return (function,)

"""The source of kernels that are made of functions whose arguments are names.

A kernel reads places in arrays, ``p[1]``; a function of names, ``f(L, F, A, k)``, is called by a kernel of a few lines
that says where each name stands.  Compiled, the call costs nothing: the function becomes part of the kernel.
"""

import ast
import inspect
import math
import sys
from collections.abc import Mapping, Sequence
from types import FunctionType
from typing import Any

import numpy as np
from stickslip.blocks.kernels import Function, Kernel
from stickslip.blocks.ports import BlockError, nearest

SHAPE = ("t", "x", "d", "u", "p")  # the first arguments of a kernel that reads arrays
_made: dict[tuple[object, ...], Kernel] = {}


def names(given: str | Sequence[str]) -> tuple[str, ...]:
    """Return one name or several as a tuple."""
    return (given,) if isinstance(given, str) else tuple(given)


def with_defaults(
    name: str, functions: Sequence[Function | None], params: Mapping[str, float] | None, taken: set[str]
) -> dict[str, float]:
    """Return the parameters, those that are defaults of arguments included; refuse what is no function."""
    for function in functions:
        if function is not None and not callable(function):
            raise BlockError(f"{name}: {function!r} is no function; give one whose arguments are names")
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


def called(
    name: str,
    what: str,
    function: Function,
    places: Mapping[str, str],
    values: Mapping[str, float],
    targets: Sequence[str],
) -> list[str]:
    """Return the lines that call ``function`` with what stands at the places of its arguments.

    They put what it returns into the ``targets``.  ``values`` are those it is tried with once, to see how many it
    returns; a function that fails there is not judged.
    """
    wanted = arguments(name, what, function)
    for key in wanted:
        if key not in places:
            raise BlockError(
                f"{name}: {what} takes '{key}', which is no state, memory, input or parameter; "
                f"{nearest(key, list(places))}"
            )
    count = len(targets)
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
    return [f"values = {call}", *_put("values", targets)] if many else [f"{targets[0]} = {call}"]


def _put(values: str, targets: Sequence[str]) -> list[str]:
    return [f"{target} = {values}[{i}]" for i, target in enumerate(targets)]


def copied(places: Mapping[str, str], outputs: Sequence[str]) -> list[str]:
    """Return the lines that put states out as they are."""
    return [f"out[{i}] = {places[key]}" for i, key in enumerate(outputs)]


def generated(lines: Sequence[str], function: Function | None = None, output: Function | None = None) -> Kernel:
    """Return the kernel with these lines, in which ``function`` and ``output`` are known by these names.

    The same kernel is returned for the same functions, so that it is tried once.
    """
    key = (function, output, *lines)
    if key not in _made:
        _made[key] = _placed(function or output, lines, {"function": function, "output": output, "np": np}, "kernel")
        _made[key].may_run_in_python = True  # type: ignore[attr-defined]
    return _made[key]


def generated_for(function: FunctionType, lines: Sequence[str], name: str) -> Kernel:
    """Return the kernel with these lines, called ``name``, which knows ``function`` and ``math``.

    An error message names the place of the function.
    """
    key = (function, name, *lines)
    if key not in _made:
        _made[key] = _placed(function, lines, {"function": function, "math": math}, name)
    return _made[key]


def _placed(beside: Function | None, lines: Sequence[str], known: dict[str, Any], name: str) -> Kernel:
    """Return the kernel as if it stood in the file of a plain function, beside which it is cached.

    A function of a module that cannot be found by its name has no such place.
    """
    module = getattr(beside, "__module__", "")
    code = getattr(beside, "__code__", None) if module in sys.modules else None
    file, line = ("<string>", 1) if code is None else (code.co_filename, code.co_firstlineno)
    tree = ast.parse(f"def {name}({', '.join(SHAPE)}, out):\n    " + "\n    ".join(lines))
    for node in ast.walk(tree):
        if isinstance(node, ast.stmt | ast.expr | ast.arg):
            node.lineno = node.end_lineno = line
    known["__name__"] = __name__ if code is None else module
    exec(compile(tree, file, "exec"), known)
    made: Kernel = known[name]
    return made

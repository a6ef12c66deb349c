"""What the code of a kernel depends on besides its own text: helpers and constants, wherever they stand.

Compiled code has the values of global names frozen in, and those of the helpers it calls.  So a compiled kernel is
kept under a fingerprint of all that it reaches at the time of the run, in this process and on disk.
"""

import dis
import hashlib
import sys
from collections.abc import Iterator
from enum import Enum
from types import CodeType, FunctionType, ModuleType
from typing import Any
from uuid import uuid4

import numba
import numpy as np
from stickslip.engine.watched import Watched

OUTSIDE = {"numpy", "numba", "llvmlite", "scipy", *sys.stdlib_module_names}  # they change with their version only
VERSIONS = f"{numba.__version__} {np.__version__} {sys.version}"
PLAIN = (int, float, complex, str, bytes, type(None), type(...), np.generic, np.dtype, np.ufunc, Enum)
PROCESS = uuid4().hex  # what is known by its address only is known in this process only


class Reached(Watched):
    """What a function and every helper reach, by name, by module or from around them, as it is found now.

    >>> from stickslip.blocks.limited_pi import limited_output
    >>> found = Reached(limited_output)
    >>> found.fingerprint == Reached(limited_output).fingerprint != Reached(outside).fingerprint
    True
    >>> found.changed()
    False
    """

    def __init__(self, kernel: FunctionType) -> None:
        super().__init__()
        self._seen: dict[tuple[int, frozenset[str]], int] = {}
        self.fingerprint = _digest(self._function(kernel))

    def _facts(self, value: Any, names: frozenset[str]) -> Iterator[str | bytes]:
        """Yield what there is to know of a value; ``names``: the attributes that may be taken from it."""
        value = getattr(value, "py_func", value)  # what numba has compiled already
        if outside(value):
            yield f"{_home(value)}.{getattr(value, '__qualname__', getattr(value, '__name__', ''))}"
        elif isinstance(value, FunctionType):
            yield from self._once(value, frozenset()) or self._function(value)
        elif isinstance(value, ModuleType | type):
            yield from self._once(value, names) or self._attributes(value, names)
        else:
            yield from _contents(value)
            if not isinstance(value, PLAIN):
                self.hold(value, _digest_of_contents)

    def _once(self, value: Any, names: frozenset[str]) -> tuple[str, ...]:
        """Return the number of what has been digested already, nothing for what is new."""
        key = (id(value), names)
        if key in self._seen:
            return (f"again {self._seen[key]}",)
        self._seen[key] = len(self._seen)
        return ()

    def _attributes(self, value: Any, names: frozenset[str]) -> Iterator[str | bytes]:
        there = sorted(names & set(dir(value)))
        for name, part in zip(there, self.look(value, there), strict=True):
            yield name
            yield from self._facts(part, names)

    def _function(self, function: FunctionType) -> Iterator[str | bytes]:
        given = self.look(function, ["__code__", "__defaults__", "__kwdefaults__"])
        yield from _code(given[0])
        names = names_in(given[0])
        used = sorted(names)
        for name, value in zip(used, self.look(function.__globals__, used), strict=True):
            if value is not None:
                yield name
                yield from self._facts(value, names)
        for cell in function.__closure__ or ():
            (value,) = self.look(cell, ["cell_contents"])
            yield from self._facts(value, names)
        for name, defaults in zip(("positional", "by name"), given[1:], strict=True):
            yield f"{name} {len(defaults or ())}"
            for default in defaults.values() if isinstance(defaults, dict) else defaults or ():
                yield from self._facts(default, names)


def outside(value: Any) -> bool:
    """Return whether a function, class or module belongs to a library that changes with its version only."""
    known = callable(value) or isinstance(value, ModuleType)
    return known and not isinstance(value, np.ufunc) and _home(value).partition(".")[0] in OUTSIDE


def names_in(code: CodeType) -> frozenset[str]:
    """Return the names, of globals and attributes, that a function and those inside it use."""
    return frozenset(name for part in _codes(code) for name in part.co_names)


def helpers(function: Any) -> Iterator[tuple[str, FunctionType]]:
    """Yield the plain functions that a function names, of its module and from around it, with their names."""
    cells = zip(function.__code__.co_freevars, function.__closure__ or (), strict=True)
    around = {name: cell.cell_contents for name, cell in cells}
    for name in sorted(names_in(function.__code__) | around.keys()):
        helper = around[name] if name in around else function.__globals__.get(name)
        if isinstance(helper, FunctionType) and not outside(helper):
            yield name, helper


def raises(function: Any, _seen: frozenset[FunctionType] = frozenset()) -> bool:
    """Return whether a function, or a plain one that it calls, says ``raise`` or ``assert``, or prints.

    >>> def f(x):
    ...     assert x > 0.0
    >>> raises(f), raises(outside)
    (True, False)
    """
    steps = list(dis.get_instructions(function))
    if any(step.opname == "RAISE_VARARGS" or step.argval == "print" for step in steps):
        return True
    seen = _seen | {function}
    return any(raises(helper, seen) for _, helper in helpers(function) if helper not in seen)


def _home(value: Any) -> str:
    return value.__name__ if isinstance(value, ModuleType) else str(getattr(value, "__module__", None))


def _contents(value: Any) -> Iterator[str | bytes]:
    """Yield what a value is: numbers and text by their value, arrays and lists by what they hold."""
    kind = type(value).__qualname__
    if isinstance(value, np.ndarray) and not value.dtype.hasobject:
        yield f"{kind} {value.dtype} {value.shape}"
        yield np.ascontiguousarray(value).tobytes()
    elif isinstance(value, tuple | list):
        yield f"{kind} {len(value)}"
        for item in value:
            yield from _contents(item)
    elif isinstance(value, PLAIN):
        yield f"{kind} {value!r}"
    else:
        yield f"{kind} {id(value)} {PROCESS}"


def _code(code: CodeType) -> Iterator[str | bytes]:
    for part in _codes(code):
        yield part.co_code
        yield repr((part.co_argcount, part.co_names, part.co_varnames, part.co_freevars))
        yield repr([const for const in part.co_consts if not isinstance(const, CodeType)])


def _codes(code: CodeType) -> Iterator[CodeType]:
    """Yield a function's code and that of the functions inside it."""
    yield code
    for const in code.co_consts:
        if isinstance(const, CodeType):
            yield from _codes(const)


def _digest(facts: Iterator[str | bytes]) -> str:
    digest = hashlib.sha256(VERSIONS.encode())
    for fact in facts:
        content = fact.encode() if isinstance(fact, str) else fact
        digest.update(b"%d:" % len(content) + content)
    return digest.hexdigest()


def _digest_of_contents(value: Any) -> str:
    return _digest(_contents(value))

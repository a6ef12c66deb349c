"""What the code of a kernel depends on besides its own text: helpers and constants, wherever they stand.

Compiled code has the values of global names frozen in, and those of the helpers it calls.  Numba notices a change in
the file of the kernel only; a constant from another file would keep its old value, in this and in all later processes.
So compiled kernels are kept under a fingerprint of all they reach.
"""

import dis
import hashlib
import sys
from collections.abc import Iterable, Iterator
from types import CodeType, FunctionType, ModuleType
from typing import Any

import numba
import numpy as np
from numba.extending import register_jitable

OUTSIDE = {"numpy", "numba", "llvmlite", "scipy", *sys.stdlib_module_names}  # they change with their version only
VERSIONS = f"{numba.__version__} {np.__version__} {sys.version}"
_callable: set[FunctionType] = set()


def fingerprint(kernel: FunctionType) -> str:
    """Return a fingerprint of a function and of every helper and constant that it reaches, by name or by module.

    >>> from blocks.limited_pi import limited_output
    >>> fingerprint(limited_output) == fingerprint(limited_output) != fingerprint(fingerprint)
    True
    """
    digest = hashlib.sha256(VERSIONS.encode())
    for fact in _facts(kernel, frozenset(), set()):
        digest.update(fact.encode() if isinstance(fact, str) else fact)
        digest.update(b";")
    return digest.hexdigest()


def make_callable(function: Any) -> None:
    """Let compiled code call the plain Python functions of its module, or from around it, that ``function`` names."""
    for helper in _helpers(function):
        if helper not in _callable:
            _callable.add(helper)
            register_jitable(helper)
            make_callable(helper)


def raises(function: Any, _seen: frozenset[FunctionType] = frozenset()) -> bool:
    """Return whether a function, or a plain one that it calls, says ``raise`` or ``assert``, or prints.

    >>> def f(x):
    ...     assert x > 0.0
    >>> raises(f), raises(make_callable)
    (True, False)
    """
    steps = list(dis.get_instructions(function))
    if any(step.opname == "RAISE_VARARGS" or step.argval == "print" for step in steps):
        return True
    return any(raises(helper, _seen | {function}) for helper in _helpers(function) if helper not in _seen | {function})


def _helpers(function: Any) -> Iterator[FunctionType]:
    """Yield the plain functions that a function names, of its module and from around it."""
    cells = (cell.cell_contents for cell in function.__closure__ or ())
    around = dict(zip(function.__code__.co_freevars, cells, strict=True))
    for name in (*function.__code__.co_names, *around):
        helper = around[name] if name in around else function.__globals__.get(name)
        if isinstance(helper, FunctionType):
            yield helper


def _facts(value: Any, names: frozenset[str], seen: set[int]) -> Iterator[str | bytes]:
    """Yield what there is to know of a value; ``names``: the attributes that may be taken from it."""
    value = getattr(value, "py_func", value)  # what numba has compiled already
    home = value.__name__ if isinstance(value, ModuleType) else str(getattr(value, "__module__", None))
    if home.partition(".")[0] in OUTSIDE and (callable(value) or isinstance(value, ModuleType)):
        yield f"{home}.{getattr(value, '__qualname__', getattr(value, '__name__', ''))}"
    elif isinstance(value, FunctionType):
        if id(value) not in seen:
            seen.add(id(value))
            yield from _function(value, seen)
    elif isinstance(value, ModuleType | type):
        for name in sorted(names & set(dir(value))):
            yield name
            yield from _facts(getattr(value, name), names, seen)
    elif isinstance(value, np.ndarray):
        yield f"{value.dtype} {value.shape}"
        yield np.ascontiguousarray(value).tobytes()
    elif isinstance(value, tuple | list):
        yield f"{type(value).__name__} {len(value)}"
        for item in value:
            yield from _facts(item, names, seen)
    else:
        yield repr(value)


def _function(function: FunctionType, seen: set[int]) -> Iterator[str | bytes]:
    codes = list(_codes(function.__code__))
    names = frozenset(name for code in codes for name in code.co_names)
    for code in codes:
        yield code.co_code
        yield repr((code.co_argcount, code.co_names, code.co_varnames, code.co_freevars))
        yield repr([const for const in code.co_consts if not isinstance(const, CodeType)])
    for name in sorted(names & function.__globals__.keys()):
        yield name
        yield from _facts(function.__globals__[name], names, seen)
    held: Iterable[Any] = [cell.cell_contents for cell in function.__closure__ or ()]
    for given in (*held, *(function.__defaults__ or ())):
        yield from _facts(given, names, seen)


def _codes(code: CodeType) -> Iterator[CodeType]:
    """Yield a function's code and that of the functions inside it."""
    yield code
    for const in code.co_consts:
        if isinstance(const, CodeType):
            yield from _codes(const)

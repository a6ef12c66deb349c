"""A copy of a kernel for the compiler, with its helpers as they are now.

The compiler keeps what it has made of a function object, with the values that the function reached then.  A copy is
another object, so nothing old is met again; and what it reaches stays alive as long as the compiled code.
"""

from collections.abc import Callable
from types import CellType, FunctionType
from typing import Any

from stickslip.engine.reach import helpers


def frozen(kernel: FunctionType, compiled: Callable[[FunctionType], Any]) -> FunctionType:
    """Return the copy, in which the plain functions that it names are ``compiled`` copies.

    >>> def twice(x): return 2.0 * x
    >>> def kernel(x): return 1.0 + twice(x)
    >>> copy = frozen(kernel, lambda helper: helper)
    >>> def twice(x): return 3.0 * x
    >>> copy(1.0), kernel(1.0)
    (3.0, 4.0)
    """
    copy: FunctionType = _copy(kernel, lambda copy: copy, compiled, {})
    return copy


def _copy(
    function: FunctionType, as_what: Callable[[Any], Any], compiled: Callable[[Any], Any], made: dict[Any, Any]
) -> Any:
    known = dict(function.__globals__)
    cells = tuple(CellType(cell.cell_contents) for cell in function.__closure__ or ())
    copy = FunctionType(function.__code__, known, function.__name__, function.__defaults__, cells or None)
    copy.__kwdefaults__, copy.__qualname__ = function.__kwdefaults__, function.__qualname__
    made[function] = as_what(copy)
    around = dict(zip(function.__code__.co_freevars, cells, strict=True))
    for name, helper in helpers(function):
        found = made[helper] if helper in made else _copy(helper, compiled, compiled, made)
        if name in around:
            around[name].cell_contents = found
        else:
            known[name] = found
    return made[function]

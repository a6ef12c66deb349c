"""Small scalar functions shared by kernels: plain Python when interpreted, compiled when compiled kernels call them."""

from collections.abc import Callable
from typing import Any, TypeVar

from numba.extending import register_jitable

F = TypeVar("F", bound=Callable[..., Any])


def inline(function: F) -> F:
    """Let compiled kernels call ``function``; for Python it stays the plain function it is.

    Kernels are cached by the date of their own file: after a change of a function that lives in another file,
    delete the ``.nbi`` and ``.nbc`` files beside the kernel.
    """
    marked: F = register_jitable(function)
    return marked

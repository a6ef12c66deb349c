"""Kernels: plain Python functions ``(t, x, d, u, p, out)`` compiled to one C signature and called by address.

Every kernel of every block has the same signature ``void(double, double*, double*, double*, double*,
double*)``, so the engine sees only addresses: it is compiled once, and a new block compiles nothing but itself.
The same Python function runs interpreted, with numpy arrays in place of the pointers.
"""

import re
import warnings
from collections.abc import Callable
from pathlib import Path
from types import FunctionType
from typing import Any

from llvmlite import ir
from numba import cfunc, types
from numba.core import cgutils
from numba.core.caching import FunctionCache
from numba.extending import intrinsic, register_jitable

from engine.callback import Callback
from engine.stamp import fresh

Kernel = Callable[[float, Any, Any, Any, Any, Any], None]

_POINTER = types.CPointer(types.float64)
SIGNATURE = types.void(types.float64, _POINTER, _POINTER, _POINTER, _POINTER, _POINTER)
_compiled: dict[Kernel, Any] = {}
_reached: set[FunctionType] = set()


def address(kernel: Kernel | None) -> int:
    """Return the address of the compiled kernel (0 for none), compiling it or loading it from the cache.

    A kernel with the attribute ``may_run_in_python`` is called in Python if it cannot be compiled; one with a reason
    there always is.
    """
    if kernel is None:
        return 0
    if kernel not in _compiled and hasattr(kernel, "may_run_in_python"):
        _compiled[kernel] = _compiled_if_possible(kernel)
    if kernel not in _compiled:
        _reach(kernel)
        source = Path(kernel.__code__.co_filename)
        try:
            with fresh(Path(FunctionCache(kernel).cache_path), source.parent):
                _compiled[kernel] = cfunc(SIGNATURE, cache=True, error_model="numpy", forceinline=True)(kernel)
        except (RuntimeError, OSError):  # defined at a prompt, or nowhere to keep the cache
            _compiled[kernel] = cfunc(SIGNATURE, error_model="numpy", forceinline=True)(kernel)
    return int(_compiled[kernel].address)


def in_python(kernel: Kernel | None) -> Callback | None:
    """Return what is known of a kernel that the engine calls in Python, None for a compiled one."""
    found = _compiled.get(kernel) if kernel is not None else None
    return found if isinstance(found, Callback) else None


def _compiled_if_possible(kernel: Kernel) -> Any:
    reason = kernel.may_run_in_python  # type: ignore[attr-defined]
    if isinstance(reason, str):
        return Callback(kernel, reason)
    try:
        _reach(kernel)
        with warnings.catch_warnings(action="ignore"):
            return cfunc(SIGNATURE, error_model="numpy", forceinline=True)(kernel)
    except Exception as error:  # whatever the compiler has against it, Python can run it
        return Callback(kernel, f"it cannot be compiled: {_in_short(error)}")


def _in_short(error: Exception) -> str:
    """Return what a compiler has against the function that the kernel calls, without headings and addresses."""
    text = re.sub(r"\x1b\[[0-9;]*m| at 0x[0-9a-f]+|(?<=')/[^']*/(?=[^/']+')", "", str(error))
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    told = [i for i in range(1, len(lines)) if "Failed in" in lines[i - 1] and "Failed in" not in lines[i]]
    if not told:
        return lines[0][:200] if lines else type(error).__name__
    place = told[min(1, len(told) - 1)]  # the first says only that the kernel's own call failed
    return " ".join(lines[place : place + 1 + lines[place].endswith(":")])[:200]


def _reach(function: Any) -> None:
    """Let compiled code call the plain Python functions of its module, or from around it, that ``function`` names."""
    around = dict(
        zip(function.__code__.co_freevars, (c.cell_contents for c in function.__closure__ or ()), strict=True)
    )
    for name in (*function.__code__.co_names, *around):
        helper = around[name] if name in around else function.__globals__.get(name)
        if isinstance(helper, FunctionType) and helper not in _reached:
            _reached.add(helper)
            register_jitable(helper)
            _reach(helper)


@intrinsic
def pointer_to(typingctx, array):  # type: ignore[no-untyped-def]
    """Return the data pointer of a contiguous array; indexing it costs one load, and passing it one register."""
    sig = types.CPointer(array.dtype)(array)

    def codegen(context, builder, signature, args):  # type: ignore[no-untyped-def]
        return cgutils.create_struct_proxy(signature.args[0])(context, builder, value=args[0]).data

    return sig, codegen


@intrinsic
def call(typingctx, where, t, base, ox, od, ou, op, oo):  # type: ignore[no-untyped-def]
    """Call the kernel at address ``where`` with pointers ``base + offset`` (offsets in floats)."""
    sig = types.void(types.int64, types.float64, base, types.int64, types.int64, types.int64, types.int64, types.int64)

    def codegen(context, builder, signature, args):  # type: ignore[no-untyped-def]
        double = ir.DoubleType()
        pointer = double.as_pointer()
        function = ir.FunctionType(ir.VoidType(), [double] + [pointer] * 5)
        target = builder.inttoptr(args[0], function.as_pointer())
        pointers = [builder.gep(args[2], [offset]) for offset in args[3:]]
        builder.call(target, [args[1], *pointers])
        return context.get_dummy_value()

    return sig, codegen

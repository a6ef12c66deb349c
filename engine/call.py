"""Kernels: plain Python functions ``(t, x, d, u, p, out)`` compiled to one C signature and called by address.

Every kernel of every block has the same signature ``void(double, double*, double*, double*, double*,
double*)``, so the engine sees only addresses: it is compiled once, and a new block compiles nothing but itself.
The same Python function runs interpreted, with numpy arrays in place of the pointers.
"""

from collections.abc import Callable
from pathlib import Path
from types import FunctionType
from typing import Any

from llvmlite import ir
from numba import cfunc, types
from numba.core import cgutils
from numba.core.caching import FunctionCache
from numba.extending import intrinsic, register_jitable

from engine.stamp import fresh

Kernel = Callable[[float, Any, Any, Any, Any, Any], None]

_POINTER = types.CPointer(types.float64)
SIGNATURE = types.void(types.float64, _POINTER, _POINTER, _POINTER, _POINTER, _POINTER)
_compiled: dict[Kernel, Any] = {}
_reached: set[FunctionType] = set()


def address(kernel: Kernel | None) -> int:
    """Return the address of the compiled kernel (0 for none), compiling it or loading it from the cache."""
    if kernel is None:
        return 0
    if kernel not in _compiled:
        _reach(kernel)
        source = Path(kernel.__code__.co_filename)
        try:
            with fresh(Path(FunctionCache(kernel).cache_path), source.parent):
                _compiled[kernel] = cfunc(SIGNATURE, cache=True, error_model="numpy", forceinline=True)(kernel)
        except (RuntimeError, OSError):  # defined at a prompt, or nowhere to keep the cache
            _compiled[kernel] = cfunc(SIGNATURE, error_model="numpy", forceinline=True)(kernel)
    return int(_compiled[kernel].address)


def _reach(function: Any) -> None:
    """Let compiled code call the plain Python functions of its module that ``function`` names."""
    for name in function.__code__.co_names:
        helper = function.__globals__.get(name)
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

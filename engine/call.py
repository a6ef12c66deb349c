"""Kernels: plain Python functions ``(t, x, d, u, p, out)`` compiled to one C signature and called by address.

Every kernel of every block has the same signature ``void(double, double*, double*, double*, double*,
double*)``, so the engine sees only addresses: it is compiled once, and a new block compiles nothing but itself.
The same Python function runs interpreted, with numpy arrays in place of the pointers.
"""

from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba import cfunc, types
from numba.core import cgutils
from numba.extending import intrinsic

Kernel = Callable[[float, Any, Any, Any, Any, Any], None]

_POINTER = types.CPointer(types.float64)
SIGNATURE = types.void(types.float64, _POINTER, _POINTER, _POINTER, _POINTER, _POINTER)
_compiled: dict[Kernel, Any] = {}


def address(kernel: Kernel | None) -> int:
    """Return the address of the compiled kernel (0 for none), compiling it or loading it from the cache."""
    if kernel is None:
        return 0
    if kernel not in _compiled:
        try:
            _compiled[kernel] = cfunc(SIGNATURE, cache=True, error_model="numpy")(kernel)
        except RuntimeError:  # defined at a prompt: numba has no file beside which to keep the cache
            _compiled[kernel] = cfunc(SIGNATURE, error_model="numpy")(kernel)
    return int(_compiled[kernel].address)


@intrinsic
def call(typingctx, where, t, base, ox, od, ou, op, oo):  # type: ignore[no-untyped-def]
    """Call the kernel at address ``where`` with pointers ``base + offset`` (offsets in floats)."""
    sig = types.void(types.int64, types.float64, base, types.int64, types.int64, types.int64, types.int64, types.int64)

    def codegen(context, builder, signature, args):  # type: ignore[no-untyped-def]
        double = ir.DoubleType()
        pointer = double.as_pointer()
        function = ir.FunctionType(ir.VoidType(), [double] + [pointer] * 5)
        target = builder.inttoptr(args[0], function.as_pointer())
        array = cgutils.create_struct_proxy(signature.args[2])(context, builder, value=args[2])
        pointers = [builder.gep(array.data, [offset]) for offset in args[3:]]
        builder.call(target, [args[1], *pointers])
        return context.get_dummy_value()

    return sig, codegen

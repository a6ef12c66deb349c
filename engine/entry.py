"""The engine called by its address, so that it is compiled once, and not once more inside each function that calls it.

The address stands in the integers of every run, as those of the kernels do.
"""

from numba import types
from numba.core import cgutils
from numba.extending import intrinsic
from stickslip.engine.call import pointer_to
from stickslip.engine.layout import ENGINE
from stickslip.logs.compiled import njit

_INTS, _FLOATS = types.CPointer(types.int64), types.CPointer(types.float64)
# of ``advance.advance``
ADVANCE = types.int64(
    _INTS, _FLOATS, _FLOATS, types.int64, _FLOATS, types.int64, _FLOATS, types.float64, types.boolean
)  # fmt: skip
# of ``advance_to`` as Python calls it
ADVANCE_TO = types.int64(
    types.int64[::1], types.float64[::1], types.float64[:, ::1], types.float64[::1], types.float64[:, ::1],
    types.float64, types.boolean,
)  # fmt: skip


@njit(cache=True, nogil=True, error_model="numpy")
def advance_to(ints, floats, buffer, grid, rows, t_end, last):  # type: ignore[no-untyped-def]
    """Advance a run: see ``advance.advance``.  All arrays are contiguous."""
    return call_advance(
        ints[ENGINE], pointer_to(ints), pointer_to(floats), pointer_to(buffer), buffer.shape[0], pointer_to(grid),
        grid.shape[0], pointer_to(rows), t_end, last,
    )  # fmt: skip


@intrinsic
def call_advance(typingctx, where, I, W, EV, room, times, n_times, log, t_end, last):  # type: ignore[no-untyped-def]
    """Call the engine at address ``where``."""

    def codegen(context, builder, signature, args):  # type: ignore[no-untyped-def]
        calling, result = context.call_conv, ADVANCE.return_type
        target = builder.inttoptr(args[0], calling.get_function_type(result, ADVANCE.args).as_pointer())
        status, value = calling.call_function(builder, target, result, ADVANCE.args, args[1:])
        with cgutils.if_unlikely(builder, status.is_error):
            calling.return_status_propagate(builder, status)
        return value

    return ADVANCE.return_type(types.int64, *ADVANCE.args), codegen

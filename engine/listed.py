"""Timetables: rows of a time and the values that are in force from then on, read in place by all runs at once.

A row's values stand behind the block's parameters, where its kernels read them, until the next row's time.  ``COUNT``
is the cursor: how many rows have been passed.  A table stays where numpy keeps it; ``TABLE`` is its address.
"""

import numpy as np
from llvmlite import ir
from numba import types
from numba.extending import intrinsic
from stickslip.engine.layout import COUNT, TABLE, TABLE_ROWS, TABLE_VALUES, TABLE_WIDTH
from stickslip.logs.compiled import njit


@intrinsic
def number_at(typingctx, address, index):  # type: ignore[no-untyped-def]
    """Return the float number ``index`` of the array at ``address``."""
    sig = types.float64(types.int64, types.int64)

    def codegen(context, builder, signature, args):  # type: ignore[no-untyped-def]
        pointer = builder.inttoptr(args[0], ir.DoubleType().as_pointer())
        return builder.load(builder.gep(pointer, [args[1]]))

    return sig, codegen


@njit(cache=True, error_model="numpy", inner=True)
def listed_time(I, row):  # type: ignore[no-untyped-def]
    """Return the time of the next row of a block's timetable, infinity behind the last."""
    if I[row + COUNT] >= I[row + TABLE_ROWS]:
        return np.inf
    return number_at(I[row + TABLE], I[row + COUNT] * I[row + TABLE_WIDTH])


@njit(cache=True, error_model="numpy", inner=True)
def put_row(I, W, row, which):  # type: ignore[no-untyped-def]
    """Put the values of one row in force."""
    first = which * I[row + TABLE_WIDTH]
    for i in range(1, I[row + TABLE_WIDTH]):
        W[I[row + TABLE_VALUES] + i - 1] = number_at(I[row + TABLE], first + i)


@njit(cache=True, error_model="numpy", inner=True)
def find_row(I, W, row, before):  # type: ignore[no-untyped-def]
    """Pass all rows before a time (the run begins there) and put the last of them in force."""
    low, high = 0, I[row + TABLE_ROWS]
    while low < high:
        middle = (low + high) // 2
        if number_at(I[row + TABLE], middle * I[row + TABLE_WIDTH]) < before:
            low = middle + 1
        else:
            high = middle
    I[row + COUNT] = low
    put_row(I, W, row, max(0, low - 1))

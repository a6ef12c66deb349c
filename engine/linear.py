"""Linear systems of a stiff step: LU with partial pivoting that skips zeros, and solves with the packed factors.

Process models couple each state to few others, so most of the matrix and of its factors is zero.
"""

from numba import njit

from engine.layout import N_STATES, O_JAC, O_LU, O_PIVOT


@njit(cache=True, error_model="numpy")
def factorise(I, W, diagonal):  # type: ignore[no-untyped-def]
    """LU-factorise ``diagonal - J`` and pack the factors; return whether the matrix is regular."""
    n = I[N_STATES]
    jac, lu, pivot = I[O_JAC], I[O_LU], I[O_PIVOT]
    columns = pivot + n  # scratch: nonzero columns of the pivot row
    for i in range(n * n):
        W[lu + i] = -W[jac + i]
    for i in range(n):
        W[lu + i * n + i] += diagonal
    for col in range(n):
        best = col
        for i in range(col + 1, n):
            if abs(W[lu + i * n + col]) > abs(W[lu + best * n + col]):
                best = i
        W[pivot + col] = best
        if W[lu + best * n + col] == 0.0:
            return False
        if best != col:
            for j in range(n):
                keep = W[lu + col * n + j]
                W[lu + col * n + j] = W[lu + best * n + j]
                W[lu + best * n + j] = keep
        count = 0
        for j in range(col + 1, n):
            if W[lu + col * n + j] != 0.0:
                W[columns + count] = j
                count += 1
        inverse = 1.0 / W[lu + col * n + col]
        for i in range(col + 1, n):
            if W[lu + i * n + col] != 0.0:
                factor = W[lu + i * n + col] * inverse
                W[lu + i * n + col] = factor
                for m in range(count):
                    j = int(W[columns + m])
                    W[lu + i * n + j] -= factor * W[lu + col * n + j]
    _pack(I, W)
    return True


@njit(cache=True, error_model="numpy")
def _pack(I, W):  # type: ignore[no-untyped-def]
    """Write, row after row, how many entries L and U have left and right of the diagonal, and (column, value) each."""
    n = I[N_STATES]
    lu, at = I[O_LU], I[O_PIVOT] + n
    for i in range(n):
        for side in range(2):
            head = at
            at += 1
            first, stop = (0, i) if side == 0 else (i + 1, n)
            for j in range(first, stop):
                value = W[lu + i * n + j]
                if value != 0.0:
                    W[at] = j
                    W[at + 1] = value
                    at += 2
            W[head] = at  # where the next list begins


@njit(cache=True, error_model="numpy")
def solve(I, W, b):  # type: ignore[no-untyped-def]
    """Solve in place with the packed factors for the right-hand side at ``W[b]``."""
    n = I[N_STATES]
    lu, pivot = I[O_LU], I[O_PIVOT]
    for i in range(n):
        swap = int(W[pivot + i])
        if swap != i:
            keep = W[b + i]
            W[b + i] = W[b + swap]
            W[b + swap] = keep
    at = pivot + n
    upper = pivot + n * (2 * n + 3)  # scratch: where the U list of each row begins
    for i in range(n):
        end = int(W[at])
        total = W[b + i]
        for m in range(at + 1, end, 2):
            total -= W[m + 1] * W[b + int(W[m])]
        W[b + i] = total
        W[upper + i] = end
        at = int(W[end])
    for i in range(n - 1, -1, -1):
        start = int(W[upper + i])
        total = W[b + i]
        for m in range(start + 1, int(W[start]), 2):
            total -= W[m + 1] * W[b + int(W[m])]
        W[b + i] = total / W[lu + i * n + i]

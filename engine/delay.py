"""Dead time, exactly: the delayed signal is read from a ring of step records, never approximated by lags.

Each accepted step leaves one record: start, length, smoothness of its start, and five equidistant values of the
signal, read back by fourth-order Lagrange interpolation.  A jump that enters the delay leaves it ``theta``
later as a breakpoint at which the integrator stops; what follows it around a loop gets smoother by one order
each time and is dropped once smoother than the integrator can notice.
"""

import numpy as np
from numba import njit

from engine.layout import BREAK, CAPACITY, D_H, D_LEVEL, D_SIZE, D_T, D_V, DELAY, HEAD, TAIL, P

SMOOTH = 9.0  # level of a record whose start is an ordinary step end
DROPPED = 5.0  # a breakpoint this smooth is below the order of the integrator


@njit(cache=True, error_model="numpy")
def delayed(I, W, row, t):  # type: ignore[no-untyped-def]
    """Return the value that entered the delay ``theta`` seconds before ``t`` (p = theta, value before start)."""
    base = I[row + DELAY]
    cap = I[row + CAPACITY]
    head = I[row + HEAD]
    tail = I[row + TAIL]
    theta = W[I[row + P]]
    if head == tail or t < W[base + (tail % cap) * D_SIZE + D_T] + theta:
        return W[I[row + P] + 1]
    low, high = tail, head - 1  # record numbers; the ring index is the number modulo the capacity
    while low < high:
        mid = (low + high + 1) // 2
        if W[base + (mid % cap) * D_SIZE + D_T] + theta <= t:  # the same sum as a breakpoint: no rounding between
            low = mid
        else:
            high = mid - 1
    at = base + (low % cap) * D_SIZE
    s = 4.0 * (t - (W[at + D_T] + theta)) / W[at + D_H]
    v = at + D_V
    s1, s2, s3, s4 = s - 1.0, s - 2.0, s - 3.0, s - 4.0
    return (
        W[v] * s1 * s2 * s3 * s4 / 24.0
        - W[v + 1] * s * s2 * s3 * s4 / 6.0
        + W[v + 2] * s * s1 * s3 * s4 / 4.0
        - W[v + 3] * s * s1 * s2 * s4 / 6.0
        + W[v + 4] * s * s1 * s2 * s3 / 24.0
    )


@njit(cache=True, error_model="numpy")
def open_record(I, W, row, t, h, level):  # type: ignore[no-untyped-def]
    """Start the record of the step ``[t, t + h]`` and return where its five values go, or -1 if the ring is full."""
    base = I[row + DELAY]
    cap = I[row + CAPACITY]
    theta = W[I[row + P]]
    while I[row + HEAD] - I[row + TAIL] >= 2:
        second = base + ((I[row + TAIL] + 1) % cap) * D_SIZE
        if W[second + D_T] > t - theta:
            break
        I[row + TAIL] += 1
    if I[row + HEAD] - I[row + TAIL] >= cap:
        return -1
    if I[row + BREAK] < I[row + TAIL]:
        I[row + BREAK] = I[row + TAIL]
    at = base + (I[row + HEAD] % cap) * D_SIZE
    W[at + D_T] = t
    W[at + D_H] = h
    W[at + D_LEVEL] = level
    I[row + HEAD] += 1
    return at + D_V


@njit(cache=True, error_model="numpy")
def next_break(I, W, row, t):  # type: ignore[no-untyped-def]
    """Return (time, level) of the next breakpoint that leaves the delay after ``t``, or (inf, smooth)."""
    base = I[row + DELAY]
    cap = I[row + CAPACITY]
    theta = W[I[row + P]]
    while I[row + BREAK] < I[row + HEAD]:
        at = base + (I[row + BREAK] % cap) * D_SIZE
        if W[at + D_LEVEL] < DROPPED and W[at + D_T] + theta > t:
            return W[at + D_T] + theta, W[at + D_LEVEL]
        I[row + BREAK] += 1
    return np.inf, SMOOTH

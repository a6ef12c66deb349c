"""Dead time, exactly: the delayed signal is read from a ring of step records, never approximated by lags.

Each accepted step leaves one record: start, length, smoothness of its start, and eight equidistant values of the
signal, read back by the polynomial of degree 7 through them (barycentric formula): what follows the state loses
nothing, because no method's dense output is of higher degree.

A jump that enters the delay leaves it ``theta`` later as a breakpoint; what follows gets smoother by one order each
time it passes an integrator.  So a record knows how smooth its start is: the level of what happened at that instant
plus the integrators between there and this dead time (``structure.reach``).  ``record`` says which of the breakpoints
the integrator must stop at.

All comparisons are made on the side of the exit, with ``start + theta`` rounded once: a breakpoint and the value
read there then agree to the last bit.
"""

import math

import numpy as np
from stickslip.engine.layout import (
    ATOL,
    BREAK,
    CAPACITY,
    D_H,
    D_LEVEL,
    D_NODES,
    D_SIZE,
    D_T,
    D_V,
    DELAY,
    ENTERS,
    HEAD,
    REACH,
    RTOL,
    TAIL,
    P,
)
from stickslip.logs.compiled import njit

SMOOTH = 9  # level of a record whose start is an ordinary step end
LAST = D_NODES - 1.0
WEIGHTS = np.array([(-1.0) ** m * math.comb(D_NODES - 1, m) for m in range(D_NODES)])


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
    s = min(LAST, LAST * (t - (W[at + D_T] + theta)) / W[at + D_H])  # what stands still may be asked for beyond
    top, bottom = 0.0, 0.0
    for m in range(D_NODES):
        gap = s - m
        if gap == 0.0:
            return W[at + D_V + m]
        weight = WEIGHTS[m] / gap
        top += weight * W[at + D_V + m]
        bottom += weight
    return top / bottom


@njit(cache=True, error_model="numpy", inner=True)
def happens(I, row, level):  # type: ignore[no-untyped-def]
    """Let what happens at the outputs of a block reach the dead times: 0 a jump, 1 a kink, ..."""
    reach = I[row + REACH]
    if reach != 0:
        for k in range(I[reach]):
            to, passes = I[reach + 1 + 2 * k], I[reach + 2 + 2 * k]
            I[to + ENTERS] = min(I[to + ENTERS], level + passes)


@njit(cache=True, error_model="numpy", inner=True)
def open_record(I, W, row, t, h):  # type: ignore[no-untyped-def]
    """Start the record of the step ``[t, t + h]`` and return where its values go, or -1 if the ring is full."""
    base = I[row + DELAY]
    cap = I[row + CAPACITY]
    theta = W[I[row + P]]
    while I[row + HEAD] - I[row + TAIL] >= 2:
        second = base + ((I[row + TAIL] + 1) % cap) * D_SIZE
        if W[second + D_T] + theta > t - 2e-6 * (1.0 + 1e-6 * abs(t)):  # rates look a little into the past
            break
        I[row + TAIL] += 1
    if I[row + HEAD] - I[row + TAIL] >= cap:
        return -1
    if I[row + BREAK] < I[row + TAIL]:
        I[row + BREAK] = I[row + TAIL]
    at = base + (I[row + HEAD] % cap) * D_SIZE
    W[at + D_T] = t
    W[at + D_H] = h
    W[at + D_LEVEL] = I[row + ENTERS]
    I[row + ENTERS] = SMOOTH
    I[row + HEAD] += 1
    return at + D_V


@njit(cache=True, error_model="numpy", inner=True)
def close_record(I, W, row, nothing):  # type: ignore[no-untyped-def]
    """Take a jump that turned out to be none (less than the share ``nothing`` of W[ATOL], W[RTOL]) as a kink."""
    base, cap, last = I[row + DELAY], I[row + CAPACITY], I[row + HEAD] - 1
    at = base + (last % cap) * D_SIZE
    if W[at + D_LEVEL] == 0.0:
        before = W[I[row + P] + 1]
        if last > I[row + TAIL]:
            before = W[base + ((last - 1) % cap) * D_SIZE + D_V + D_NODES - 1]
        if abs(W[at + D_V] - before) <= nothing * (W[ATOL] + W[RTOL] * abs(before)):
            W[at + D_LEVEL] = 1.0


@njit(cache=True, error_model="numpy", inner=True)
def let_out(I, W, row, t):  # type: ignore[no-untyped-def]
    """Let the breakpoints that have left the delay by ``t`` happen at its output, and look at the next one."""
    base, cap, theta = I[row + DELAY], I[row + CAPACITY], W[I[row + P]]
    while I[row + BREAK] < I[row + HEAD]:
        at = base + (I[row + BREAK] % cap) * D_SIZE
        if W[at + D_LEVEL] < SMOOTH:
            if W[at + D_T] + theta > t:
                break
            happens(I, row, int(W[at + D_LEVEL]))
        I[row + BREAK] += 1

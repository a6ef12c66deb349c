"""Ten coupled loops with dead times of about one second, all different: the diagram, and the same by hand in C.

Each loop's process also feels the measured values of the next two loops, so every breakpoint of one dead time reaches
all others.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable

import numpy as np
from stickslip.blocks import PI, FirstOrder, Step, Sum
from stickslip.diagram import wire
from stickslip.diagram.diagram import Diagram

from benchmarks.peers.c_library import library

A, B = 0.2, -0.1  # how the next two loops are felt
STEP_AT = 1.0  # [s]


def numbers(count: int) -> np.ndarray:
    """Return SP, K_p, T_i, tau, theta of each loop, (count, 5); theta lies within 1 .. 1.3 s."""
    i = np.arange(count)
    theta = 1.0 + 0.3 * np.modf(np.sqrt(i + 2.0))[0]
    return np.column_stack([0.3 + 0.02 * i, np.full(count, 0.3), 8.0 + 0.3 * i, 9.0 + 0.5 * i, theta])


def diagram(count: int = 10) -> Diagram:
    """Return the coupled loops as a diagram with the signals PV0, PV1, ..."""
    blocks = []
    for i, (SP, K_p, T_i, tau, theta) in enumerate(numbers(count).tolist()):
        weights = {f"OP{i}": 1.0, f"PV{(i + 1) % count}": A, f"PV{(i + 2) % count}": B}
        blocks += [
            Step(f"SP{i}", SP, at=STEP_AT),
            PI(K_p, T_i, low=-np.inf, high=np.inf, name=f"C{i}", inputs=[f"SP{i}", f"PV{i}"], outputs=f"OP{i}"),
            Sum(f"u{i}", weights),
            FirstOrder(1.0, tau, theta, name=f"P{i}", inputs=f"u{i}", outputs=f"PV{i}"),
        ]
    return wire(blocks, name="coupled loops")


def prepare(duration: int, steps: int, count: int = 10) -> Callable[[], np.ndarray]:
    """Return a function of no arguments that runs the C program with ``steps`` steps a second.

    It returns the PVs at whole seconds, shape (duration + 1, count).  Raises NoCompiler.
    """
    call = library("coupled_loops").coupled_loops
    whole, real, pointer = ctypes.c_int, ctypes.c_double, ctypes.c_void_p
    call.restype = whole
    call.argtypes = [whole, real, real, pointer, real, whole, whole, pointer]
    p = np.ascontiguousarray(numbers(count))

    def once() -> np.ndarray:
        log = np.zeros((duration + 1, count))
        if call(count, A, B, p.ctypes.data, 1.0 / steps, steps, duration + 1, log.ctypes.data):
            raise MemoryError(f"{count} loops with {steps} steps a second are too many for the C program")
        return log

    return once

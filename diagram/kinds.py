"""The kind of a process: after a step of OP its PV settles, or runs away.  The diagram shows it, other loops closed.

    G(s) = PV(s)/OP(s), this loop open:    |G(j w/10)|/|G(j w)| = 1 where it settles, 10 where it integrates

at w = 1e-6 rad/s, so that a time constant of weeks counts as an integrator.  A controller that measures this OP (a
valve position controller) sees nothing of it, for it would wind up; sticky stems are seen without friction.  Where OP
moves nothing at the start (a shut valve, a limit), or blocks have no slopes, nothing is stated.
"""

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from stickslip.diagram.diagram import Diagram
    from stickslip.diagram.linear.slopes import Slopes
    from stickslip.logs import LoopSignals
    from stickslip.logs.tags import Process

SLOWEST = 1e-6  # rad/s
KINDS: "dict[Process, float]" = {"self_regulating": 0.0, "integrating": 1.0}  # powers of 1/s
NEAR = 0.2  # of such a power, within which a process is of that kind


def known_loops(diagram: "Diagram") -> "dict[str, LoopSignals]":
    """Return the loops of a diagram, with the kind of process that it tells, else that of the unit of PV.

    >>> from stickslip.plant.loops import integrating_loop, self_regulating_loop
    >>> [known_loops(loop)["controller"].process for loop in (integrating_loop(), self_regulating_loop())]
    ['integrating', 'self_regulating']
    """
    kinds = _kinds(diagram)
    return {name: replace(loop, process=kinds.get(name, loop.process)) for name, loop in diagram.loops.items()}


def _kinds(diagram: "Diagram") -> "dict[str, Process]":
    """Return name of the controller -> kind of process, of those controllers of which the diagram tells it."""
    from stickslip.diagram.linear.slopes import slopes

    try:
        near = slopes(diagram.with_blocks([block.without_friction() for block in diagram.blocks]))
    except (ArithmeticError, ValueError):  # blocks without slopes where the diagram starts
        return {}
    readers = [(block.name, label) for block in diagram.blocks for label in block.input_labels]
    measured = {name: loop.pv for name, loop in diagram.loops.items()}
    found: dict[str, Process] = {}
    for name, loop in diagram.loops.items():
        M = near.M.copy()
        M[[i for i, (reader, label) in enumerate(readers) if label == loop.op == measured.get(reader)]] = 0.0
        power = _power(replace(near, M=M), loop.op, loop.pv)
        found.update((name, kind) for kind, ideal in KINDS.items() if abs(power - ideal) < NEAR)
    return found


def _power(near: "Slopes", op: str, pv: str) -> float:
    """Return n where PV/OP goes as 1/s^n at the slowest, NaN where OP moves nothing."""
    A, B, C, D = near.joined([op])
    i, j = near.signals.index(pv), near.signals.index(op)
    gains = []
    for w in (SLOWEST, 0.1 * SLOWEST):
        try:
            gains.append(abs(C[i] @ np.linalg.solve(1j * w * np.eye(len(A)) - A, B[:, j]) + D[i, j]))
        except np.linalg.LinAlgError:
            return math.nan
    return math.log10(gains[1] / gains[0]) if min(gains) > 0.0 else math.nan

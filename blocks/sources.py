"""Deterministic signals: constant and step (more in the sibling files of this room).

step   y = before for t < at, else after
"""

import math
from typing import Any

from blocks.block import Block, Kernels
from blocks.ports import Port


def _step_out(t: float, x: Any, d: Any, u: Any, p: Any, y: Any) -> None:
    y[0] = p[1] if t >= p[2] else p[0]


def _step_next(t: float, x: Any, d: Any, u: Any, p: Any, out: Any) -> None:
    out[0] = p[2] if t < p[2] else math.inf


class Step(Block):
    """A step: ``before`` until ``at`` [s], ``after`` from then on.

    >>> float(Step("SP", after=0.5).output(0.0, [], [])[0])
    0.5
    """

    ports_out = (Port("out"),)
    kernels = Kernels(out=_step_out, next_time=_step_next, feeds=False)

    def __init__(
        self, signal: str, after: float = 1.0, before: float = 0.0, at: float = 0.0, unit: str = "", name: str = ""
    ) -> None:
        super().__init__(
            name=name or signal,
            params={"before": before, "after": after, "at": at},
            outputs=signal,
            units={"out": unit},
        )

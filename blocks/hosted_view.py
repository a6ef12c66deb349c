"""What python-control sees of a block that runs in Python: it takes its samples at the solver's own steps.

    sample k at k dt: the straight line between the two calls around that time; outputs hold in between

Python-control calls an output at trial times, goes back, and at the end once in order at every time asked for.  So
samples behind the present time are forgotten and taken again: what a response shows is what its own rows give.
The state is no number, so it is kept here, not among python-control's states: one response at a time, and
``ct.linearize`` sees the first sample.
"""

import math
from typing import Any

import numpy as np

from blocks.block import Block, Floats
from blocks.kernels import Host, Kernels

EARLY = 1e-9  # share of dt by which rounding may make a sample early


class HostedView(Block):
    """``block`` as python-control sees it in a continuous diagram; what is no number (NaN) is seen as 0."""

    def __init__(self, block: Block, feeds: bool) -> None:
        assert block.host is not None
        self.role, self.plays = block.role, block.plays
        self.ports_in, self.ports_out = block.ports_in, block.ports_out
        self.kernels = Kernels(feeds=feeds)
        self.runs: Host = block.host
        self.every = block.period
        self.taken: list[tuple[float, float, Floats, Any, Floats]] = []  # called at, next time due, u, state, outputs
        super().__init__(
            name=block.name, params=block.params, start_output=block.y0, inputs=list(block.input_labels),
            outputs=list(block.output_labels), units=block.units, spans=block.spans,
        )  # fmt: skip

    def _out(self, t: float, x: Floats, u: Floats) -> Floats:
        while self.taken and self.taken[-1][0] >= t:
            self.taken.pop()
        u = np.array(u, dtype=float)
        if not self.taken:
            state, said = self.runs.init(self._p_now), self.y0
            due = self.every * math.ceil(t / self.every - EARLY)
            before, u_before = t, u
        else:
            before, due, u_before, state, said = self.taken[-1]
        while due <= t + EARLY * self.every:
            share = min((due - before) / (t - before), 1.0) if t > before else 1.0
            state, y = self.runs.step(due, state, u_before + share * (u - u_before), self._p_now)
            said, due = np.asarray(y, dtype=float), due + self.every
        if len(self.taken) > 1 and self.taken[-2][1] == due:  # between two samples the last call is enough
            self.taken.pop()
        self.taken.append((t, due, u, state, said))
        return np.nan_to_num(said, nan=0.0)

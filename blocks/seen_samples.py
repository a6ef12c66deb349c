"""The samples of a block as python-control sees them: taken at the solver's own steps.

    sample k at its time: the straight line between the two calls around that time; outputs hold in between

Python-control calls an output at trial times, goes back, and at the end once in order at every time asked for.  So
samples behind the present time are forgotten and taken again: what a response shows is what its own rows give.
The state is kept here, not among python-control's states; each response begins without any (``ControlView``).
"""

from typing import Any, NamedTuple, Protocol

import numpy as np
from stickslip.blocks.kernels import Floats

EARLY = 1e-9  # share of a period by which rounding may make a sample early


class Sampled(Protocol):
    """A block that takes samples, or its view in python-control."""

    def state_before(self) -> Any:
        """Return the state before the first sample."""

    def take(self, t: float, state: Any, u: Floats) -> tuple[Any, Floats]:
        """Take the sample ``u`` at ``t`` [s]; return the next state and the outputs."""

    def next_sample(self, t: float, later: bool = False) -> float:
        """Return the first sampling instant at ``t`` [s] or later, or the first one really ``later``."""


class Taken(NamedTuple):
    """How it stands after a call at ``t`` with ``u``: the next sample falls due, state, and outputs held."""

    t: float
    u: Floats
    due: float
    state: Any
    said: Floats


class SeenSamples:
    """The samples taken in one response; ``said`` is what stands at the outputs before the first one."""

    def __init__(self, said: Floats) -> None:
        self.said = said
        self.taken: list[Taken] = []

    def at(self, block: Sampled, t: float, u: Floats) -> Taken:
        """Take what falls due until ``t`` [s], where the inputs are ``u``; return how it stands then."""
        while self.taken and self.taken[-1].t >= t:
            self.taken.pop()
        u = np.array(u, dtype=float)
        last = self.taken[-1] if self.taken else Taken(t, u, block.next_sample(t), block.state_before(), self.said)
        due, state, said = last.due, last.state, last.said
        while due <= t:
            share = (due - last.t) / (t - last.t) if due < t else 1.0
            state, said = block.take(due, state, last.u + share * (u - last.u))
            due = block.next_sample(due, later=True)
        if len(self.taken) > 1 and self.taken[-2].due == due:  # between two samples the last call is enough
            self.taken.pop()
        self.taken.append(Taken(t, u, due, state, said))
        return self.taken[-1]

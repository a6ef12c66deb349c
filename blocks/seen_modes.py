"""The modes of a block as python-control sees them: kept from one call of its solver to the next.

    mode at t: what the block was at the call before t, changed by where its states and inputs have gone since

Python-control calls at trial times and goes back: then calls at the present time or behind it are forgotten.  At the
end it asks a diagram once in order at every time of the response: that shows the modes of the calls so far.
What happens within a step is on the straight line between its ends, and what comes and goes within one is missed;
give ``max_step``.
The modes are kept here, not among python-control's states; each response begins without any (``ControlView``).
"""

from typing import NamedTuple, Protocol

import numpy as np
from stickslip.blocks.kernels import Floats


class Call(NamedTuple):
    """A call at ``t`` [s]: the states, the inputs, and the memories after it."""

    t: float
    x: Floats
    u: Floats
    memory: Floats


class Remembering(Protocol):
    """A block whose modes depend on what they were."""

    def seen_after(self, before: Call | None, x: Floats, u: Floats) -> Floats:
        """Return the memories at the states ``x`` and the inputs ``u``, after the call ``before`` if there was one."""


class SeenModes:
    """The calls of one response that still count."""

    def __init__(self) -> None:
        self.calls: list[Call] = []

    def shown(self, t: float) -> Floats | None:
        """Return the memories at ``t`` [s] if a call there or behind it tells them."""
        if not self.calls or self.calls[-1].t < t:
            return None
        return next((call.memory for call in reversed(self.calls) if call.t <= t), self.calls[0].memory)

    def at(self, block: Remembering, t: float, x: Floats, u: Floats) -> Floats:
        """Return the memories of the block at ``t`` [s], where its states and inputs are ``x`` and ``u``."""
        while self.calls and self.calls[-1].t >= t:
            self.calls.pop()
        memory = block.seen_after(self.calls[-1] if self.calls else None, x, u)
        if len(self.calls) > 1 and np.array_equal(self.calls[-2].memory, memory):  # the last of those alike is enough
            self.calls.pop()
        self.calls.append(Call(t, np.array(x, dtype=float), np.array(u, dtype=float), memory))
        return memory

"""One block as the engine sees it."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from stickslip.engine.call import Kernel
from stickslip.engine.layout import CONTINUOUS, DEAD_TIME, HOSTED, LINK_IN, LINK_OUT, SAMPLED

__all__ = ["CONTINUOUS", "DEAD_TIME", "HOSTED", "LINK_IN", "LINK_OUT", "SAMPLED", "FlatBlock", "Floats", "Ints"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True)
class FlatBlock:
    """One block as the engine sees it: kernels, sizes, start values, and which signals it reads.

    ``kind`` is CONTINUOUS, SAMPLED, HOSTED, DEAD_TIME or one end of a link.  ``wires`` and ``first_signal`` are indices
    into the signals of the whole diagram.  ``host`` runs a hosted block in Python: ``init(p) -> state`` and
    ``step(t, state, u, p) -> (state, y)``.
    """

    name: str
    kind: int
    p: Floats
    x0: Floats
    d0: Floats
    y0: Floats
    wires: tuple[int, ...]
    first_signal: int
    out: Kernel | None = None
    der: Kernel | None = None
    zc: Kernel | None = None
    jump: Kernel | None = None
    step: Kernel | None = None
    next_time: Kernel | None = None
    n_events: int = 0
    rates: bool = False
    rate_modes: tuple[float, ...] = ()  # in which event functions look at rates; (): in all
    jumps: bool = False
    shows_modes: bool = False  # whether out reads modes or memories
    feeds: bool | tuple[int, ...] = True
    timed: bool = False  # whether out or der reads the time
    linear: bool = False  # whether out and der are affine in states, inputs and time in each mode, between instants
    logged: bool = False
    period_at: int = -1  # where the sampling period stands in p
    offset_at: int = -1  # where the first sampling instant stands in p
    listed: int = 0  # numbers in a row of its timetable; 0: it has none
    capacity: int = 0  # of the delay ring
    host: Any = None

    @property
    def kernels(self) -> tuple[Kernel, ...]:
        """Return its kernels, those that it has."""
        found = (self.out, self.der, self.zc, self.jump, self.step, self.next_time)
        return tuple(kernel for kernel in found if kernel is not None)

    @property
    def switches(self) -> bool:
        """Whether a transition may change what it puts out at that instant."""
        return self.n_events > 0 and (self.jumps or self.shows_modes)

    @property
    def unforeseen(self) -> bool:
        """Whether it follows the time in a way that nothing but its values tells."""
        announced = self.next_time is not None or self.listed > 0
        return self.kind == CONTINUOUS and self.timed and not self.linear and not announced

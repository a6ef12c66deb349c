"""The kernels of a block: plain functions of numbers and arrays, and what the engine must know about them.

    out        outputs y(t, x, u)                  der   state rates dx/dt
    zc         event functions, fire when > 0      jump  the transition of event ``out[0]``: changes d and x
    step       one sample: changes d, writes y     next_time  next discontinuity of a source, largest step

Each has the shape ``(t, x, d, u, p, out)``: time [s], states, modes and memories, inputs, parameters, and what it
writes; or it is written with names, ``der(L, F, A, k)``, and returns its values (see ``named_kernels``).
"""

import dis
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import cache
from types import CodeType
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Kernel = Callable[[float, Any, Any, Any, Any, Any], None]
Function = Callable[..., Any]  # of names, or a kernel


@cache
def _reads(code: CodeType, argument: str) -> bool:
    """Return whether a function does anything with one of its arguments."""
    used = (step.argval for step in dis.get_instructions(code) if "LOAD" in step.opname)
    return any(argument in (name if isinstance(name, tuple) else (name,)) for name in used)


def fed_by(follows: Iterable[bool]) -> bool | tuple[int, ...]:
    """Return ``feeds`` of a block, for each of whose inputs is said whether its outputs follow it at once.

    >>> fed_by([False, False]), fed_by([False, True]), fed_by([True, True])
    (False, (1,), True)
    """
    each = list(follows)
    return any(each) if all(each) or not any(each) else tuple(i for i, yes in enumerate(each) if yes)


@dataclass(frozen=True)
class Kernels:
    """The functions of a block and what the engine must know about them.

    ``n_events``: how many event functions ``zc`` writes.  ``feeds``: whether outputs depend on inputs at the same
    instant; of a continuous block also the numbers of those inputs, where others only move its states.  ``timed``:
    whether ``out`` or ``der`` reads the time ``t``.  ``rates``: whether ``zc`` and ``jump`` want the input rates behind
    the inputs in ``u``; ``rate_modes``: the modes, whole numbers, in which ``zc`` looks at them (none named: in all).
    ``jumps``: whether outputs jump when an event fires, as a stem without mass does when it slips.  ``linear``: whether
    ``out`` and ``der`` are affine in states, inputs and time, in each mode, while no event function is positive and
    between the instants of ``next_time``; such blocks run faster.
    """

    out: Function | None = None
    der: Function | None = None
    zc: Function | None = None
    jump: Function | None = None
    step: Function | None = None
    next_time: Function | None = None
    n_events: int = 0
    feeds: bool | tuple[int, ...] = True
    rates: bool = False
    rate_modes: tuple[float, ...] = ()
    timed: bool = False
    jumps: bool = False
    linear: bool = False

    def follows(self, inputs: int) -> list[bool]:
        """Return for each of so many inputs whether outputs follow it at once."""
        return [self.feeds if isinstance(self.feeds, bool) else i in self.feeds for i in range(inputs)]

    @property
    def shows_modes(self) -> bool:
        """Whether ``out`` reads modes or memories: then the outputs are right once the block has settled."""
        return self.out is not None and _reads(self.out.__code__, "d")


class Host(Protocol):
    """A part of a sampled block that runs in Python between two calls of the engine: a filter, a detector.

    The state is any value; it goes in and comes out, so the block itself never changes.
    """

    def init(self, p: Floats) -> Any:
        """Return the state before the first sample."""

    def step(self, t: float, state: Any, u: Floats, p: Floats) -> tuple[Any, Sequence[float]]:
        """Take the sample ``u`` at time ``t`` [s]; return the next state and the outputs to hold."""

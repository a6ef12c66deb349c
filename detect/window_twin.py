"""The streaming twin of every method: its own where it has one, else one that works on a window of the last samples.

    own        ``init``, ``update`` and ``verdict`` of the module (``area_ratio``, ``hagglund2011``)
    pooled     the window, and the pieces that the method remembers of what has left it (``pool``)
    window     the window alone: the verdict is that of ``detect`` on the last half to whole of ``WINDOW`` samples

Memory is bounded in each case, and a window costs nothing until someone asks for a verdict.
"""

from dataclasses import dataclass, field, replace
from types import ModuleType
from typing import Any, Protocol

from stickslip.detect.prepare.prepared import Prepared
from stickslip.detect.stream import Buffer, LoopFacts, Sample
from stickslip.detect.verdict import Verdict

WINDOW = 2048  # samples held at most; half of them at least, once so many have come


class Twin(Protocol):
    """A method that follows a loop sample by sample; the state goes in and comes out (see ``stream``)."""

    def init(self, p: Any, facts: LoopFacts | None = None) -> Any:
        """The state before the first sample."""
        ...

    def update(self, p: Any, state: Any, t: float, sample: Sample) -> Any:
        """The state after one more sample at time t [s]."""
        ...

    def verdict(self, p: Any, state: Any) -> Verdict:
        """The present verdict of the method."""
        ...


@dataclass(frozen=True)
class Watched:
    """The rows of the window, what the method remembers of older ones, and what is known of the loop."""

    facts: LoopFacts
    buffer: Buffer = field(default_factory=Buffer)
    past: Any = None


@dataclass(frozen=True)
class WindowTwin:
    """A method on a window of ``window`` samples; raises ValueError for a window below 64.

    >>> import math
    >>> from stickslip.detect.methods import harmonics
    >>> twin, p = WindowTwin(harmonics), harmonics.Params()
    >>> state = twin.init(p)
    >>> for t in range(300):
    ...     state = twin.update(p, state, t, Sample(pv=math.sin(t / 8), op=50 + math.cos(t / 8), sp=0.0))
    >>> twin.verdict(p, state).code
    'integrating_unknown'
    """

    method: Any
    window: int = WINDOW

    def __post_init__(self) -> None:
        if self.window < 64:
            raise ValueError(f"window = {self.window} samples; give at least 64")

    def init(self, p: Any, facts: LoopFacts | None = None) -> Watched:
        """The state before the first sample."""
        return Watched(facts or LoopFacts())

    def update(self, p: Any, state: Watched, t: float, sample: Sample) -> Watched:
        """The state after one more sample at time t [s]; raises ValueError when t does not advance."""
        buffer = state.buffer.append(t, sample)
        if len(buffer) < self.window:
            return replace(state, buffer=buffer)
        past = state.past
        if hasattr(self.method, "remember"):
            past = self.method.remember(p, past, Prepared(buffer.record(state.facts)))
        return replace(state, buffer=buffer.last(self.window // 2), past=past)

    def verdict(self, p: Any, state: Watched) -> Verdict:
        """Return the verdict so far; it is that of the method's ``detect`` as long as the record fits the window."""
        if len(state.buffer) == 0:
            return Verdict.not_applicable(self.method.CARD.name, "too_few_cycles", "No sample has arrived yet.")
        loop = Prepared(state.buffer.record(state.facts))
        if hasattr(self.method, "recall"):
            said: Verdict = self.method.recall(p, state.past, loop)
            return said
        judged: Verdict = self.method.detect(loop, p)
        return judged


def twin_of(method: ModuleType | Any) -> Twin:
    """The streaming twin of a method: the module itself where it has ``init``, ``update`` and ``verdict``.

    >>> from stickslip.detect.methods import area_ratio, play_fit
    >>> twin_of(area_ratio) is area_ratio, twin_of(play_fit).window
    (True, 2048)
    """
    own = all(hasattr(method, part) for part in ("init", "update", "verdict"))
    twin: Twin = method if own else WindowTwin(method)
    return twin

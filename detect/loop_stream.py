"""One loop watched by many methods with one window of samples between them.

A method takes part in one of three ways, which its functions tell:

    remember, recall        it keeps more than the window: ``remember(p, past, loop) -> past`` is called with the window
                            each time its older half is about to go, ``recall(p, past, loop)`` gives the verdict
    init, update, verdict   its exact twin follows every sample in a state of its own (see ``stream``)
    detect alone            it judges the window, as it would judge a record

The window holds from half of ``window`` to ``window`` rows, 40 bytes each.  It is prepared once for a verdict, however
many methods ask, and not at all while nobody does.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from importlib import import_module
from itertools import repeat
from types import ModuleType
from typing import Any, Literal

from stickslip.detect.diagnosis import ask
from stickslip.detect.prepare.prepared import Prepared
from stickslip.detect.stream import Buffer, LoopFacts, Sample
from stickslip.detect.verdict import Verdict

Way = Literal["memory", "twin", "window"]


@dataclass(frozen=True, eq=False)
class LoopStream:
    """The state of all methods after the samples so far; a value, as every state of a stream.

    methods : by default all of ``stickslip.detect.METHODS``
    window : most rows held [-]
    buffer, states, ways
        The rows, the state of each method and how it takes part; worked out, not given.

    Raises ValueError for a window below 64 rows.

    >>> import numpy as np
    >>> from stickslip.detect.methods import area_ratio
    >>> stream = LoopStream(LoopFacts(process="self_regulating"), (area_ratio,))
    >>> for t in range(600):
    ...     part = 1 - 1.916 * np.exp(-(t % 25) / 8)
    ...     stream = stream.update(t, Sample(pv=part if t % 50 < 25 else -part, op=50 + np.sin(t), sp=0.0))
    >>> [v.verdict for v in stream.verdicts()]
    ['stiction']
    """

    facts: LoopFacts = field(default_factory=LoopFacts)
    methods: Sequence[Any] = ()
    window: int = 2048
    buffer: Buffer = field(default_factory=Buffer)
    states: tuple[Any, ...] = ()
    ways: tuple[Way, ...] = ()

    def __post_init__(self) -> None:
        if self.ways:
            return  # one more sample of a stream that has begun
        if self.window < 64:
            raise ValueError(f"window = {self.window} rows; give at least 64")
        if not self.methods:
            from stickslip.detect import METHODS

            object.__setattr__(self, "methods", METHODS)
        object.__setattr__(self, "methods", tuple(self.methods))
        object.__setattr__(self, "ways", tuple(map(_way, self.methods)))
        object.__setattr__(self, "states", tuple(map(_start, self.methods, self.ways, repeat(self.facts))))

    def update(self, t: float, sample: Sample) -> "LoopStream":
        """The stream after one more sample at time t [s]; raises ValueError when t does not advance."""
        buffer = self.buffer.append(t, sample)
        states = list(self.states)
        for k, update, p in self._twins:
            states[k] = update(p, states[k], t, sample)
        if len(buffer) >= self.window:
            loop = Prepared(buffer.record(self.facts))
            for k, way in enumerate(self.ways):
                if way == "memory":
                    states[k] = self.methods[k].remember(self.methods[k].Params(), states[k], loop)
            buffer = buffer.last(self.window // 2)
        return self._next(buffer, tuple(states))

    @cached_property
    def _twins(self) -> tuple[tuple[int, Any, Any], ...]:
        """Place, function and parameters of each method that follows every sample."""
        twins = ((k, self.methods[k]) for k, way in enumerate(self.ways) if way == "twin")
        return tuple((k, method.update, method.Params()) for k, method in twins)

    def _next(self, buffer: Buffer, states: tuple[Any, ...]) -> "LoopStream":
        """The same stream with other rows and states; ``dataclasses.replace`` costs more than all else a sample."""
        following = object.__new__(type(self))
        own = following.__dict__
        own.update(self.__dict__, buffer=buffer, states=states)
        own.pop("loop", None)  # the window that was prepared for the verdicts before
        return following

    @cached_property
    def loop(self) -> Prepared:
        """The window, made ready once for all methods; raises ValueError before the first sample."""
        if len(self.buffer) == 0:
            raise ValueError("no sample has arrived yet; update the stream first")
        return Prepared(self.buffer.record(self.facts))

    def verdicts(self) -> tuple[Verdict, ...]:
        """The present verdict of every method, in their order."""
        return tuple(map(self._said, self.methods, self.ways, self.states))

    def _said(self, method: Any, way: Way, state: Any) -> Verdict:
        if len(self.buffer) == 0:
            said = Verdict.not_applicable(method.CARD.name, "too_few_cycles", "No sample has arrived yet.")
        elif way == "memory":
            said = method.recall(method.Params(), state, self.loop)
        elif way == "twin":
            said = method.verdict(method.Params(), state)
        else:
            return ask(method, self.loop)
        return replace(said, experimental=said.experimental or method.CARD.experimental)

    def __getstate__(self) -> dict[str, Any]:
        """Name the modules, which cannot be pickled themselves; the prepared window is made anew."""
        kept = {name: getattr(self, name) for name in ("facts", "window", "buffer", "states", "ways")}
        named = [method.__name__ if isinstance(method, ModuleType) else method for method in self.methods]
        return kept | {"methods": named}

    def __setstate__(self, state: dict[str, Any]) -> None:
        methods = tuple(import_module(m) if isinstance(m, str) else m for m in state["methods"])
        self.__dict__.update(state | {"methods": methods})


def _way(method: Any) -> Way:
    if hasattr(method, "remember") and hasattr(method, "recall"):
        return "memory"
    exact = method.CARD.streams == "exact" and all(hasattr(method, part) for part in ("init", "update", "verdict"))
    return "twin" if exact else "window"


def _start(method: Any, way: Way, facts: LoopFacts) -> Any:
    """The state of a method before the first sample; None for one that only looks at the window."""
    return method.init(method.Params(), facts) if way == "twin" else () if way == "memory" else None

"""One loop watched by many methods with one window of samples between them.

A method takes part in one of three ways, which its functions tell:

    remember, recall        it keeps more than the window: `remember(p, past, loop) -> past` is called with the window
                            each time its older half is about to go, `recall(p, past, loop)` gives the verdict
    init, update, verdict   its exact twin follows every sample in a state of its own (see `stream`)
    detect alone            it judges the window, as it would judge a record

The window holds from half of `window` to `window` rows, 40 bytes each.  It is prepared once for a verdict, however
many methods ask, and not at all while nobody does.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from importlib import import_module
from types import ModuleType
from typing import Any

from detect.diagnosis import ask
from detect.prepare.prepared import Prepared
from detect.stream import Buffer, LoopFacts, Sample
from detect.verdict import Verdict

__all__ = ["LoopStream"]


@dataclass(frozen=True, eq=False)
class LoopStream:
    """The state of all methods after the samples so far; a value, as every state of a stream.

    facts : LoopFacts
    methods : tuple of Method
        By default all of `detect.METHODS`.
    window : int
        Most rows held [-].

    Raises ValueError for a window below 64 rows.

    >>> import numpy as np
    >>> from detect.methods import area_ratio
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

    def __post_init__(self) -> None:
        if self.window < 64:
            raise ValueError(f"window = {self.window} rows; give at least 64")
        if not self.methods:
            from detect import METHODS

            object.__setattr__(self, "methods", METHODS)
        object.__setattr__(self, "methods", tuple(self.methods))
        if not self.states:
            object.__setattr__(self, "states", tuple(_start(method, self.facts) for method in self.methods))

    def update(self, t: float, sample: Sample) -> LoopStream:
        """The stream after one more sample at time t [s]; raises ValueError when t does not advance."""
        buffer = self.buffer.append(t, sample)
        states = tuple(
            method.update(method.Params(), state, t, sample) if _is_twin(method) else state
            for method, state in zip(self.methods, self.states, strict=True)
        )
        if len(buffer) < self.window:
            return replace(self, buffer=buffer, states=states)
        if any(map(_remembers, self.methods)):
            loop = Prepared(buffer.record(self.facts))
            states = tuple(
                method.remember(method.Params(), state, loop) if _remembers(method) else state
                for method, state in zip(self.methods, states, strict=True)
            )
        return replace(self, buffer=buffer.last(self.window // 2), states=states)

    @cached_property
    def loop(self) -> Prepared:
        """The window, made ready once for all methods; raises ValueError before the first sample."""
        if len(self.buffer) == 0:
            raise ValueError("no sample has arrived yet; update the stream first")
        return Prepared(self.buffer.record(self.facts))

    def verdicts(self) -> tuple[Verdict, ...]:
        """What every method says now, in their order."""
        return tuple(self._said(method, state) for method, state in zip(self.methods, self.states, strict=True))

    def _said(self, method: Any, state: Any) -> Verdict:
        if len(self.buffer) == 0:
            said = Verdict.not_applicable(method.CARD.name, "too_few_cycles", "No sample has arrived yet.")
        elif _remembers(method):
            said = method.recall(method.Params(), state, self.loop)
        elif _is_twin(method):
            said = method.verdict(method.Params(), state)
        else:
            return ask(method, self.loop)
        return replace(said, experimental=said.experimental or method.CARD.experimental)

    def __getstate__(self) -> dict[str, Any]:
        """Name the modules, which cannot be pickled themselves; the prepared window is made anew."""
        kept = {name: getattr(self, name) for name in ("facts", "window", "buffer", "states")}
        named = [method.__name__ if isinstance(method, ModuleType) else method for method in self.methods]
        return kept | {"methods": named}

    def __setstate__(self, state: dict[str, Any]) -> None:
        methods = tuple(import_module(m) if isinstance(m, str) else m for m in state["methods"])
        self.__dict__.update(state | {"methods": methods})


def _remembers(method: Any) -> bool:
    return hasattr(method, "remember") and hasattr(method, "recall")


def _is_twin(method: Any) -> bool:
    exact = getattr(method.CARD, "streams", "no") == "exact"
    return exact and not _remembers(method) and all(hasattr(method, part) for part in ("init", "update", "verdict"))


def _start(method: Any, facts: LoopFacts) -> Any:
    """The state of a method before the first sample; None for one that only looks at the window."""
    if _is_twin(method):
        return method.init(method.Params(), facts)
    return () if _remembers(method) else None

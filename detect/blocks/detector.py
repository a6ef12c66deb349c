"""A streaming detector wired into a diagram.

    in   SP, PV   measurement span as a fraction      OP   controller output as a fraction of its span
    out  index    the method's index [-], NaN while there is none
         verdict  0 not applicable, 1 inconclusive, 2 no stiction, 3 stiction

The block takes a sample every ``dt`` seconds, first at t = 0, and asks the method for a verdict every
``verdict_every`` samples, because a verdict costs far more than a sample.  Its answer follows its inputs at once,
so a loop that is closed over it needs a lag.  Under python-control it takes its samples at the solver's own steps
(``stickslip.blocks.seen_samples``), and its index is 0 while there is none.
"""

from dataclasses import dataclass
from importlib import import_module
from types import ModuleType
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from stickslip.blocks import Block, Kernels, Labels, Port
from stickslip.blocks.ports import BlockError, require
from stickslip.blocks.role import Role
from stickslip.detect.stream import LoopFacts, Sample
from stickslip.detect.window_twin import twin_of
from stickslip.detect.words import WORDS

PROCESSES = ("self_regulating", "integrating", "unknown")


class DetectorState(NamedTuple):
    """The method's own state, samples taken, and what was said last: (index, verdict)."""

    method: Any
    taken: int
    said: tuple[float, float]


@dataclass(frozen=True)
class DetectorHost:
    """Runs the streaming twin of one method (``stickslip.detect.window_twin``)."""

    method: ModuleType
    params: Any
    facts: LoopFacts
    verdict_every: int

    def __getstate__(self) -> dict[str, Any]:
        """Name the module of the method, which cannot be pickled itself."""
        named = {"method": self.method.__name__} if isinstance(self.method, ModuleType) else {}
        return self.__dict__ | named

    def __setstate__(self, state: dict[str, Any]) -> None:
        if isinstance(state["method"], str):
            state = state | {"method": import_module(state["method"])}
        self.__dict__.update(state)

    def init(self, p: NDArray[np.float64]) -> DetectorState:
        """Return the state before the first sample."""
        return DetectorState(twin_of(self.method).init(self.params, self.facts), 0, (np.nan, 0.0))

    def step(
        self, t: float, state: DetectorState, u: NDArray[np.float64], p: NDArray[np.float64]
    ) -> tuple[DetectorState, tuple[float, float]]:
        """Take one sample; return the next state and (index, verdict)."""
        sample = Sample(pv=float(u[1]), op=float(u[2]), sp=float(u[0]))
        twin = twin_of(self.method)
        inner = twin.update(self.params, state.method, t, sample)
        taken, said = state.taken + 1, state.said
        if taken % self.verdict_every == 0:
            verdict = twin.verdict(self.params, inner)
            said = (np.nan if verdict.index is None else verdict.index, WORDS[verdict.verdict].number)
        return DetectorState(inner, taken, said), said


def _check_method(method: Any) -> None:
    """Refuse what is no detector, and a detector that cannot take one sample after the other."""
    if not hasattr(method, "CARD"):
        raise BlockError(f"method = {method!r} is no detector; give a module of detect with a CARD, e.g. area_ratio")
    card = method.CARD
    if card.kind == "gate":
        why = "It is an oscillation detector, and gives no verdict."
    elif card.streams == "no":
        why = card.stream_note
    elif not hasattr(method, "Params"):
        why = "It has no Params."
    else:
        return
    raise BlockError(
        f"{card.name}: method = {card.name!r}; this method does not stream, so it cannot be a block: {why} Give one "
        f"that does, e.g. area_ratio, or judge the log after the run: diagnose(run.log.loop(), [{card.name}])"
    )


class DetectorBlock(Block):
    """A method (a module of ``detect``) that follows its loop, sampled every ``dt`` [s].

    How it follows is on its card: sample by sample, or in a window of the last samples
    (``stickslip.detect.window_twin``).

    Raises ``BlockError`` if the method is none or does not stream, the process is of no known kind, or ``dt`` is
    not positive.

    >>> from stickslip.detect.methods import area_ratio
    >>> from stickslip.detect.blocks import DetectorBlock
    >>> DetectorBlock(area_ratio, dt=1.0).output_labels
    ['index', 'verdict']
    """

    role = Role.DETECTOR
    ports_in = (Port("SP"), Port("PV"), Port("OP"))
    ports_out = (Port("index"), Port("verdict"))
    kernels = Kernels()  # the answer depends on the sample taken at the same instant
    period_param = "dt"

    def __init__(
        self, method: ModuleType, dt: float, *, verdict_every: int = 30, params: Any = None,
        process: str = "self_regulating", name: str = "", inputs: Labels = None, outputs: Labels = None,
    ) -> None:  # fmt: skip
        _check_method(method)
        name = name or method.CARD.name
        require(process in PROCESSES, name, "process", process, "it is none of the known kinds", f"give {PROCESSES}")
        facts = LoopFacts(name=name, process=process, op_span=(0.0, 1.0))
        require(verdict_every >= 1, name, "verdict_every", verdict_every, "it counts samples", "give 1 or more")
        self.host = DetectorHost(method, method.Params() if params is None else params, facts, verdict_every)
        super().__init__(name=name, params={"dt": dt}, start_output=[np.nan, 0.0], inputs=inputs, outputs=outputs)

    @staticmethod
    def check(params: Any, name: str) -> None:
        """Refuse a sampling period that is not positive."""
        require(params["dt"] > 0.0, name, "dt", params["dt"], "a sampling period must be positive", "give seconds")

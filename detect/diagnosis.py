"""One loop in, one answer out: the verdicts of all methods, put together in plain words."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, get_args

from detect.judge.advice import advice
from detect.judge.combine import Combine, WeightedVote
from detect.method import Method
from detect.prepare.fact import Fact
from detect.prepare.harris import Harris
from detect.prepare.prepared import Prepared, prepared
from detect.prepare.process_kind import kind_of_tag
from detect.verdict import Verdict, Word
from logs import LoopRecord

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["SCHEMA", "Diagnosis", "ask", "diagnose"]

SCHEMA = "stickslip.check/1"


@dataclass(frozen=True, eq=False)
class Diagnosis:
    """The answer on one loop.

    loop : str
    verdict : as in ``Verdict``
    probability : float or None
        Probability of stiction [-]; None, because no calibration on known valves stands behind it yet.
    reason : str
        What was found, in words and numbers, and what would settle an open case.
    assumptions : tuple of str
        What was taken for granted, one sentence each.
    methods : tuple of Verdict
    conditions : tuple of Fact
        Measured properties of the record.
    record : LoopRecord
    performance : Harris or None
        How near the loop is to minimum variance; None where e does not move.
    """

    loop: str
    verdict: Word
    probability: float | None
    reason: str
    assumptions: tuple[str, ...]
    methods: tuple[Verdict, ...]
    conditions: tuple[Fact, ...] = field(repr=False)
    record: LoopRecord = field(repr=False)
    performance: Harris | None = None

    def to_dict(self) -> dict[str, Any]:
        """The answer as plain values that JSON can hold, schema "stickslip.check/1"."""
        return {
            "schema": SCHEMA,
            "loop": self.loop,
            "verdict": self.verdict,
            "probability": self.probability,
            "reason": self.reason,
            "assumptions": list(self.assumptions),
            "methods": [method.to_dict() for method in self.methods],
        }

    def plot(self, words: bool = True) -> Figure:
        """Trend of SP, PV and OP, the PV-OP curve, and the evidence of the first method that can draw it.

        ``words=False`` leaves verdict and reason to the text around the picture.
        """
        from detect.figures.diagnosis import plot_diagnosis

        return plot_diagnosis(self, words)


def diagnose(
    record: LoopRecord | Prepared, methods: Sequence[Method] | None = None, combine: Combine | None = None
) -> Diagnosis:
    """Put every method to a record and say what follows.

    ``methods`` are modules or other objects with ``CARD`` and ``detect(record) -> Verdict``, of this package or not; by
    default all of ``detect.METHODS``. One whose card says ``experimental`` is shown and has no vote. ``combine`` makes
    one word of the verdicts that vote; by default ``WeightedVote`` (see ``judge.combine``).

    Raises TypeError for a method without ``detect``, or whose answer is no Verdict, and ValueError if ``combine`` gives
    no word of a verdict.

    >>> import numpy as np
    >>> t = np.arange(1000.0)
    >>> loop = LoopRecord.from_arrays(t, pv=np.sin(t / 8), op=50 + np.cos(t / 8), sp=0 * t, name="FIC211")
    >>> answer = diagnose(loop)
    >>> answer.verdict, answer.to_dict()["schema"]
    ('inconclusive', 'stickslip.check/1')
    """
    if methods is None:
        from detect import METHODS

        methods = METHODS
    loop = prepared(record)
    record = loop.record
    verdicts = tuple(ask(method, loop) for method in methods)
    votes = [v for v in verdicts if not v.experimental]
    word = (combine or WeightedVote())(votes)
    if word not in get_args(Word):
        raise ValueError(f"combine gave {word!r}; it must return one of {', '.join(get_args(Word))}")
    trials = _on_trial([v for v in verdicts if v.experimental])
    next_step = advice(word, {v.code for v in votes if v.code is not None}, record.mv is not None)
    return Diagnosis(
        loop=record.name,
        verdict=word,
        probability=None,
        reason=" ".join([_reason(word, votes), *trials, next_step]),
        assumptions=_assumptions(loop),
        methods=verdicts,
        conditions=loop.health,
        record=record,
        performance=loop.performance,
    )


def ask(method: Method, loop: Prepared) -> Verdict:
    """The verdict of one method, with the method's picture and standing.

    Raises TypeError for a method without ``detect``, or whose answer is no Verdict.
    """
    if not callable(getattr(method, "detect", None)):
        raise TypeError(
            f"method {method!r} has no function detect(record); give a module of detect, such as area_ratio, or an "
            "object with CARD and detect"
        )
    verdict = method.detect(loop)
    if not isinstance(verdict, Verdict):
        raise TypeError(f"detect(record) of method {method!r} gave {verdict!r}; it must return a detect.Verdict")
    draw = verdict.draw or getattr(method, "draw", None)
    on_trial = verdict.experimental or getattr(getattr(method, "CARD", None), "experimental", False)
    return replace(verdict, draw=draw, experimental=on_trial)


def _on_trial(verdicts: Sequence[Verdict]) -> list[str]:
    """One sentence on the methods without a vote: one by name, several by their count."""
    if len(verdicts) <= 1:
        return [f"{_name(v)} (experimental, no vote): {_sentence(v)}" for v in verdicts]
    words = {"stiction": "say stiction", "no_stiction": "say no stiction", "inconclusive": "cannot tell",
             "not_applicable": "do not apply"}  # fmt: skip
    counts = [f"{n} {said}" for word, said in words.items() if (n := sum(v.verdict == word for v in verdicts))]
    return [f"Of {len(verdicts)} experimental methods, which have no vote, {', '.join(counts)}."]


_HEAD: dict[str, str] = {
    "stiction": "The valve looks sticky.",
    "no_stiction": "No sign of stiction in this oscillation.",
    "inconclusive": "The record does not settle whether the valve sticks.",
    "not_applicable": "No method can judge this record.",
}


def _reason(word: Word, votes: Sequence[Verdict]) -> str:
    shown = [v for v in votes if v.verdict == word or word == "inconclusive"]
    against = [v for v in votes if v.verdict in ("stiction", "no_stiction") and v not in shown]
    return " ".join(
        [
            _HEAD[word],
            *(f"{_name(v)}: {_sentence(v)}" for v in shown),
            *(f"{_name(v)} disagrees and is outweighed: {_sentence(v)}" for v in against),
        ]
    )


def _name(v: Verdict) -> str:
    return v.method.replace("_", " ").capitalize()


def _sentence(v: Verdict) -> str:
    return v.reason if v.reason.endswith(".") else v.reason + "."


def _assumptions(loop: Prepared) -> tuple[str, ...]:
    record = loop.record
    found = [*record.notes, *(fact.text for fact in loop.health if fact.present and not fact.forbids)]
    if record.sp is None:
        found.append("SP is taken as constant, at the mean of PV.")
    if record.mode is None:
        found.append("The controller is taken to be in automatic: no mode is logged.")
    if record.process == "unknown":
        found.append((kind_of_tag(record) if any(f.code == "signal_missing" for f in loop.present) else loop.kind).text)
    if record.op_percent is None:
        found.append("OP is taken to be within its limits: its span is not known.")
    found.append("The oscillation is taken to be the loop's own, not an outside disturbance.")
    found.append("No probability is given: the methods are not yet calibrated on known valves.")
    return tuple(dict.fromkeys(found))

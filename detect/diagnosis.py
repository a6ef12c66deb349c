"""One loop in, one answer out: the verdicts of all methods, put together in plain words."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

from detect.method import Method
from detect.prepare.conditions import Fact
from detect.prepare.harris import Harris
from detect.prepare.prepared import Prepared, prepared
from detect.verdict import Verdict, Word
from logs import LoopRecord

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["SCHEMA", "Diagnosis", "diagnose"]

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


def diagnose(record: LoopRecord | Prepared, methods: Sequence[Method] | None = None) -> Diagnosis:
    """Put every method to a record and say what follows.

    ``methods`` are modules or other objects with ``CARD`` and ``detect(record) -> Verdict``, of this package or not; by
    default all of ``detect.METHODS``. One whose card says ``experimental`` is shown and has no vote.

    Raises TypeError for a method without ``detect``, or whose answer is no Verdict.

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
    verdicts = tuple(_ask(method, loop) for method in methods)
    votes = [v for v in verdicts if not v.experimental]
    word = _together(votes)
    trials = _on_trial([v for v in verdicts if v.experimental])
    return Diagnosis(
        loop=record.name,
        verdict=word,
        probability=None,
        reason=" ".join([_reason(word, votes), *trials, _next_step(word, votes, record)]),
        assumptions=_assumptions(record),
        methods=verdicts,
        conditions=loop.facts,
        record=record,
        performance=loop.performance,
    )


def _ask(method: Method, loop: Prepared) -> Verdict:
    """The verdict of one method, with the method's picture and standing."""
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


def _together(votes: Sequence[Verdict]) -> Word:
    """Agreement of the methods that decided; a contradiction is inconclusive."""
    words = {v.verdict for v in votes}
    decided = words & {"stiction", "no_stiction"}
    if len(decided) == 1:
        return next(iter(decided))
    return "inconclusive" if decided or "inconclusive" in words else "not_applicable"


_HEAD: dict[str, str] = {
    "stiction": "The valve looks sticky.",
    "no_stiction": "No sign of stiction in this oscillation.",
    "inconclusive": "The record does not settle whether the valve sticks.",
    "not_applicable": "No method can judge this record.",
}


def _reason(word: Word, votes: Sequence[Verdict]) -> str:
    shown = [v for v in votes if v.verdict == word or word == "inconclusive"]
    return " ".join([_HEAD[word], *(f"{_name(v)}: {_sentence(v)}" for v in shown)])


def _name(v: Verdict) -> str:
    return v.method.replace("_", " ").capitalize()


def _sentence(v: Verdict) -> str:
    return v.reason if v.reason.endswith(".") else v.reason + "."


def _next_step(word: Word, votes: Sequence[Verdict], record: LoopRecord) -> str:
    codes = {v.code for v in votes}
    test = "step the OP in manual by 0.5 to 1 % at a time, both ways, and watch for moves that fail to show in PV"
    logged = record.mv is not None
    stem = "see where the logged stem rests while OP moves" if logged else "log the stem position"
    if word == "stiction":
        return f"To prove it and size it: {stem}, or {test}."
    if word == "no_stiction":
        return (
            "To tell tight tuning from an outside wave: put the loop in manual for a few periods; "
            "a wave that stays comes from outside."
        )
    if "constant_signal" in codes or "signal_missing" in codes:
        return "Check the transmitter and the historian tag."
    if "manual_mode" in codes:
        return "Log a stretch in automatic."
    if "undersampled" in codes or "compressed" in codes or "quantised" in codes:
        return "To settle it: log raw values, uncompressed, at 20 samples per period or more."
    if "op_saturated" in codes:
        return "To settle it: log a stretch with OP away from its limits."
    if "sp_not_constant" in codes:
        return "To settle it: hold the set point (or open the cascade) for ten periods."
    if "no_oscillation" in codes:
        return f"A sticky valve need not cycle; to check: {test}."
    if "too_few_cycles" in codes:
        return "To settle it: log ten periods at a fixed set point."
    if word == "inconclusive":
        return (
            f"To settle it: {stem} for ten periods; or put the loop in manual for a few periods (a wave that stays "
            f"comes from outside), then {test}."
        )
    return f"To settle it: {stem} for ten periods, or {test}."


def _assumptions(record: LoopRecord) -> tuple[str, ...]:
    found = list(record.notes)
    if record.sp is None:
        found.append("SP is taken as constant, at the mean of PV.")
    if record.mode is None:
        found.append("The controller is taken to be in automatic: no mode is logged.")
    if record.process == "unknown":
        if record.measurement == "level":
            found.append("The process is taken as integrating: the tag is a level.")
        else:
            found.append("The process is taken as self-regulating: nothing says otherwise.")
    if record.op_percent is None:
        found.append("OP is taken to be within its limits: its span is not known.")
    found.append("The oscillation is taken to be the loop's own, not an outside disturbance.")
    found.append("No probability is given: the methods are not yet calibrated on known valves.")
    return tuple(dict.fromkeys(found))

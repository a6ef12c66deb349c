"""One loop in, one answer out: the calibrated verdict in plain words, with the answer of every method."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from stickslip.detect.health.fact import Fact
from stickslip.detect.judge.answer import Amount, Answer
from stickslip.detect.judge.grounds import Picture
from stickslip.detect.judge.over_days import answer_over_days
from stickslip.detect.method import Method
from stickslip.detect.prepare.prepared import Prepared, prepared
from stickslip.detect.signals.harris import Harris
from stickslip.detect.signals.swing import amplitude
from stickslip.detect.stem.process_kind import kind_of_tag
from stickslip.detect.verdict import Figure, Verdict
from stickslip.detect.words import WORDS, Word
from stickslip.logs import LoopRecord
from stickslip.logs.chances import chance
from stickslip.logs.processes import one_thread
from stickslip.logs.shown import Shown

SCHEMA = "stickslip.check/2"
UNSURE, SURE = 0.2, 0.85  # probabilities between which simulation beside the model tells more, above in open answers


@dataclass(frozen=True, eq=False, repr=False)
class Diagnosis(Shown):
    """The answer on one loop.

    verdict : as in ``Verdict``
    probability : probability of stiction [-], calibrated on simulated loops. It is None if the model did not run: the
        record was refused, the stem was logged, or PV itself shows that the valve slips.
    causes : probability of each cause [-], largest first; "stiction" is one of them
    amount : mapping of "S" and "J" to Amount, or None; sizes with their 90 % intervals, where the verdict is stiction
    detection_limit : (float, unit) or None; S above which a stick would have shown in this record
    reason : what was found, in words and numbers
    action : what to do, who does it, and the test that confirms it
    assumptions : what was taken for granted, one sentence each
    conditions : measured properties of the record
    performance : how near the loop is to minimum variance; None where e does not move
    period : of the oscillation [s]; None where the loop does not oscillate
    amplitude : half of the width that holds 90 % of PV [unit of PV]
    because : up to three reasons, drawn from what decided the model's verdict; empty where it is open or the stem was
        seen
    picture : what decided, and so is drawn: "learnt" (the pattern that the model knows), "dead_travel", "stem_play",
        "slips" or "still_stem"; "" where nothing did
    """

    loop: str
    verdict: Word
    probability: float | None
    causes: Mapping[str, float]
    amount: Mapping[str, Amount] | None
    detection_limit: tuple[float, str] | None
    reason: str
    action: str
    assumptions: tuple[str, ...]
    methods: tuple[Verdict, ...]
    conditions: tuple[Fact, ...] = field(repr=False)
    record: LoopRecord = field(repr=False)
    performance: Harris | None = None
    period: float | None = None
    amplitude: float | None = None
    because: tuple[str, ...] = ()
    picture: Picture = ""

    @property
    def headline(self) -> str:
        """The result in one line."""
        sure = "" if self.probability is None else f" ({chance(self.probability)})"
        sizes = "".join(f"; {name} {size}" for name, size in (self.amount or {}).items())
        return f"{self.loop or 'loop'}: {WORDS[self.verdict].spoken}{sure}{sizes}"

    @property
    def unsure(self) -> bool:
        """Whether the calibrated model is so uncertain that loops simulated like the record say more."""
        p = self.probability
        most = 1.0 if self.verdict == "inconclusive" else SURE
        return p is not None and self.verdict != "no_stiction" and UNSURE <= p <= most

    def to_dict(self) -> dict[str, Any]:
        """The answer as plain values that JSON can hold, schema "stickslip.check/2"."""
        limit = self.detection_limit
        return {
            "schema": SCHEMA, "loop": self.loop, "verdict": self.verdict, "probability": self.probability,
            "period_s": self.period, "amplitude": self.amplitude, "causes": dict(self.causes),
            "amount": None if self.amount is None else {name: size.to_dict() for name, size in self.amount.items()},
            "detection_limit": None if limit is None else {"value": limit[0], "unit": limit[1]},
            "reason": self.reason, "because": list(self.because), "action": self.action,
            "assumptions": list(self.assumptions), "methods": [method.to_dict() for method in self.methods],
        }  # fmt: skip

    def plot(self, words: bool = True) -> Figure:
        """Trend of SP, PV and OP, the PV-OP curve, and what decided the verdict.

        ``words=False`` leaves verdict and reason to the text around the picture.
        """
        from stickslip.detect.figures.diagnosis import plot_diagnosis

        return plot_diagnosis(self, words)


@one_thread
def diagnose(record: LoopRecord | Prepared | Any, methods: Sequence[Method] | None = None) -> Diagnosis:
    """Judge one loop: a record, or a frame of pandas, polars or pyarrow.

    ``methods`` are modules or other objects with ``CARD`` and ``detect(record) -> Verdict``, of this package or not; by
    default all of ``stickslip.detect.METHODS``. Their answers are for comparison. The verdict is the calibrated one
    (``judge.answer``), here and everywhere.

    Raises TypeError for a method without ``detect``, or whose answer is no Verdict.

    >>> import numpy as np
    >>> t = np.arange(1000.0)
    >>> loop = LoopRecord.from_arrays(t, pv=np.sin(t / 8), op=50 + np.cos(t / 8), sp=0 * t, name="FIC211")
    >>> answer = diagnose(loop)
    >>> answer.verdict, answer.to_dict()["schema"]
    ('inconclusive', 'stickslip.check/2')
    """
    from stickslip.detect import METHODS

    loop = prepared(record)
    record = loop.record
    verdicts = tuple(ask(method, loop) for method in (METHODS if methods is None else methods))
    found = answer_over_days(loop)
    sizes = {name: size for name, size in (("S", found.S), ("J", found.J)) if size is not None}
    return Diagnosis(
        loop=record.name, verdict=found.word, probability=found.probability, causes=found.causes,
        amount=sizes or None, detection_limit=found.limit,
        reason=" ".join([WORDS[found.word].sentence, found.reason, _beside(verdicts)]).strip(), action=found.action,
        assumptions=_assumptions(loop, found), methods=verdicts, conditions=loop.health, record=record,
        performance=loop.performance, period=loop.period if loop.gate.oscillating else None,
        amplitude=amplitude(record.pv), because=found.because, picture=found.picture,
    )  # fmt: skip


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
        raise TypeError(
            f"detect(record) of method {method!r} gave {verdict!r}; it must return a stickslip.detect.Verdict"
        )
    draw = verdict.draw or getattr(method, "draw", None)
    on_trial = verdict.experimental or getattr(getattr(method, "CARD", None), "experimental", False)
    return replace(verdict, draw=draw, experimental=on_trial)


def _beside(verdicts: Sequence[Verdict]) -> str:
    """One sentence on what the methods that could look say: how many of each verdict, and which accuse; "" for none."""
    verdicts = [v for v in verdicts if v.applicable]
    if not verdicts:
        return ""
    accusing = [v.method for v in verdicts if v.verdict == "stiction"]
    names = f" ({', '.join(accusing)})" if accusing else ""
    counts = [f"{said.counted(n)}{names if word == 'stiction' else ''}" for word, said in WORDS.items()
              if (n := sum(v.verdict == word for v in verdicts))]  # fmt: skip
    plural = "s" if len(verdicts) > 1 else ""
    return f"Of {len(verdicts)} method{plural} that could look, {', '.join(counts)}."


def _assumptions(loop: Prepared, found: Answer) -> tuple[str, ...]:
    record = loop.record
    said = [
        *record.notes,
        *found.assumptions,
        *(fact.text for fact in loop.health if fact.present and not fact.forbids),
    ]
    if record.sp is None:
        said.append("SP is taken as constant, at the mean of PV.")
    if record.mode is None and not any(fact.code == "manual_mode" for fact in loop.present):
        said.append("The controller is taken to be in automatic: no mode is logged.")
    if record.process == "unknown":
        unreadable = any(fact.code == "signal_missing" for fact in loop.present)
        said.append((kind_of_tag(record) if unreadable else loop.kind).text)
    if not record.measurement:
        said.append(
            "Neither the tag nor --measurement says what is measured; the record is judged for any measurement."
        )
    if record.op_percent is None:
        said.append("OP is taken to be within its limits: its span is not known, and sizes are in the unit of OP.")
    if found.probability is not None:
        said.append(
            "The probability is calibrated on simulated loops of which half had a sticky valve; where fewer valves "
            "stick, it is lower."
        )
    return tuple(dict.fromkeys(said))

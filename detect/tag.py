"""One valve from many records: one verdict, with what each record says and adds."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from stickslip.detect.diagnosis import Diagnosis
from stickslip.detect.judge.answer import Answer
from stickslip.detect.judge.over_days import answer_over_days
from stickslip.detect.judge.pooled import evidence_of_all, pooled
from stickslip.detect.likelihood.pooled import Day, Evidence
from stickslip.detect.prepare.prepared import prepared
from stickslip.detect.verdict import Figure, Word
from stickslip.detect.words import WORDS
from stickslip.logs.processes import one_thread
from stickslip.logs.shown import Shown

SCHEMA = "stickslip.tag/1"


@dataclass(frozen=True, eq=False, repr=False)
class Tag(Shown):
    """The verdict on one valve from its records.

    tag : str;  records : names of the records, in order
    answer : the pooled answer;  words : the verdict on each record by itself
    evidence : of dead travel, over the records ``counted``; None where none of them can be used
    """

    tag: str
    records: tuple[str, ...]
    answer: Answer
    words: tuple[Word, ...]
    evidence: Evidence | None = field(repr=False)
    counted: tuple[int, ...] = ()

    @property
    def verdict(self) -> Word:
        """The verdict on the valve."""
        return self.answer.word

    @property
    def headline(self) -> str:
        """The result in one line."""
        size = "" if self.answer.S is None else f"; S {self.answer.S}"
        return f"{self.tag}, {len(self.records)} records: {WORDS[self.verdict].spoken}{size}"

    @property
    def rows(self) -> list[list[str]]:
        """A row a record: name, verdict by itself, its S and gain, what it adds to the pool, reversals of its stem."""
        found = []
        for i, (name, word) in enumerate(zip(self.records, self.words, strict=True)):
            day = self._days.get(i)
            cells = ["-"] * 4 if day is None else [f"{day.S:.2g}", f"{day.gain:.3g}", f"{day.adds:.3g}", str(day.turns)]
            found.append([name, WORDS[word].spoken, *cells])
        return found

    @property
    def _days(self) -> dict[int, Day]:
        return {} if self.evidence is None else dict(zip(self.counted, self.evidence.days, strict=True))

    def to_dict(self) -> dict[str, Any]:
        """The verdict as plain values, schema "stickslip.tag/1"."""
        e, days = self.evidence, self._days
        return {
            "schema": SCHEMA,
            "tag": self.tag,
            "verdict": self.verdict,
            "probability": self.answer.probability,
            "S": None if self.answer.S is None else self.answer.S.to_dict(),
            "gain_nats": None if e is None else e.gain,
            "reversals": None if e is None else e.turns,
            "agreeing": None if e is None else e.agreeing,
            "reason": self.answer.reason,
            "action": self.answer.action,
            "records": [
                {"loop": name, "verdict": word}
                | ({"S": days[i].S, "gain_nats": days[i].gain, "adds_nats": days[i].adds} if i in days else {})
                for i, (name, word) in enumerate(zip(self.records, self.words, strict=True))
            ],
        }

    def plot(self) -> Figure:
        """S and gain of every record, and the gain of every S over all of them."""
        from stickslip.detect.figures.tag import plot_tag

        return plot_tag(self)


@one_thread
def judge_tag(tag: str, records: Sequence[Any], answers: Sequence[Answer | Diagnosis] | None = None) -> Tag:
    """Judge one valve by its records, with the ``answers`` on each where they are known.

    Raises ValueError for no record, and TypeError as ``prepared`` does.

    >>> import numpy as np
    >>> from stickslip.detect.stem.stick import stick
    >>> from stickslip.logs import LoopRecord
    >>> t, rng = np.arange(2000.0), np.random.default_rng(1)
    >>> u = 50 + 5 * np.sin(t / 25) + np.sin(t / 80)
    >>> days = [np.concatenate([[50.0], stick(u, 2.0)[:-1]]) + 0.1 * rng.normal(size=2000) for _ in range(2)]
    >>> found = judge_tag("FIC1", [LoopRecord.from_arrays(t, pv=y, op=u, op_span=(0, 100)) for y in days])
    >>> found.evidence.agreeing, bool(found.evidence.low < 2.0 < found.evidence.high)  # the true S is 2
    (2, True)
    """
    loops = [prepared(record) for record in records]
    if not loops:
        raise ValueError(f"records of {tag} is empty; give at least one")
    known = [answer_over_days(loop) for loop in loops] if answers is None else [_answer(a) for a in answers]
    evidence, counted = evidence_of_all(loops)
    found = pooled(loops, known, evidence)
    names = tuple(one.record.name or f"record {i}" for i, one in enumerate(loops, 1))
    return Tag(tag, names, found, tuple(a.word for a in known), evidence, counted)


def _answer(found: Answer | Diagnosis) -> Answer:
    if isinstance(found, Answer):
        return found
    sizes = found.amount or {}
    return Answer(
        found.verdict, found.probability, found.causes, sizes.get("S"), sizes.get("J"), found.detection_limit,
        found.reason, found.action,
    )  # fmt: skip

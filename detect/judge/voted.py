"""The answer that methods give by their votes, in the place of the calibrated one: no probability, no causes."""

from __future__ import annotations

from collections.abc import Sequence

from stickslip.detect.judge.advice import advice
from stickslip.detect.judge.answer import Answer
from stickslip.detect.judge.combine import Combine
from stickslip.detect.verdict import Verdict
from stickslip.detect.words import WORDS, Word

__all__ = ["beside", "voted"]


def voted(verdicts: Sequence[Verdict], combine: Combine, stem_logged: bool) -> Answer:
    """The verdict that ``combine`` makes of the voting methods; those on trial are listed separately.

    Raises ValueError if ``combine`` gives no word of a verdict.
    """
    votes = [v for v in verdicts if not v.experimental]
    word = combine(votes)
    if word not in WORDS:
        raise ValueError(f"combine gave {word!r}; it must return one of {', '.join(WORDS)}")
    trials = _on_trial([v for v in verdicts if v.experimental])
    action = advice(word, {v.code for v in votes if v.code is not None}, stem_logged)
    return Answer(word, None, {}, None, None, None, " ".join([_reason(word, votes), *trials]), action)


def beside(verdicts: Sequence[Verdict]) -> str:
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


def _on_trial(verdicts: Sequence[Verdict]) -> list[str]:
    """One sentence on the methods without a vote: one by name, several by their count."""
    if len(verdicts) <= 1:
        return [f"{_name(v)} (experimental, no vote): {_sentence(v)}" for v in verdicts]
    counts = [said.counted(n) for word, said in WORDS.items() if (n := sum(v.verdict == word for v in verdicts))]
    return [f"Of {len(verdicts)} experimental methods, which have no vote, {', '.join(counts)}."]


def _reason(word: Word, votes: Sequence[Verdict]) -> str:
    shown = [v for v in votes if v.verdict == word or word == "inconclusive"]
    against = [v for v in votes if v.verdict in ("stiction", "no_stiction") and v not in shown]
    return " ".join(
        [
            WORDS[word].sentence,
            *(f"{_name(v)}: {_sentence(v)}" for v in shown),
            *(f"{_name(v)} disagrees and is outweighed: {_sentence(v)}" for v in against),
        ]
    )


def _name(v: Verdict) -> str:
    return v.method.replace("_", " ").capitalize()


def _sentence(v: Verdict) -> str:
    return v.reason if v.reason.endswith(".") else v.reason + "."

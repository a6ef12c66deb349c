"""One valve, many records: one answer, from what every record says and from the evidence that they add up to.

    odds of stiction   = median over the records of the model's odds, and where the pooled evidence calls dead travel or
                         excludes it, times exp((G - g) / 10), within exp(-5) and exp(5),   G its gain, g that of the
                         middle record [nats]
    called             only where a record calls it, or the pooled evidence does; one record has its own answer
    seen               where more than half of the records show the stem or the valve's own slips, these answer
    cleared            only where that is the median, no record calls stiction, and the pooled evidence excludes it

The model errs alike on records of one loop, so its odds are not multiplied; likelihoods are, because each day brings
new noise.  So a weak trace that agrees over weeks is found, and one odd day is not.
"""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from stickslip.detect.judge.actions import CAUSES
from stickslip.detect.judge.answer import LEVEL, LEVELS_CYCLE, Amount, Answer, next_step
from stickslip.detect.judge.features.earned import usable
from stickslip.detect.judge.model import Model, Opinion, calibrated
from stickslip.detect.likelihood.pooled import Evidence, evidence_of
from stickslip.detect.likelihood.words import said
from stickslip.detect.prepare.prepared import PERCENT, Prepared
from stickslip.detect.verdict import Word
from stickslip.logs.chances import chance

TEMPER, MOST = 10.0, 5.0  # nats of evidence that count as one, and the most that count


def evidence_of_all(loops: Sequence[Prepared]) -> tuple[Evidence | None, tuple[int, ...]]:
    """Return the evidence of the records of one valve, and on which it rests; one that is there twice counts once."""
    kept: list[int] = []
    for i, loop in enumerate(loops):
        same = [j for j in kept if np.array_equal(loops[j].record.pv, loop.record.pv, equal_nan=True)]
        if usable(loop) and not same:
            kept.append(i)
    stems = [loops[i].stems for i in kept]
    return (evidence_of([one for one in stems if one is not None]) if kept else None), tuple(kept)


def pooled(
    loops: Sequence[Prepared], answers: Sequence[Answer], found: Evidence | None, model: Model | None = None,
    each: str = "records",
) -> Answer:  # fmt: skip
    """Return the answer on one valve from its records (called ``each``), what is said of them, and their evidence."""
    if len(answers) == 1:
        return answers[0]
    model = model or calibrated()
    seen = [a for a in answers if a.probability is None and a.word == "stiction"]
    judged = [a for a in answers if a.probability is not None]
    percent = all(loop.op_percent(1.0) is not None for loop in loops)
    unit = PERCENT if percent else "in the unit of OP"
    evidence = "" if found is None else said(found, percent)
    if 2 * len(seen) > len(answers):
        first = max(seen, key=lambda a: 0.0 if a.S is None else a.S.value)
        return replace(first, reason=f"In {len(seen)} of {len(answers)} {each}: {first.reason}")
    followed = [a for a in answers if a.probability is None and a.word == "no_stiction"]
    if not judged and followed and not seen:  # by their logged stems; the coarsest says what is excluded
        return max(followed, key=lambda a: 0.0 if a.limit is None else a.limit[0])
    if not judged:
        reason = f"None of the {len(answers)} {each} can be judged. {answers[0].reason}"
        return Answer("not_applicable", None, {}, None, None, None, reason, "")
    names = judged[0].causes
    odds = {name: float(np.median([_odds(a.causes.get(name, 0.0)) for a in judged])) for name in names}
    mean = dict(sorted(odds.items(), key=lambda item: -item[1]))
    total = math.fsum(mean.values())
    plain = Opinion({name: p / total for name, p in mean.items()}, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.0, 0.0)
    opinion = _weighed(plain, found)
    p = opinion.probability
    integrates = any(loop.integrating for loop in loops)
    needed = LEVEL if integrates else model.needed(math.nan if found is None else found.gain)
    called = any(a.word == "stiction" for a in answers) or (found is not None and found.accuses)
    word: Word = "stiction" if called and p >= needed else "inconclusive"
    excused = found is not None and found.clears and not any(a.word == "stiction" for a in answers)
    if p <= model.clear and excused and any(a.word == "no_stiction" for a in judged):
        word = "no_stiction"
    own = [a.word for a in answers]
    counts = ", ".join(f"{own.count(w)} {w.replace('_', ' ')}" for w in dict.fromkeys(own))
    level = f" {LEVELS_CYCLE} only from {100.0 * LEVEL:g} % on." if integrates and word != "stiction" else ""
    reason = (
        f"{len(answers)} {each} of one valve, by themselves {counts}. Together: probability of stiction {chance(p)}, "
        f"{CAUSES[_second(opinion)].spoken} {chance(opinion.causes[_second(opinion)])}.{level} {evidence}"
    )
    S = _size(found, [a.S for a in answers if a.S is not None], unit)
    stem = any(loop.record.mv is not None for loop in loops)
    causes = {"stiction": 1.0} if word == "stiction" else opinion.causes
    action = (
        next((a.action for a in judged if a.word == word), "")
        if S is None
        else next_step(causes, S, stem, settled=word != "inconclusive")
    )
    limit = None if found is None or word != "no_stiction" else (found.claim, unit)
    alike = sorted((a for a in judged if a.word == word), key=lambda a: a.probability or 0.0)
    middle = alike[len(alike) // 2] if alike else judged[0]
    by_all = found is not None and (found.accuses if word == "stiction" else found.clears)
    because = (f"Of all {each} together: {evidence}",) * by_all
    because += tuple(f"Of one of the {len(alike)} {each} that say so: {why}" for why in middle.because)
    return Answer(
        word, p, opinion.causes, S if word == "stiction" else None, None, limit, reason.strip(), action,
        because=because[:3] if word != "inconclusive" else (), picture="dead_travel" if by_all else middle.picture,
    )  # fmt: skip


def _weighed(opinion: Opinion, found: Evidence | None) -> Opinion:
    """The opinion with the odds of dead travel times what the records gain, or lose, together beyond the middle one.

    A deadband is weighed among the other causes only: the model's probability of stiction leaves it out.
    Ten nats count as one, because errors of a wrong model agree with each other; no evidence counts for more than five,
    because PV may have reasons that no rival has.
    """
    if found is None or not (found.accuses or found.clears):
        return opinion
    more = found.gain - float(np.median([day.gain for day in found.days]))
    times = math.exp(min(max(more / TEMPER, -MOST), MOST))
    p = opinion.probability
    sticks = p * times / (p * times + 1.0 - p)
    others = {name: q * (times if name == "deadband" else 1.0) for name, q in opinion.causes.items()}
    del others["stiction"]
    total = math.fsum(others.values())
    causes = {"stiction": sticks} | {name: (1.0 - sticks) * q / total for name, q in others.items()}
    causes = dict(sorted(causes.items(), key=lambda item: -item[1]))
    return replace(opinion, causes=causes)


def _odds(p: float) -> float:
    p = min(max(p, 1e-6), 1.0 - 1e-6)
    return p / (1.0 - p)


def _second(opinion: Opinion) -> str:
    return next(name for name in opinion.causes if name != "stiction")


def _size(found: Evidence | None, own: Sequence[Amount], unit: str) -> Amount | None:
    """The middle of what the records say; S of the evidence where few say one, which comes out small in noise."""
    if found is not None and found.accuses and 2 * len(own) < len(found.days):
        return Amount(found.S, found.low, found.high, unit)
    if not own:
        return None
    value, low, high = (float(np.median([getattr(one, part) for one in own])) for part in ("value", "low", "high"))
    return Amount(value, low, high, own[0].unit)

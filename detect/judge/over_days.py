"""The answer on one record: where it spans several days, that on its valve from all of them."""

from stickslip.detect.judge.answer import Answer, answer
from stickslip.detect.judge.pooled import evidence_of_all, pooled
from stickslip.detect.prepare.prepared import Prepared
from stickslip.detect.signals.days import DAY_S, days_of, edges_of_days


def answer_over_days(loop: Prepared) -> Answer:
    """The answer on a record, by its days where it has two or more that can be judged and its stem is not logged.

    >>> import numpy as np
    >>> from stickslip.logs import LoopRecord
    >>> t, rng = np.arange(0.0, 2 * 86400.0, 120.0), np.random.default_rng(1)
    >>> u = 50 + 5 * np.sin(t / 900) + np.sin(t / 4000)
    >>> y = np.concatenate([[50.0], u[:-1]]) + 0.1 * rng.normal(size=len(t))
    >>> said = answer_over_days(Prepared(LoopRecord.from_arrays(t, pv=y, op=u)))
    >>> said.reason.split(". Together")[0][:29]
    '2 days of one valve, by thems'
    """
    record = loop.record
    if record.mv is not None or float(record.t[-1] - record.t[0]) < DAY_S:
        return answer(loop)
    loops = [Prepared(day) for day in days_of(record, loop.period)]
    answers = [answer(day) for day in loops]
    applied = [i for i, said in enumerate(answers) if said.word != "not_applicable"]
    if len(applied) < 2:
        return answer(loop)
    loops, answers = [loops[i] for i in applied], [answers[i] for i in applied]
    _, days = edges_of_days(record, period=loop.period)
    each = f"parts of {days} days" if days > 1 else "days" if record.log.start is None else "calendar days"
    return pooled(loops, answers, evidence_of_all(loops)[0], each=each)

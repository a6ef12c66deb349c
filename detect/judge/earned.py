"""What the record's own likelihood adds to the model's opinion: it may find dead travel, and clearing needs it.

    odds of stiction and of a deadband   times exp(min(G_d / 10, 5)),   where the evidence calls dead travel
    cleared                              only where the evidence excludes dead travel as well

G_d [nats] is the gain without the best tenth of the record (``likelihood.pooled``).  Ten nats count as one, because
errors of a wrong model agree with each other; no evidence counts for more than five, because PV may have reasons that
no rival has.  Stick and deadband both are dead travel, so what the evidence finds they share as the model has them.
The ten and the five are ours: tuned by eye on 400 loops of the training law (seed 70001), where two waves from outside
gained 9 and 16 nats and the sticky valves that the model left open 150 and more.
"""

from __future__ import annotations

import math
from dataclasses import replace

from stickslip.detect.judge.model import Opinion
from stickslip.detect.likelihood.pooled import Evidence
from stickslip.detect.likelihood.words import said
from stickslip.detect.prepare.prepared import Prepared

__all__ = ["evidence_on", "not_earned", "usable", "with_evidence"]

TEMPER, MOST = 10.0, 5.0  # nats of evidence that count as one, and the most that count
PROMISE = 5.0  # nats of a first look below which no second one is worth its time
DEAD_TRAVEL = ("stiction", "deadband")
# Facts of the data behind which PV tells nothing of the stem.
DRAWN = ("compressed", "frozen_pv", "pv_unresponsive", "manual_mode", "constant_signal", "signal_missing")


def usable(loop: Prepared) -> bool:
    """Whether a record can be weighed: no historian has drawn PV or OP, and enough of them is left."""
    drawn = loop.op_drawn.present or any(fact.code in DRAWN for fact in loop.present)
    return not drawn and loop.stems is not None


def evidence_on(loop: Prepared, to_clear: bool) -> Evidence | None:
    """Return the evidence of a record; None where a historian has drawn PV or OP, or too little of them is left.

    It is not worked out where one look shows that it would change nothing: a stick promises too little to be called,
    and either clearing is not asked for (``to_clear``) or the stick promises too much for it.
    """
    if not usable(loop) or loop.stems is None:
        return None
    promise = loop.stems.promise
    return loop.dead_travel if promise >= PROMISE or (to_clear and promise <= 0.0) else None


def with_evidence(opinion: Opinion, found: Evidence | None) -> Opinion:
    """Return the opinion with the odds of dead travel raised where the evidence calls it.

    >>> from types import SimpleNamespace
    >>> seen = SimpleNamespace(accuses=True, without_best=30.0)
    >>> told = with_evidence(Opinion({"healthy": 0.6, "stiction": 0.4}, (0, 0, 0), (0, 0, 0), 0.0), seen)
    >>> round(told.probability / (1 - told.probability) / (0.4 / 0.6), 1)
    20.1
    """
    if found is None or not found.accuses:
        return opinion
    raised = math.exp(min(found.without_best / TEMPER, MOST))
    odds = {name: p * (raised if name in DEAD_TRAVEL else 1.0) for name, p in opinion.causes.items()}
    total = math.fsum(odds.values())
    causes = dict(sorted(((name, p / total) for name, p in odds.items()), key=lambda item: -item[1]))
    return replace(opinion, causes=causes)


def not_earned(loop: Prepared, found: Evidence | None, percent: bool) -> str:
    """Return why the record does not clear the valve; "" where it does."""
    if found is not None:
        why = "" if found.clears else said(found, percent)
    elif loop.stems is not None and loop.stems.promise > 0.0:
        why = "A stem that sticks predicts PV as well as OP itself does."
    else:
        why = "PV or OP is drawn by a historian or hardly there, so no dead travel can be excluded."
    return f"Little speaks for stiction, but clearing must be earned. {why}" if why else ""

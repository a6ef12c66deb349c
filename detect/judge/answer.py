"""One calibrated answer for a loop: what can be asked of the record, what is probable, how large, and what to do.

    1. a record that shows nothing is refused by name, without a probability; so is one of fewer than 5 samples
       a period, unless its stem answers
    2. where MV is logged and moves, the stem answers (``methods.stem_play``): PV is not asked; where it stands while OP
       travels and turns back, the valve sticks unless PV answers OP, so that the tag is dead (``still_stem``)
    3. where PV bends each time OP has come back by the same travel, its valve is seen to slip (``own_slips``)
    4. the features, of which half are the record's own likelihood of dead travel, go to the model, which was calibrated
       on simulated loops only
    5. "stiction" from the probability that the model needs on, from ``LEVEL`` on in a process known to integrate, with
       S and J
       "no stiction" only as a claim with a size: probability below ``clear``, OP turned back, and dead travel is
       excluded by likelihood (``earned``)
       all else is inconclusive, with the reason

The detection limit is the least S that the likelihood excludes.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from stickslip.detect.judge.actions import CAUSES, confirming_steps
from stickslip.detect.judge.features import features_of, view_of
from stickslip.detect.judge.features.earned import not_earned, usable
from stickslip.detect.judge.features.view import View
from stickslip.detect.judge.grounds import Ground, Picture, grounds
from stickslip.detect.judge.model import Model, Opinion, calibrated
from stickslip.detect.judge.own_slips import own_slips
from stickslip.detect.judge.still_stem import Still, still_stem
from stickslip.detect.likelihood.pooled import Evidence
from stickslip.detect.likelihood.words import said as in_words
from stickslip.detect.plantwide.slips import Slips
from stickslip.detect.prepare.preconditions import undersampled
from stickslip.detect.prepare.prepared import PERCENT, STEPS_MAX, Prepared
from stickslip.detect.verdict import Verdict
from stickslip.detect.words import Word
from stickslip.logs.chances import chance
from stickslip.logs.two_digits import rounded

FAR = 2.0  # distance from the loops learnt from, over that of 95 % of them, from which on nothing is concluded
# Facts of the data behind which nothing can be judged, where they forbid it.
REFUSED = ("no_valve", "manual_mode", "signal_missing", "constant_signal", "frozen_pv", "not_in_charge")
SAMPLES_MIN = 100  # of a record; the simulated ones have 300 and more
# In a process known to integrate a deadband makes the loop cycle, which few loops that are learnt from show.  From this
# probability on 2 % of such loops are called (400 of seed 63100; ``benchmarks.detect --only levels`` reads it off).
LEVEL = 0.985
LEVELS_CYCLE = "In an integrating process a deadband without jump makes a loop cycle as a stick does; PV separates them"
# Probability of a PV that does not answer OP, below which a stem that stands is not called stuck.  The likelihood does
# not stand in for it: a load hides OP from PV in many loops whose valve works.  Above it lie 12 of 12 simulated loops
# whose valve passes nothing on, and 11 of 114 others (the first law, seeds 72100 and 72101).
SILENT = 0.05
NOTHING_YET = "Nothing at the valve yet."
ALONE = " A load that goes in ramps or steps leaves the same trace, so this alone decides nothing."
COARSE = "which the record is too coarse to judge."
PV_ANSWERS = "PV moves as it does where OP reaches it, so that the tag may be dead. Look at the valve while OP moves."


@dataclass(frozen=True)
class Amount:
    """A size with its 90 % interval, in ``unit``: "% of OP" or, where the span is unknown, "in the unit of OP"."""

    value: float
    low: float
    high: float
    unit: str

    def __str__(self) -> str:
        """As people read it."""
        return f"{rounded(self.value):g} {self.unit} (90 % interval {rounded(self.low):g} to {rounded(self.high):g})"

    def to_dict(self) -> dict[str, float | str]:
        """As JSON holds it."""
        return {"value": self.value, "low": self.low, "high": self.high, "unit": self.unit}


@dataclass(frozen=True)
class Answer:
    """The answer on one loop, before the methods are put beside it.

    word : as in ``Verdict``
    probability : of stiction [-], None where the model was not asked
    causes : probability of each cause [-], largest first; empty where the model was not asked
    limit : (S, unit) above which a stick would have shown, or None
    reason, action : sentences
    assumptions : what was inferred, one sentence each
    because : what decided a verdict of the model, one sentence each, the weightiest first; empty where it is open
    picture : what shows the first of them, or in an open answer what moved the model most
    """

    word: Word
    probability: float | None
    causes: Mapping[str, float]
    S: Amount | None
    J: Amount | None
    limit: tuple[float, str] | None
    reason: str
    action: str
    assumptions: tuple[str, ...] = ()
    because: tuple[str, ...] = ()
    picture: Picture = ""


def answer(loop: Prepared, model: Model | None = None) -> Answer:
    """The calibrated answer on a prepared record; ``model`` by default the one that the package ships.

    >>> from stickslip.logs import LoopRecord
    >>> t = np.arange(300.0)
    >>> answer(Prepared(LoopRecord.from_arrays(t, pv=0 * t + 4, op=50 + np.sin(t / 9)))).word
    'not_applicable'
    """
    refused = next((f for f in loop.present if f.code in REFUSED and f.forbids), None)
    if refused is not None:
        return _refusal(refused.text)
    still = None if loop.record.mv is None else still_stem(loop)
    if loop.record.mv is not None and still is None:
        from stickslip.detect.methods import stem_play

        by_stem = stem_play.detect(loop)
        if by_stem.applicable:
            return _from_stem(by_stem, loop)
    sampled = undersampled(loop.with_stale)
    if sampled:
        return _refusal(sampled if still is None else f"{_stands(still._replace(why=COARSE))} {sampled}")
    slips = own_slips(loop.with_stale)
    if slips is not None:
        by_slips = _from_slips(slips, loop)
        dead = " The logged stem stands still all the while: its tag is dead."
        return replace(by_slips, reason=by_slips.reason + dead) if still else by_slips
    view, left = view_of(loop), len(loop.with_stale.whole)
    if view is None or left < SAMPLES_MIN:
        if still is not None and still.means == "sticks":
            return _from_still(still)
        return _refusal(
            f"Too little is left to look at: {left} samples without a gap; {SAMPLES_MIN} that move are needed."
        )
    model = model or calibrated()
    found = features_of(loop, view)
    opinion = model.judge(found)
    evidence = loop.dead_travel if usable(loop) else None
    if still is not None and still.means == "sticks":
        if opinion.causes["dead_loop"] >= SILENT or opinion.far > FAR or opinion.probability >= opinion.needed:
            return _from_still(still)
        still = still._replace(means="open", why=PV_ANSWERS)
    said = _judged(loop, view, found, opinion, model, evidence)
    return said if still is None or still.turned == 0 else replace(said, reason=f"{_stands(still)} {said.reason}")


def _refusal(text: str) -> Answer:
    return Answer("not_applicable", None, {}, None, None, None, text, "")


def _judged(
    loop: Prepared, view: View, found: Mapping[str, float], said: Opinion, model: Model, seen: Evidence | None
) -> Answer:
    concluded = _concluded(loop, view, said, model, seen)
    if seen is not None and (seen.accuses or concluded.word == "inconclusive"):
        alone = ALONE if seen.accuses and concluded.word == "inconclusive" else ""
        words = f"{concluded.reason} {in_words(seen, loop.op_unit[1] == PERCENT)}{alone}"
        concluded = replace(concluded, reason=words)
    weighed = grounds(found, model.shares(found), concluded.probability is not None and concluded.probability >= 0.5)
    if concluded.word == "no_stiction" and seen is not None and concluded.limit is not None:
        size = f"{rounded(concluded.limit[0]):g} {concluded.limit[1]}"
        weighed = (Ground(f"Dead travel above {size} is excluded by {seen.loss:.0f} nats.", "dead_travel"), *weighed)
    because = tuple(one.words for one in weighed)[:3] if concluded.word != "inconclusive" else ()
    shown: Picture = next((one.picture for one in weighed if one.picture), "")
    return replace(concluded, assumptions=_only_the_end(loop, view), because=because, picture=shown)


def _travelled(travel: float, unit: str) -> str:
    return f"{rounded(travel):g} {unit.replace('% of OP', '% of its span').replace('the unit of OP', 'its unit')}"


def _only_the_end(loop: Prepared, view: View) -> tuple[str, ...]:
    """What is said of a record of which the last part alone was looked at."""
    whole = loop.record.log.duration
    if view.seconds > 0.9 * whole or len(loop.record) <= STEPS_MAX:
        return ()
    of = "of the longest stretch without a gap, in a record of" if loop.record.log.gaps() else "of"
    return (
        f"The answer looks at the last {view.seconds / 3600.0:.3g} h {of} {whole / 3600.0:.3g} h, because more shows "
        "no more of a stick. The report that --html writes shows all of it over time.",
    )


def _concluded(loop: Prepared, view: View, said: Opinion, model: Model, seen: Evidence | None) -> Answer:
    scale, unit = loop.op_unit
    travel = view.travel * view.op_scale * scale
    S, J = (Amount(value * travel, low * travel, high * travel, unit) for value, low, high in (said.S, said.J))
    limit = None if seen is None or math.isinf(seen.excluded) else (seen.claim, unit)
    p, stem = said.probability, loop.record.mv is not None
    causes = dict(said.causes)
    bent = seen is not None and (seen.bent > 0.0 or seen.unpaid > 0.0)
    todo = next_step(causes, S, stem, settled=False, doubted=bent or p > model.clear)
    why_not = _shortcoming(view, said) or _at_end(loop)
    chances = f"Probability of stiction {chance(p)}; {_others(causes)}."
    if why_not:
        return Answer("inconclusive", p, causes, None, None, None, f"{why_not} {chances}", todo)
    if view.integrating and said.needed <= p < LEVEL:
        level = f"{LEVELS_CYCLE} only from {100.0 * LEVEL:g} % on: log the stem position, or make the test."
        return Answer("inconclusive", p, causes, None, None, None, f"{chances} {level}", todo)
    if p >= said.needed:
        reason = f"{chances} S is about {S}, J about {J}. OP travels {_travelled(travel, unit)}."
        return Answer("stiction", p, causes, S, J, limit, reason, next_step({"stiction": 1.0}, S, stem))
    if p <= model.clear:
        kept = not_earned(seen)
        if not kept and seen is not None:
            reason = (
                f"S is below {rounded(seen.claim):g} {unit}: OP travels {_travelled(travel, unit)} and turns back, PV "
                f"answers it, and any larger dead travel is excluded by {seen.loss:.0f} nats. {chances}"
            )
            return Answer("no_stiction", p, causes, None, None, limit, reason, next_step(causes, S, stem))
        return Answer("inconclusive", p, causes, None, None, limit, f"{kept} {chances}", todo)
    against = ", because its own likelihood speaks against a stick" if said.needed > model.accuse else ""
    between = (
        f"The record leaves it open{against}: the valve is called sticky at {100.0 * said.needed:.0f} % and more, and "
        f"cleared at {100.0 * model.clear:.1f} % and less."
    )
    return Answer("inconclusive", p, causes, None, None, limit, f"{chances} {between}", todo)


def _shortcoming(view: View, said: Opinion) -> str:
    """Why the model's probability settles nothing on this record; "" where it may."""
    if len(view) < 2.0 * view.turn:
        return "OP never turns back; a one-way drift proves nothing, because a load ramp looks the same."
    if said.far > FAR:
        return (
            f"In samples a turn, turns and S the record lies {said.far:.1f} times as far out as 95 % of the loops that "
            "were learnt from, so nothing is concluded."
        )
    return ""


def _at_end(loop: Prepared, allowed: float = 0.1) -> str:
    """Whether PV stands at an end of its span, which the transmitter cannot leave; "" where not, or it is not known."""
    record = loop.record
    span = record.log.spans.get(record.pv_name)
    if span is None:
        return ""
    pv, edge = record.pv[record.good], 0.005 * (span[1] - span[0])
    share = float(np.mean((pv <= span[0] + edge) | (pv >= span[1] - edge)))
    if share <= allowed:
        return ""
    of_samples = f"{share:.0%} of the samples ({allowed:.0%} allowed)"
    return f"PV stands at an end of its span in {of_samples}: log it within its range."


def _others(causes: Mapping[str, float]) -> str:
    shown = [(name, p) for name, p in causes.items() if name != "stiction"][:2]
    return ", ".join(f"{CAUSES[name].spoken} {chance(p)}" for name, p in shown)


def next_step(
    causes: Mapping[str, float], S: Amount, stem_logged: bool, settled: bool = True, doubted: bool = False
) -> str:
    """Action, owner and test for the most probable cause; for stiction as long as it is not ruled out.

    Where the record settles nothing, nobody is sent to work on a valve: what would settle it is said in its place, of a
    loop that seems to do its work where the valve is ``doubted``.
    """
    top = next(iter(causes))
    doing = CAUSES[top]
    test = confirming_steps(top, S.value, S.unit)
    steps = confirming_steps("stiction", S.value, S.unit)
    if not settled and (test == steps or (doubted and not test)):
        stem = "" if stem_logged else "log the stem position, or "
        return f"{NOTHING_YET} To settle it: {stem}{steps}."
    if not settled and not test:
        return f"{doing.action} now, but the record does not clear the valve. To settle it: {steps}."
    said = f"{doing.action} ({doing.owner}). To confirm: {test}." if test else f"{doing.action}."
    if top != "stiction" and causes.get("stiction", 0.0) > 0.2:
        said += f" To rule out the valve: {steps}."
    if causes.get("stiction", 0.0) > 0.2 and not stem_logged:
        said += " Better still: log the stem position."
    return said


def _from_stem(by_stem: Verdict, loop: Prepared) -> Answer:
    """The answer that the logged stem gives; no probability, because the stem is seen."""
    unit = "% of OP" if loop.op_percent(1.0) is not None else "% of OP's travel"
    sizes: dict[str, Amount | None] = {}
    for name in ("S", "J"):
        at = [by_stem.evidence.get(key) for key in (name, f"{name}_low", f"{name}_high")]
        plain = [float(np.asarray(value)) for value in at if value is not None]
        sizes[name] = None
        if by_stem.verdict == "stiction" and len(plain) == 3 and bool(np.all(np.isfinite(plain))):
            sizes[name] = Amount(plain[0], plain[1], plain[2], unit)
    S = sizes["S"]
    action = next_step({"stiction": 1.0}, S, True) if S is not None else ""
    reason = f"The stem is logged, so the verdict comes from it and not from PV. {by_stem.reason}"
    return Answer(by_stem.verdict, None, {}, S, sizes["J"], None, reason, action, picture="stem_play")


def _stands(still: Still) -> str:
    """Return the finding on a stem that does not move, and its meaning."""
    moves = f"OP travels {_travelled(still.travel, still.unit)} and turns back {still.turned} times"
    return f"The logged stem never moves while {moves}: {still.why}"


def _from_still(still: Still) -> Answer:
    """The answer where the stem is seen to stand; no probability, and of S the least that it can be."""
    least = Amount(still.travel, 0.5 * still.travel, still.travel, still.unit.replace("its span", "OP"))
    action = next_step({"stiction": 1.0}, least, True)
    return Answer("stiction", None, {}, None, None, None, _stands(still), action, picture="still_stem")


def _from_slips(slips: Slips, loop: Prepared) -> Answer:
    """The answer where PV itself shows that the valve slips; no probability, because the slips are seen."""
    S = Amount(slips.S, slips.low, slips.high, "% of OP")
    reason = (
        f"PV changes its pace at once each time OP has come back by {rounded(slips.S):g} %, {slips.reversals} times, "
        "and keeps it before, while OP moves: the valve stands and slips."
    )
    action = next_step({"stiction": 1.0}, S, loop.record.mv is not None)
    return Answer("stiction", None, {}, S, None, None, reason, action, picture="slips")

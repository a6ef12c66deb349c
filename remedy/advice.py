"""Which remedy helps: each tried on the fitted loops, against doing nothing, and one recommended or none.

    score = rms(SP - PV) / that of none + 0.05 travel / that of none       of each fitted loop, the median over all

Of the settings of a remedy the one with the least score stands for it.  Recommended is the remedy of least score of
those that are allowed: its rms is below that of none in at least 90 % of the fitted loops, as wide as their intervals
are, and its score is lower.  A lasting offset counts in the rms: a loop that stands off SP is no loop that holds it.
Until the shutdown these are settings and programs of the controller; at the shutdown, the valve too.  Of what is done
to the valve a repair comes first where nothing else has an rms that is a twentieth less: a stem without stick travels
with every noise, which wears it less than its packing did.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import islice
from typing import TYPE_CHECKING, Any, Self

import numpy as np
from stickslip.logs.shown import Shown
from stickslip.remedy.loop_fit import LoopFit
from stickslip.remedy.measures import REMEDIES
from stickslip.remedy.measures.repair import FREE
from stickslip.remedy.measures.repair import TITLE as REPAIR
from stickslip.remedy.measures.setting import Situation
from stickslip.remedy.size import Size, size_of, widened
from stickslip.remedy.trial import NOTHING, UNSTABLE, Floats, Outcome, outcomes, settling

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["Advice", "Cost", "Tried", "cost", "remedies", "score"]

TRAVEL = 0.05  # weight of travel
LONG = "longer than the run"
OFF = 0.3  # of the rms, from which on an offset is said
NEAR = 1.05  # times the least rms, within which a repair comes first
SURE = 0.9  # share of the fitted loops, widened, that swing less


@dataclass(frozen=True)
class Cost:
    """What it costs to leave the stick, under the load of the record: nothing in a loop in which none is believed.

    ratio : sd of SP - PV with stick over that without [-];  travel : with stick less without [unit of OP per h]
    """

    ratio: Size
    travel: Size

    def to_dict(self) -> dict[str, Any]:
        """For JSON."""
        return {"pv_sd_ratio": self.ratio.to_dict(), "travel_per_h": self.travel.to_dict()}

    def words(self, unit: str) -> str:
        """It in a sentence."""
        swing, more = f"With the stick SP - PV swings {self.ratio} times as far", self.travel
        word = "more"
        if more.value is not None and more.value < 0.0:  # a free stem follows the noise in OP too
            more, word = Size(-more.value, -(more.high or 0.0), -(more.low or 0.0)), "less"
        return f"{swing}, and the stem travels {more} {unit}/h {word}."

    @classmethod
    def between(cls, none: Outcome, free: Outcome) -> Self:
        """The cost from what loops do as they are and without stick."""
        return cls(size_of(none.pv_sd / np.maximum(free.pv_sd, 1e-300)), size_of(none.travel - free.travel))


@dataclass(frozen=True, eq=False)
class Tried:
    """One remedy with its best setting: ``score`` [-], ``better`` the share of loops (widened) of a smaller rms.

    sp_time, load_time : settling of the tuning after a step of SP and of a load [s]; inf where longer than the run
    """

    name: str
    at_shutdown: bool
    not_for: str
    outcome: Outcome
    score: float
    better: float
    sp_time: Size
    load_time: Size

    @property
    def settings(self) -> str:
        """What to set, as a person enters it."""
        return self.outcome.setting.words

    def to_dict(self) -> dict[str, Any]:
        """For JSON."""
        one = self.outcome
        return {
            "name": self.name, "settings": dict(one.setting.values), "words": self.settings,
            **one.to_dict(), "sp_settling_s": self.sp_time.to_dict(), "load_settling_s": self.load_time.to_dict(),
            "score": self.score if math.isfinite(self.score) else None, "better_in": self.better,
            "at_shutdown": self.at_shutdown, "not_for": self.not_for,
        }  # fmt: skip


@dataclass(frozen=True, eq=False, repr=False)
class Advice(Shown):
    """What helps a loop: ``none``, each remedy ``tried``, the names recommended until and at the shutdown, or None."""

    fit: LoopFit
    none: Tried
    tried: tuple[Tried, ...]
    until_shutdown: str | None
    at_shutdown: str | None

    def __getitem__(self, name: str) -> Tried:
        return next(one for one in self.tried if one.name == name)

    @property
    def cost(self) -> Cost:
        """What it costs to leave the stick."""
        free = next((one.outcome for one in self.tried if one.name == REPAIR), self.none.outcome)
        return Cost.between(self.none.outcome, free)

    @property
    def headline(self) -> str:
        """What is recommended, in one line."""
        return " ".join(self.words())

    def words(self) -> list[str]:
        """The recommendation in sentences."""
        if self.fit.doubt:
            return ["Nothing is recommended, since it is not known whether the valve sticks.", self.fit.doubt]
        if not self.fit.sticks:
            return [
                f"The valve shows no stick (S is below {self.fit.S.high:.3g} {self.fit.op_unit}): leave it as it is."
            ]
        now, found = self.none.outcome, []
        for when, name in (("Until the shutdown", self.until_shutdown), ("At the shutdown", self.at_shutdown)):
            if name is None:
                found.append(f"{when}: nothing that was tried helps for sure; leave the loop as it is.")
                continue
            one = self[name]
            then, share = one.outcome, size_of(100.0 * one.outcome.pv_rms / now.pv_rms)
            rest = float(np.median(then.pv_offset))
            stays = f" PV rests {rest:.2g} off SP on average." if rest > OFF * float(np.median(then.pv_rms)) else ""
            caveat = f" Do not use it with: {one.not_for}." if one.not_for else ""
            found.append(
                f"{when}: {name}, {one.settings}. The root mean square of SP - PV goes from {_middle(now.pv_rms)} to "
                f"{_middle(then.pv_rms)} ({share.low:.0f} to {share.high:.0f} % of now), travel from "
                f"{_middle(24.0 * now.travel)} to {_middle(24.0 * then.travel)} {self.fit.op_unit} a day."
                f"{stays}{caveat}"
            )
        harm = [one.name for one in self.tried if np.median(one.outcome.pv_rms) > 1.02 * np.median(now.pv_rms)]
        if harm:
            found.append(f"In these loops it gets worse with: {', '.join(harm)}.")
        return [
            *found,
            f"A remedy scores its root mean square of SP - PV plus {TRAVEL:g} of its travel, each divided by that of "
            "doing nothing. The least score is best.",
        ]

    def to_dict(self) -> dict[str, Any]:
        """The advice for JSON."""
        return {
            "loop": self.fit.name, "none": self.none.outcome.to_dict(),
            "remedies": [each.to_dict() for each in self.tried],
            "until_shutdown": self.until_shutdown, "at_shutdown": self.at_shutdown,
            "travel_weight": TRAVEL, "cost": self.cost.to_dict(),
            "words": self.words(), "fit": self.fit.to_dict(),
        }  # fmt: skip

    def rows(self) -> list[list[str]]:
        """The table: remedy, sd and mean of SP - PV, their rms beside none, sd of OP, travel, reversals, settling."""
        none = self.none.outcome
        found = []
        for each in (self.none, *self.tried):
            one = each.outcome
            sd, share = size_of(one.pv_sd, endless=UNSTABLE), size_of(100.0 * one.pv_rms / none.pv_rms)
            counts = (np.median(one.op_sd), 24 * np.median(one.travel), 24 * np.median(one.reversals))
            found.append(
                [
                    each.name,
                    str(sd),
                    f"{np.median(one.pv_offset):.2g}",
                    f"{share.value:.0f} ({share.low:.0f} to {share.high:.0f})",
                ]
                + [f"{count:{form}}" for count, form in zip(counts, (".3g", ".4g", ".0f"), strict=True)]
                if sd.value is not None
                else [each.name, "not stable", *[""] * 5]
            )
            found[-1] += [_time(each.sp_time), _time(each.load_time)]
        return found

    def columns(self) -> list[str]:
        """The heads of ``rows``."""
        pv, op = self.fit.pv_unit or "unit of PV", self.fit.op_unit
        return [
            "remedy", f"sd of SP - PV [{pv}]", f"mean off SP [{pv}]", "rms, % of none", f"sd of OP [{op}]",
            f"travel/day [{op}]", "turns/day", "SP step [s]", "load step [s]",
        ]  # fmt: skip

    def plot(self) -> Figure:
        """PV now and then, side by side, and travel against variability of all remedies."""
        from stickslip.remedy.figures import plot_advice

        return plot_advice(self)


def _middle(values: Floats) -> str:
    """The median as its ``size_of`` has it, to three digits and without an exponent."""
    middle = float(size_of(values, endless=UNSTABLE).value or math.inf)
    return f"{middle:.3g}" if middle < 1000.0 else f"{middle:,.0f}"


def _time(size: Size) -> str:
    return "long" if size.value is None or not math.isfinite(size.value) else f"{size.value:.0f}"


def _situation(fit: LoopFit) -> Situation:
    def middle(key: str) -> float:
        return float(np.median([abs(getattr(one, key)) for one in fit.loops]))

    law, day = fit.controller, fit.days[0]
    e = day.pv - (np.mean(day.pv) if day.sp is None else day.sp)
    lag = middle("tau_2") + (0.0 if fit.best.integrating else middle("tau"))
    return Situation(
        law.K_p, law.T_i, law.dt, middle("S"), middle("J"), middle("K"), lag,
        middle("theta"), fit.noise_sd.value or 0.0, float(np.std(e)), fit.best.integrating, fit.K.value is not None,
        fit.op_unit, fit.pv_unit or "unit of PV",
    )  # fmt: skip


def score(one: Outcome, none: Outcome) -> float:
    """The score of an outcome beside that of doing nothing, the median over all loops."""
    swing, travel = none.pv_rms + 1e-300, none.travel + 1e-9 * float(np.max(none.travel) or 1.0)
    return float(np.median(one.pv_rms / swing + TRAVEL * one.travel / travel))


def _share_below(x: float, values: Floats) -> float:
    """The share of values (n,) below x, between two of them as percentiles have it."""
    return float(np.interp(x, np.sort(values), np.linspace(0.0, 1.0, len(values))))


def remedies(fit: LoopFit, progress: Callable[[str], None] = lambda _: None) -> Advice:
    """Return what each remedy would do to a fitted loop, and which to take; ``progress`` hears what is done.

    >>> from stickslip.remedy import fit
    >>> from stickslip.remedy.example import sticky
    >>> advice = remedies(fit(sticky()))
    >>> round(advice.none.score, 2), len(advice.tried) > 5
    (1.05, True)
    """
    at = _situation(fit)
    plans = [(one, own) for one in REMEDIES * fit.sticks if (own := one.settings(at))]
    settings = [NOTHING, *(setting for _, own in plans for setting in own)]
    progress(f"trying {len(settings) - 1} settings of {len(plans)} remedies on the fitted loops")
    none, *found = outcomes(fit, settings)
    left = iter(found)
    chosen = [("none", False, "", none)] + [
        (one.TITLE, one.AT_SHUTDOWN, one.NOT_FOR, min(islice(left, len(own)), key=lambda each: score(each, none)))
        for one, own in plans
    ]
    times = settling(fit, [best.setting for *_, best in chosen])
    tried = [
        Tried(
            name, shutdown, not_for, best, score(best, none), _share_below(1.0, widened(best.pv_rms / none.pv_rms)),
            size_of(sp, endless=LONG), size_of(load, endless=LONG),
        )
        for (name, shutdown, not_for, best), (sp, load) in zip(chosen, times, strict=True)
    ]  # fmt: skip
    allowed = [one for one in tried[1:] if one.better >= SURE and one.score < tried[0].score]
    allowed.sort(key=lambda one: one.score)
    until = next((one.name for one in allowed if not one.at_shutdown), None)
    works = [one for one in allowed if one.at_shutdown]
    least = min((float(np.median(one.outcome.pv_rms)) for one in works), default=0.0)
    works.sort(key=lambda one: (np.median(one.outcome.pv_rms) > NEAR * least, one.name != REPAIR))
    shut = next((one.name for one in works), until)
    return Advice(fit, tried[0], tuple(tried[1:]), until, shut)


def cost(fit: LoopFit) -> Cost:
    """Return what the stick of a fitted loop costs.

    >>> from stickslip.remedy import fit
    >>> from stickslip.remedy.example import sticky
    >>> cost(fit(sticky())).ratio.value > 1.2
    True
    """
    if not fit.sticks:
        return Cost(Size(1.0, 1.0, 1.0), Size(0.0, 0.0, 0.0))
    none, free = outcomes(fit, [NOTHING, FREE])
    return Cost.between(none, free)

"""A loop fitted to its own log: what is known of it, with intervals, as words, JSON and an editable Python file."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from stickslip.detect.judge.actions import confirming_steps
from stickslip.detect.likelihood.words import hides
from stickslip.logs.arrays import Values
from stickslip.logs.shown import Shown
from stickslip.remedy.controller import Controller
from stickslip.remedy.left import nugget
from stickslip.remedy.process import Day, Found, Loop
from stickslip.remedy.size import Size, size_of, widened

if TYPE_CHECKING:
    from datetime import datetime

    from matplotlib.figure import Figure
    from stickslip.detect.likelihood.pooled import Evidence
    from stickslip.detect.words import Word

__all__ = ["LoopFit"]

WIDE, NARROW = 3.0, 2.0  # high over low: K and J are unknown beyond the one, K J is known within the other
ROUGH = "the load moves as fast from row to row, so that noise does not show beside it"
EXCITED = 20.0  # nats by which moves of SP or by hand tell PV, from which on they show the process
CLOSED = (
    "OP moves as PV asks here, which does not tell the process; log steps of SP, or of OP in manual, a few a record"
)
UNSURE = "the interval spans more than a factor of three"


@dataclass(frozen=True, eq=False, repr=False)
class LoopFit(Shown):
    """A fitted loop.

    name : of the loop;  op_unit, pv_unit : units;  controller : the law of OP
    days : the records;  without, found : the likeliest loop without stick, and the one that is believed
    loops : loops about as likely, the best first;  gain : what the stick gains [nats];  sticks : believed or not
    lefts : of each loop and day, what is left at PV (loops, days) of (n,) [unit of PV]
    begun : where the stem of each loop stands at the start beside OP (loops,) [unit of OP]
    evidence : of dead travel, by ``stickslip.detect.likelihood``;  notes : what is to be said besides
    start : of the first record on the clock, if it is known
    excited : by how much moves of SP, or of OP by hand, tell PV [nats]

    >>> from stickslip.remedy.example import sticky
    >>> from stickslip.remedy import fit
    >>> found = fit(sticky())                                   # S = 5 %, J = 1.5 %, K = 1.2, tau = 30 s
    >>> found.sticks, found.S.low < 5.0 < found.S.high
    (True, True)
    """

    name: str
    op_unit: str
    pv_unit: str
    controller: Controller
    days: tuple[Day, ...]
    without: Found
    found: Found
    loops: tuple[Loop, ...]
    gain: float
    sticks: bool
    evidence: Evidence | None
    lefts: tuple[tuple[Values, ...], ...]
    begun: Values
    notes: tuple[str, ...]
    start: datetime | None = None
    excited: float = math.inf

    @property
    def closed(self) -> str:
        """Why the record does not tell the process: nothing but PV moves the stem; "" where it does."""
        return CLOSED if not self.sticks and self.excited < EXCITED else ""

    def each(self, key: str) -> Values:
        """A value of each loop, (loops,)."""
        return np.array([float(getattr(one, key)) for one in self.loops])

    def against(self, S: float) -> float:
        """By how many nats every dead travel from S [unit of OP] on is less likely than none.

        0 where a straight line does not tell PV best.  The largest that is weighed is about OP's own travel, and stands
        for all that are larger: such a stem rests.
        """
        if self.evidence is None or self.evidence.bent > 0.0 or self.evidence.coarse:
            return 0.0
        sizes = self.evidence.sizes
        return max(-float(self.evidence.curve[sizes >= min(S, float(sizes[-1]))].max()), 0.0)

    @property
    def verdict(self) -> Word:
        """What the record says of the valve: a loop that does as well without stick does not clear it yet."""
        cleared = self.evidence is not None and self.evidence.clears
        return "stiction" if self.sticks else "no_stiction" if cleared else "inconclusive"

    @cached_property
    def doubt(self) -> str:
        """Why the record does not tell whether the valve sticks, and what would; "" where it does."""
        if self.verdict != "inconclusive":
            return ""
        low, high = np.percentile(np.concatenate([day.op for day in self.days]), [2.0, 98.0])
        why = hides(self.evidence, self.op_unit) if self.evidence else "PV shows no answer to it"
        travel = f"{high - low:.3g} {self.op_unit.removesuffix(' of OP')}"
        return (
            f"The record does not tell whether the valve sticks. OP travels {travel}, and {why}. "
            f"To settle it: {confirming_steps('stiction', 0.5 * float(high - low), self.op_unit)}."
        )

    @property
    def best(self) -> Loop:
        """The likeliest loop."""
        return self.loops[0]

    @property
    def K_p(self) -> Size:
        """Gain of the controller [unit of OP per unit of PV]: the middle of what both forms of its integral have."""
        low, high = self.controller.spread("K_p")
        share = self.controller.present[0] / self.controller.K_p
        return Size(self.controller.middle[0], min(low, share * low), max(high, share * high))

    @property
    def T_i(self) -> Size:
        """Integral time of the controller [s], likewise."""
        if not math.isfinite(self.controller.T_i):
            return Size(None, None, None, "no integral action is seen")
        low, high = self.controller.spread("T_i")
        return Size(self.controller.middle[1], low + self.controller.present[1] - self.controller.T_i, high)

    @cached_property
    def S(self) -> Size:
        """Dead travel: movement of OP after a turn until the stem moves [unit of OP]."""
        if self.sticks:
            S = self.each("S")
            return size_of(S, UNSURE if _ratio(S) > WIDE else "")
        if self.evidence is None or self.doubt:
            return Size(None, None, None, "no stick is seen, and the record does not exclude one")
        return Size(0.0, 0.0, self.evidence.claim)

    @cached_property
    def J(self) -> Size:
        """Slip jump [unit of OP]."""
        if not self.sticks:
            return self.S
        J = self.each("J")
        why = self._only_product("J") if _ratio(J) > WIDE and self.best.J > 0.1 * self.best.S else ""
        return size_of(J, why, zero=True)

    @cached_property
    def K(self) -> Size:
        """Gain of the process [unit of PV per unit of OP, and per s where it integrates]."""
        if self.closed:
            return Size(None, None, None, self.closed)
        K = self.each("K")
        unsure = UNSURE if _ratio(K) > WIDE else ""
        return size_of(K, self._only_product("K") if unsure and self.sticks else unsure)

    @cached_property
    def KJ(self) -> Size:
        """How far PV goes after a slip, K J [unit of PV]: known where K and J alone are not."""
        if self.sticks:
            return size_of(self.each("K") * self.each("J"), zero=True)
        return self.S if self.S.value is None else Size(0.0, 0.0, None)  # what S may be at most is of OP

    def _only_product(self, key: str) -> str:
        product = self.each("K") * self.each("J")
        if self.sticks and _ratio(product) < NARROW:
            return f"only K J = {np.median(product):.3g} shows in this record, not {key} alone"
        return UNSURE

    @cached_property
    def tau(self) -> Size:
        """Time constant [s]; not there where the process integrates."""
        return self._lag("tau", "the process integrates" if self.best.integrating else "")

    @cached_property
    def tau_2(self) -> Size:
        """Second time constant [s]."""
        return self._lag("tau_2")

    @cached_property
    def theta(self) -> Size:
        """Dead time [s]; the log does not tell where between two rows OP moved."""
        found, half = self._lag("theta"), 0.5 * self.days[0].dt
        if found.low is None or found.high is None:
            return found
        return replace(found, low=max(found.low - half, 0.0), high=found.high + half)

    def _lag(self, key: str, why: str = "") -> Size:
        why = self.closed or why
        return Size(None, None, None, why) if why else size_of(self.each(key), zero=key != "tau")

    @cached_property
    def _noise(self) -> Values:
        """Variance of white noise on PV: least, likeliest, most, (3,), the median of all loops."""
        return np.asarray(np.median([np.mean([nugget(v) for v in own], axis=0) for own in self.lefts], axis=0))

    @property
    def noise_sd(self) -> Size:
        """Standard deviation of white noise on PV [unit of PV]; none where the load may be all that is left."""
        low, value, high = np.sqrt(np.maximum(self._noise, 0.0)).tolist()
        return Size(None if low <= 0.0 else value, low, high, ROUGH if low <= 0.0 else "")

    @property
    def load_sd(self) -> Size:
        """Standard deviation of the load as it comes to PV without control [unit of PV]."""
        noise = max(float(self._noise[1]), 0.0)
        return size_of(np.array([math.sqrt(max(float(np.var(own[0])) - noise, 0.0)) for own in self.lefts]))

    @cached_property
    def one_step_error(self) -> float:
        """Spread of what the best loop does not foretell of PV, one row ahead, over that of PV [-]."""
        y = np.concatenate([day.rows for day in self.days])
        return float(np.mean([one.s for one in self.found.noises]) / max(np.std(y), 1e-300))

    @cached_property
    def free_error(self) -> float:
        """Spread of PV less that of the best loop with its stem alone, without load and noise, over that of PV [-]."""
        left = np.concatenate([one - one.mean() for one in self.lefts[0]])
        pv = np.concatenate([day.pv - day.pv.mean() for day in self.days])
        return float(np.std(left) / max(np.std(pv), 1e-300))

    def to_dict(self) -> dict[str, Any]:
        """The fit for JSON."""
        law = self.controller
        T_d, T_f = (Size(value, None, None) for value in (law.T_d, law.T_f))
        return {
            "loop": self.name,
            "valve": {
                "sticks": self.sticks, "gain_nats": self.gain, "S": self.S.to_dict(), "J": self.J.to_dict(),
                "law": "follows" if self.best.follows else "sticks again at every scan", "unit": self.op_unit,
            },
            "controller": {
                "form": law.form, "K_p": self.K_p.to_dict(), "T_i": self.T_i.to_dict(), "T_d": T_d.to_dict(),
                "T_f": T_f.to_dict(),
                "scan": law.dt, "low": _finite(law.low), "high": _finite(law.high), "explained": law.explained,
            },
            "process": {
                "K": self.K.to_dict(), "KJ": self.KJ.to_dict(), "tau": self.tau.to_dict(),
                "tau_2": self.tau_2.to_dict(), "theta": self.theta.to_dict(), "integrating": self.best.integrating,
            },
            "load_sd": self.load_sd.to_dict(), "noise_sd": self.noise_sd.to_dict(),
            "one_step_error": self.one_step_error, "free_error": self.free_error,
            "records": len(self.days), "notes": list(self.notes),
        }  # fmt: skip

    @property
    def headline(self) -> str:
        """What was fitted, in one line."""
        said = "sticks" if self.sticks else "may stick" if self.doubt else "shows no stick"
        valve = said if self.S.value is None else f"{said}, S = {self.S} {self.op_unit}"
        kind = "an integrating process" if self.best.integrating else "a process that settles"
        kind = "a process that does not show" if self.closed else kind
        return f"{self.name or 'loop'}: the valve {valve}; {self.controller.form} controller, {kind}"

    def rows(self) -> list[list[str]]:
        """What is known, as rows of a table: what, value with its 90 % interval, unit."""
        law, pv, op = self.controller, self.pv_unit or "PV", self.op_unit
        per = "/s" if self.best.integrating and not self.closed else ""
        valve = [["dead travel S", str(self.S), op], ["slip jump J", str(self.J), op]]
        lag = [] if self.best.integrating and not self.closed else [["time constant", str(self.tau), "s"]]
        return [
            ["controller K_p", str(self.K_p), f"{op} per {pv}"],
            ["controller T_i", str(self.T_i), "s"],
            *([["controller T_d", f"{law.T_d:.3g}", "s"]] if law.T_d else []),
            *([["filter of PV", f"{law.T_f:.3g}", "s"]] if law.T_f else []),
            *valve, ["process gain K", str(self.K), f"{pv}{per} per {op}"], ["slip at PV, K J", str(self.KJ), pv + per],
            *lag, ["second time constant", str(self.tau_2), "s"], ["dead time", str(self.theta), "s"],
            ["load at PV", str(self.load_sd), pv], ["noise at PV", str(self.noise_sd), pv],
        ]  # fmt: skip

    def plot(self) -> Figure:
        """The log against the loop: the likeliest stem, its PV, and the free loop with what is left as its load."""
        from stickslip.remedy.figures import plot_fit

        return plot_fit(self)


def _ratio(values: Values) -> float:
    low, high = np.percentile(np.abs(widened(values)), [5.0, 95.0])
    return float(high / low) if low > 0.0 else math.inf


def _finite(x: float) -> float | None:
    return x if math.isfinite(x) else None

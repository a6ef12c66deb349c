"""A sine against another shape, half wave by half wave: what ``curve_fit`` and ``relay_fit`` have in common.

Each half wave is fitted by the best sine and by the best of the other shapes; the index weighs the mean squared errors
of the two, and its interval comes from weighing the half waves anew.  As ``pool`` has it, ``seen`` gives the errors of
each half wave and ``judged`` the verdict on any number of them.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from stickslip.detect.card import Card
from stickslip.detect.half_waves.half_wave_fits import Samples, folded, gather
from stickslip.detect.pool import Pool
from stickslip.detect.prepare.preconditions import refused
from stickslip.detect.prepare.prepared import Prepared, Signal
from stickslip.detect.signals.bootstrap import interval
from stickslip.detect.verdict import Draw, Verdict, Word
from stickslip.logs.arrays import Values


@dataclass(frozen=True)
class AgainstSine:
    """One such method.

    symbol : of the index, in sentences
    threshold : of the index [-]
    half_waves_min : fewest for a verdict [-]
    signal : whose half waves are read
    errors : function of Samples
        Squared errors of the sine and of the other shape [unit^2] and the parameter of the latter, (H,) each.
    index : function of means (..., 2); the index [-] of the mean errors of sine and other shape
    word : function of the index and the lower end of its interval; the verdict, and why
    shape : function of phases (n,) and parameter; the other shape
    draw : the picture
    """

    card: Card
    symbol: str
    threshold: float
    half_waves_min: int
    signal: Signal
    errors: Callable[[Samples], tuple[Values, Values, Values]]
    index: Callable[[Values], Values]
    word: Callable[[float, float], tuple[Word, str]]
    shape: Callable[[Values, float], Values]
    draw: Draw

    def seen(self, loop: Prepared) -> Pool | Verdict:
        """The errors and the parameter of every half wave, or why the record is refused."""
        if refusal := refused(self.card, loop, self.threshold):
            return refusal
        halves = loop.half_waves(self.signal)
        t = loop.stretch.t
        at = np.array([t[half.start] + 0.5 * half.length for half in halves])
        rows = np.column_stack(self.errors(gather(halves))) if halves else np.empty((0, 3))
        return Pool(at, rows, float(t[0]))

    def judged(self, loop: Prepared, pool: Pool) -> Verdict:
        """The verdict on the half waves of ``pool``; ``loop`` shows the last of them."""
        name, count = self.card.name, len(pool.at)
        if count < self.half_waves_min:
            reason = f"{count} half waves of {self.signal} are whole and high enough; {self.half_waves_min} are needed."
            return Verdict.not_applicable(name, "too_few_cycles", reason, self.threshold)
        means = pool.rows[:, :2]
        index = float(self.index(means.mean(axis=0)))
        low, high = interval(self.index, means)
        word, why = self.word(index, low)
        reason = (
            f"{self.symbol} = {index:.2f} (90 % interval {low:.2f} to {high:.2f}, {count} half waves of {self.signal}, "
            f"period {loop.period:.4g} s): {why}."
        )
        evidence: dict[str, Values | float] = {
            "error_sine": pool.rows[:, 0], "error_other": pool.rows[:, 1], "parameter": pool.rows[:, 2],
            "of_pv": float(self.signal == "PV"),
        }  # fmt: skip
        halves = loop.half_waves(self.signal)
        if halves:
            phase, waves = folded(halves)
            other = self.shape(phase, float(np.median(pool.rows[:, 2])))
            other = other * (waves.mean(0) @ other) / (other @ other)
            evidence |= {"phase": phase, "waves": waves, "sine": np.sin(np.pi * phase), "other": other}
        return Verdict(
            name, word, index, self.threshold, reason, interval=(low, high), evidence=evidence, draw=self.draw
        )

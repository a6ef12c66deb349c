"""Whether a record shows a stick: what it gains over the best loop without it, each asked alike.

    gain = ln p(rows; best loop with stick) - ln p(rows; best loop without) - what rivals gain      [nats]
    z    = sum g_j / sqrt(m) s_g,   g_j the difference of the first two in each of m stretches, s_g its spread

The stick is believed where it gains ``SURE`` nats, or ``GAIN`` where ``stickslip.detect.likelihood`` accuses too, and
where z is that of 95 % by Student's t: what a burst of the load gains in one stretch is no stick.

- Only stretches count for the gain in which the stem moves.  In the others the memory of the load alone differs: a stem
  that slips with each burst of the load spares it the bursts.
- The loop without stick is sought beside the processes that the stick has found as well.
- The least of many tries is so by luck too: the stick's likelihood is that of other random numbers.
- What a bent characteristic, another answer each way or a sensor with hysteresis gains over a straight line shows no
  stick.  A sound loop that a sticky neighbour shakes has it as well.
- So has one whose load comes at a steady pace, which a stem tells by OP and the waves before tell as well (``paced``).
  A loop with both gains their sum at most.
- A kind of process in which no stick is believed is left out.

Source: Q. H. Vuong, Econometrica 57 (1989) 307-333, of two models neither of which is true.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from stickslip.detect.likelihood.pooled import Evidence
from stickslip.remedy.left import paced
from stickslip.remedy.process import Day, Found, fresh, predicted
from stickslip.remedy.search import best_with, freed

__all__ = ["Weighed", "weighed"]

GAIN, SURE = 10.0, 20.0  # nats
BLOCKS, EVERYWHERE = 20, 1.73  # stretches, and z that Student's t of 19 degrees of freedom passes once in 20


@dataclass(frozen=True, eq=False)
class Weighed:
    """What a stick gains [nats], ``everywhere`` or not; the best loop ``without``; ``starts`` that stick or not."""

    gain: float
    everywhere: bool
    sticks: bool
    without: Found
    starts: Sequence[Found]

    @property
    def note(self) -> str:
        """What is to be said where a stick gains and is not believed; "" else."""
        if self.sticks or self.gain < GAIN:
            return ""
        few = ", but not all along the record" * (not self.everywhere)
        return f"A stick would gain {self.gain:.0f} nats{few}, which is not enough to believe it."


def weighed(days: Sequence[Day], without: Sequence[Found], evidence: Evidence | None) -> Weighed:
    """Seek the loops that stick, and weigh them against those ``without``; no ``evidence``: too little moves."""
    if evidence is None:
        return Weighed(0.0, False, False, without[0], without)
    stuck = best_with(days, without, evidence.S)
    without = sorted([*without, *freed(days, stuck)], key=lambda one: one.nll)
    base, least = predicted(days, without[0].loop, without[0].noises).each, GAIN if evidence.accuses else SURE
    rivals = max(evidence.bends, 0.0) + max(sum(paced(day.free[0]) for day in days), 0.0)
    kinds: dict[bool, Weighed] = {}
    for kind, one in {one.loop.integrating: one for one in reversed(stuck)}.items():
        paths = zip(predicted(days, one.loop, one.noises).shown, days, strict=True)
        moves = np.concatenate([np.diff(x, prepend=x[0]).reshape(-1, day.q).any(axis=1) for (x, _), day in paths])
        blocks = np.array([block.sum() for block in np.array_split(fresh(days, one) - base, BLOCKS)])
        everywhere = bool(blocks.sum() >= EVERYWHERE * math.sqrt(BLOCKS) * np.std(blocks, ddof=1))
        gain = float(blocks @ [block.any() for block in np.array_split(moves, BLOCKS)]) - rivals
        kinds[kind] = Weighed(gain, everywhere, gain >= least and everywhere, without[0], without)
    best = max(kinds.values(), key=lambda each: (each.sticks, each.gain))
    starts = [one for one in stuck if kinds[one.loop.integrating].sticks]
    return Weighed(best.gain, best.everywhere, best.sticks, best.without, starts or without)

"""Whether a record shows a stick: what it gains over the best loop without it, each asked alike.

    gain = ln p(rows; best loop with stick) - ln p(rows; best loop without) - what another bend gains      [nats]
    z    = sum g_j / sqrt(m) s_g,   g_j the difference of the first two in each of m stretches, s_g its spread

The stick is believed where it gains ``SURE`` nats, or ``GAIN`` where ``stickslip.detect.likelihood`` accuses too, and
where z is that of 95 % by Student's t: what a burst of the load gains in one stretch is no stick.

- The loop without stick is sought beside the processes that the stick has found as well.
- The least of many tries is so by luck too: the stick's likelihood is that of other random numbers.
- What a bent characteristic, another answer each way or a sensor with hysteresis gains over a straight line shows no
  stick.  A sound loop that a sticky neighbour shakes has it as well.
- A kind of process in which no stick is believed is left out.

Source: Q. H. Vuong, Econometrica 57 (1989) 307-333, of two models neither of which is true.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from stickslip.detect.likelihood.pooled import Evidence
from stickslip.remedy.process import Day, Found, fresh, predicted
from stickslip.remedy.search import best_with, freed

__all__ = ["Weighed", "weighed"]

GAIN, SURE = 10.0, 20.0  # nats
BLOCKS, EVERYWHERE = 20, 1.73  # stretches, and z that Student's t of 19 degrees of freedom passes once in 20


@dataclass(frozen=True, eq=False)
class Weighed:
    """What a stick gains [nats], ``z``, the best loop ``without`` and the loops to start from, which stick or not."""

    gain: float
    z: float
    sticks: bool
    without: Found
    starts: Sequence[Found]

    @property
    def note(self) -> str:
        """What is to be said where a stick gains and is not believed; "" else."""
        if self.sticks or self.gain < GAIN:
            return ""
        few = f", and {self.z:.1f} times how that varies along the record ({EVERYWHERE} are needed)"
        return (
            f"A stick would gain {self.gain:.0f} nats{few * (self.z < EVERYWHERE)}, which is not enough to believe it."
        )


def weighed(days: Sequence[Day], without: Sequence[Found], evidence: Evidence | None) -> Weighed:
    """Seek the loops that stick, and weigh them against those ``without``; no ``evidence``: too little moves."""
    if evidence is None:
        return Weighed(0.0, 0.0, False, without[0], without)
    stuck = best_with(days, without, evidence.S)
    without = sorted([*without, *freed(days, stuck)], key=lambda one: one.nll)
    base, least = predicted(days, without[0].loop, without[0].noises).each, GAIN if evidence.accuses else SURE
    kinds: dict[bool, Weighed] = {}
    for kind, one in {one.loop.integrating: one for one in reversed(stuck)}.items():
        blocks = np.array([block.sum() for block in np.array_split(fresh(days, one) - base, BLOCKS)])
        z = float(blocks.sum() / (math.sqrt(BLOCKS) * np.std(blocks, ddof=1) + 1e-300))
        gain = float(blocks.sum()) - max(evidence.bends, 0.0)
        kinds[kind] = Weighed(gain, z, gain >= least and z >= EVERYWHERE, without[0], without)
    best = max(kinds.values(), key=lambda each: (each.sticks, each.gain))
    starts = [one for one in stuck if kinds[one.loop.integrating].sticks]
    return Weighed(best.gain, best.z, best.sticks, best.without, starts or without)

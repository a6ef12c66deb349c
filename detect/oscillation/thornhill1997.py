"""Regularity of the crossings of e itself, Thornhill and Hagglund 1997: are the half periods of equal length?

    r = mean(d) / (3 std(d)) over the intervals d between zero crossings,    oscillating if r > 1
    a half period counts while its IAE, the integral of |e|, exceeds 2 a / w: half a sine of amplitude a

The intervals of noise scatter as much as their mean, so that it does not pass; but a little noise on a wave makes
crossings of its own, hence the band of hysteresis, and the ACF (``acf_crossings``) is the better test for noisy loops.

Source: Control Eng. Practice 5 (1997) 1343. Ours: the band, and a tolerated amplitude of half the standard deviation.
"""

import math
from dataclasses import dataclass, replace

import numpy as np
from stickslip.detect.oscillation.even import CYCLES_MIN, regularity
from stickslip.detect.oscillation.gate import GATE_CARD, Gate
from stickslip.detect.oscillation.lobes import lobes
from stickslip.logs import LoopRecord

CARD = replace(
    GATE_CARD,
    name="thornhill1997", title="Regularity of IAE crossings",
    source="Thornhill and Hagglund 1997, Control Eng. Practice 5:1343",
    assumes=("e is centred on zero", "one dominant period"),
    finds="whether half periods are of equal length and large enough",
    cost="O(n)",
    pros=("in time, no spectrum", "checks every half period"),
    cons=("noise adds crossings", "drift takes them away", "one period only"),
)  # fmt: skip


@dataclass(frozen=True)
class Params:
    """Settings.

    regularity_min : least r [-], of the paper
    band : hysteresis about zero [standard deviations]
    tolerated : amplitude a below which a half period does not count [standard deviations]
    share : least share of half periods that count [-]
    """

    regularity_min: float = 1.0
    band: float = 0.3
    tolerated: float = 0.5
    share: float = 0.5


def find(record: LoopRecord, p: Params = Params()) -> Gate:
    """Test the control error of the longest good stretch.

    >>> t = np.arange(0.0, 500.0)
    >>> gate = find(LoopRecord.from_arrays(t, pv=np.sin(2 * np.pi * t / 50), op=t))
    >>> gate.oscillating, round(gate.period)
    (True, 50)
    """
    found = lobes(record, p.band, math.ceil(2.0 * CYCLES_MIN))
    if isinstance(found, Gate):
        return found
    lengths, iae, dt, std, amplitude = found
    loads = float(np.mean(iae > 2.0 * p.tolerated * std * lengths / math.pi))
    r, period = regularity(lengths), 2.0 * float(np.mean(lengths))
    oscillating = r > p.regularity_min and loads >= p.share and period >= 4.0 * dt
    reason = (
        f"{'Regular' if oscillating else 'No regular'} crossings: period {period:.4g} s, regularity {r:.2g} (limit "
        f"{p.regularity_min:g}), {loads:.0%} of {len(lengths)} half periods are large (limit {p.share:.0%})."
    )
    return Gate(oscillating, period, r, amplitude, len(lengths) / 2.0, reason)

"""The card of a detector: what it needs, assumes, finds and costs, as data that tables and tests read."""

import math
from dataclasses import dataclass
from typing import Literal

Need = Literal[
    "oscillation", "own_cycle", "constant_sp", "unsaturated", "fine_pv", "raw_pv", "raw_op", "follows", "known_process",
    "mv",
]  # fmt: skip


@dataclass(frozen=True)
class Card:
    """Facts about one method.

    name : name of the module and of the method in verdicts
    title, source : title for tables; paper with year and place
    signals : what it reads, of "SP", "PV", "OP", "MV"
    assumes : conditions in words
    needs : those that are checked before the method looks at a record (``prepare.preconditions``): a sustained
        oscillation, one of the loop's own making (``oscillation.clock``), a set point that stands still, OP away from
        its limits, PV not on a coarse grid, PV not compressed, OP not compressed, PV that follows OP, the kind of
        process known, the stem position logged
    accuses : whether it may say "stiction"; a method that only ranks tags or measures does not
    cycles : fewest cycles of the oscillation [-]
    samples : points a period that the method can work with [-]
    finds : what the index tells
    index : range that the index can take [-]
    process : tuple of {"self_regulating", "integrating"}; processes it works on
    streams : "exact": a twin that follows every sample; "pooled": a window, and what was found in those before it;
        "window": the last samples alone, as many as ``window_twin.WINDOW``; "no"
    stream_bound : largest relative difference of the index between batch and stream on a stationary record [-]
    stream_note : why it streams on a window alone, or not at all; a sentence
    cost : order of the work for n samples
    kind : gates answer whether the loop oscillates, detectors whether the valve sticks
    experimental : whether the method is still on trial: ``diagnose`` shows its answer, marked

    >>> Card("x", "X", "nobody", ("PV",), (), "nothing", (0, 1), ("self_regulating",), "no").kind
    'detector'
    """

    name: str
    title: str
    source: str
    signals: tuple[str, ...]
    assumes: tuple[str, ...]
    finds: str
    index: tuple[float, float]
    process: tuple[str, ...]
    streams: Literal["exact", "pooled", "window", "no"]
    stream_bound: float = 0.0
    stream_note: str = ""
    pros: tuple[str, ...] = ()
    cons: tuple[str, ...] = ()
    cost: str = "O(n)"
    kind: Literal["detector", "gate"] = "detector"
    experimental: bool = False
    needs: tuple[Need, ...] = ()
    accuses: bool = True
    cycles: float = 0.0
    samples: tuple[float, float] = (0.0, math.inf)

"""Which loops are drawn: every attribute from one law, whether the valve sticks or not; sticking is an axis of its own.

A sound valve has the law, the air and the positioner that were drawn, and a hundredth of the friction.  Half of the
loops stick; of these, valves of the laws ``stems.JUMPLESS`` have dead travel without a jump, and are counted apart.
So is a share ``STANDS`` of all valves, that never move: OP does not leave their band, and PV answers loads alone.
"""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass

import numpy as np
from stickslip.calibration.crossed.loops import DRIVERS, FORMS
from stickslip.calibration.crossed.stems import JUMPLESS, LAWS, POSITIONERS

PROCESSES = ("flow", "pressure", "temperature", "level")
Random = np.random.Generator
WITHHELD = {"law": ("karnopp", "lugre"), "driver": ("master",), "process": ("pressure",)}
"""Families that nothing is learnt from: what the verdict is worth on them is what it is worth elsewhere."""
STANDS = 0.04  # about the share of "dead_loop" in the engine's first law (``stickslip.calibration.drawing``)


@dataclass(frozen=True)
class Drawn:
    """One loop as it is drawn.

    sticks : whether friction is as large as drawn;  S [% of OP], ratio = J / S
    travel : of OP over S, asked of what drives the loop
    loose : closed-loop time over the one of a usual tuning;  points : samples a period;  periods : logged
    stands : whether the stem never moves, whatever else was drawn
    noise : over PV's swing;  other sizes over S, PV's swing or the period, as their names say; 0 where not there
    """

    seed: int
    sticks: bool
    law: str
    S: float
    ratio: float
    process: str
    driver: str
    shape: int
    wander: float
    slow: float
    travel: float
    base: float
    positioner: str
    air: float
    mass: float
    tau: float
    second: float
    dead: float
    gain: float
    bend: float
    form: str
    loose: float
    averaging: bool
    step_op: float
    zone: float
    filter: float
    hysteresis: float
    noise: float
    limited: float
    manual: float
    points: float
    periods: float
    minute: bool
    rounded: float
    compressed: str
    door: float
    sp_logged: bool
    tagged: bool
    stands: bool

    @property
    def kind(self) -> str:
        """The true kind: "stands" (its stem never moves), "sticks", "play" (dead travel without a jump) or "sound"."""
        if self.stands:
            return "stands"
        if not self.sticks:
            return "sound"
        return "play" if self.law in JUMPLESS else "sticks"

    @property
    def withheld(self) -> bool:
        """Whether the loop is of a family that nothing is learnt from."""
        return any(getattr(self, name) in words for name, words in WITHHELD.items())

    def attributes(self) -> dict[str, float | str]:
        """What was drawn, but for the truth, by name."""
        return {name: value for name, value in asdict(self).items() if name not in ("sticks", "stands", "seed")}


def _log(r: Random, low: float, high: float) -> float:
    return math.exp(r.uniform(math.log(low), math.log(high)))


def draw(n: int, seed: int) -> list[Drawn]:
    """``n`` loops, every second with a valve that sticks.

    >>> draw(3, 1) == draw(3, 1), [one.sticks for one in draw(3, 1)]
    (True, [True, False, True])
    """
    return [_one(seed, i) for i in range(n)]


def learnt(n: int, seed: int, first: int = 0) -> list[Drawn]:
    """``n`` loops to learn from, none of a family that is held back, from the number ``first`` on.

    >>> any(one.withheld for one in learnt(40, 1)), any(one.withheld for one in draw(40, 1))
    (False, True)
    """
    found = []
    for i in range(first, first + n):
        one = next(d for k in range(1000) if not (d := _one(seed, i, k)).withheld)
        found.append(one)
    return found


def _one(seed: int, i: int, again: int = 0) -> Drawn:
    r = np.random.default_rng((seed, i, again) if again else (seed, i))

    def sometimes(share: float, low: float, high: float) -> float:
        value = _log(r, low, high)
        return value if r.random() < share else 0.0

    process = str(r.choice(PROCESSES, p=(0.35, 0.2, 0.2, 0.25)))
    driver = str(r.choice(DRIVERS, p=(0.17, 0.13, 0.13, 0.13, 0.13, 0.15, 0.16)))
    law = str(r.choice(LAWS, p=(0.14, 0.12, 0.15, 0.13, 0.13, 0.13, 0.1, 0.1)))
    return Drawn(
        seed=int(r.integers(2**31)), sticks=i % 2 == 0, law=law, S=_log(r, 1.0, 12.0),
        ratio=float(r.uniform(0.03, 0.3) if r.random() < 0.5 else r.uniform(0.3, 1.0)), process=process, driver=driver,
        shape=int(r.integers(3)), wander=_log(r, 0.003, 0.1), slow=_log(r, 1.0, 6.0), travel=_log(r, 0.6, 6.0),
        base=_log(r, 0.02, 0.3), positioner=str(r.choice(POSITIONERS)), air=_log(r, 0.2, 3.0), mass=_log(r, 0.01, 0.3),
        tau=_log(r, 0.5, 3.0), second=_log(r, 0.02, 0.7), dead=_log(r, 0.1, 2.0),
        gain=_log(r, 0.4, 3.0) * float(r.choice((-1.0, 1.0))), bend=float(r.uniform(-0.8, 0.8)),
        form=str(r.choice(FORMS, p=(0.4, 0.35, 0.25))), loose=_log(r, 0.7, 4.0), averaging=bool(r.random() < 0.3),
        step_op=sometimes(0.3, 0.01, 0.3), zone=sometimes(0.12, 0.02, 0.15), filter=sometimes(0.4, 0.01, 0.3),
        hysteresis=sometimes(0.12, 0.05, 0.5), noise=_log(r, 0.004, 0.25), limited=sometimes(0.1, 0.2, 0.8),
        manual=sometimes(0.1, 0.03, 0.2), points=_log(r, 5.0, 60.0), periods=_log(r, 6.0, 60.0),
        minute=bool(r.random() < 0.5), rounded=sometimes(0.25, 0.005, 0.08),
        compressed=str(r.choice(("no", "no", "no", "no", "swinging_door", "exceptions"))), door=_log(r, 0.01, 0.08),
        sp_logged=bool(r.random() < 0.85), tagged=bool(r.random() < 0.4),
        stands=bool(r.random() < STANDS),
    )  # fmt: skip

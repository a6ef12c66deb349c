"""Crossed loops as a law to learn from: record and truth as ``stickslip.calibration.simulate`` gives them."""

from __future__ import annotations

import math

from stickslip.calibration.crossed.drawing import Drawn, learnt
from stickslip.calibration.crossed.history import Seen, seen
from stickslip.calibration.crossings import even, extent, period
from stickslip.calibration.drawing import OTHERS
from stickslip.calibration.spec import Truth
from stickslip.logs import LoopRecord

__all__ = ["crossed", "truth_of"]

WAVES = ("external_sine", "external_square", "external_saw")
SOUND = {
    "nothing": "healthy", "moving_sp": "healthy", "periodic_sp": "cascade_slave", "master": "cascade_slave",
    "load": "external_stochastic", "tuning": "tight_tuning",
}  # fmt: skip


def crossed(n: int, seed: int, first: int = 0) -> list[tuple[LoopRecord, Truth]]:
    """``n`` loops of no family that is held back, from the number ``first`` on.

    >>> crossed(1, 1)[0][1].cause  # dead travel without a jump
    'deadband'
    """
    made = [seen(one) for one in learnt(n, seed, first)]
    return [(one.record, truth_of(one)) for one in made]


def group_of(d: Drawn) -> str:
    """The group of ``stickslip.calibration.drawing`` that a loop comes nearest to: what moves it, or that it sticks."""
    if d.stands:
        return "dead_loop"
    if d.kind == "play":
        return "deadband"
    if d.sticks:
        return "cycling" if d.driver in ("nothing", "tuning") else "excited"
    if d.limited > 0.0:
        return "saturation"
    return WAVES[d.shape] if d.driver == "neighbour" else SOUND[d.driver]


def truth_of(one: Seen) -> Truth:
    """Return the true cause and sizes of a loop."""
    d, op = one.drawn, one.record.op
    group = group_of(d)
    swing = extent(op)
    S = d.S if d.kind in ("sticks", "play") else math.nan
    ratio = d.ratio if d.kind == "sticks" else 0.0
    return Truth(
        cause="stiction" if d.kind == "sticks" else OTHERS[group], group=group, S=S,
        J=S * ratio,
        process="integrating" if d.process == "level" else "self_regulating", cycling=even(op),
        travel=swing / S, op_range=swing, period=period(op) * one.record.dt, defects=(),
    )  # fmt: skip

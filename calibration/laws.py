"""Loops of any law that is learnt from or judged by, by its name."""

from __future__ import annotations

from typing import Literal, TypeAlias

from stickslip.calibration.crossed.labelled import crossed
from stickslip.calibration.drawing import draw
from stickslip.calibration.simulation import simulate
from stickslip.calibration.spec import Kinds, Setting, Truth
from stickslip.logs import LoopRecord

__all__ = ["Law", "loops"]

Law: TypeAlias = Setting | Literal["crossed"]


def loops(
    law: Law, n: int, seed: int, kinds: Kinds = "usual", workers: int | None = 1
) -> list[tuple[LoopRecord, Truth]]:
    """Record and truth of ``n`` loops; ``kinds`` as in ``draw`` and of no effect on crossed ones."""
    return crossed(n, seed) if law == "crossed" else simulate(draw(n, seed, law, kinds=kinds), workers)

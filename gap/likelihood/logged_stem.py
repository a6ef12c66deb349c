"""What a logged stem says of where a gap lies: before it if it does not follow OP, behind it if it does.

    |MV - (c OP + d)| <= half a digit of MV + |c| half a digit of OP          follows, but for a few rows

A filter takes in PV and OP alone; the stem decides which effects can be: those of the valve that act on the stem, or
all others.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from stickslip.blocks.role import Role
from stickslip.diagram.diagram import Diagram
from stickslip.gap.exact.affine import NotAffine, affine
from stickslip.gap.insertion.effect import Effect
from stickslip.gap.insertion.inserted import Inserted
from stickslip.gap.insertion.paths import given
from stickslip.gap.records.record import Record, rounding

SLACK = 1.2  # of the digits, beyond which a stem is elsewhere
FEW = 0.002  # share of rows at which it may be, and at least
FEWEST = 3  # rows


@dataclass(frozen=True)
class LoggedStem:
    """``signal`` of the stem of the valve at ``place``; whether it ``follows`` OP as the model says."""

    signal: str
    place: str
    follows: bool

    def without(self, record: Record) -> Record:
        """Return the record as if the stem had not been logged."""
        return replace(record, pinned=tuple(s for s in record.pinned if s != self.signal))

    def possible(self, catalogue: Sequence[Effect]) -> tuple[Effect, ...]:
        """Return the effects that can be: those on the stem if it does not follow, else the others."""
        return tuple(effect for effect in catalogue if on_stem(effect) != self.follows)


def on_stem(effect: Effect) -> bool:
    """Return whether an effect acts on the position of a valve's stem, not on the flow behind it.

    >>> from stickslip.gap.effects import effect
    >>> on_stem(effect("positioner_lag")), on_stem(effect("valve_gain")), on_stem(effect("second_lag"))
    (True, False, False)
    """
    return isinstance(effect, Inserted) and effect.role is Role.VALVE and effect.where == "at"


def logged_stem(diagram: Diagram, record: Record) -> LoggedStem | None:
    """Return what the log says of the stem of a valve that follows its logged input at once; None if it has none."""
    for block in diagram.blocks:
        if block.role is not Role.VALVE or len(block.input_labels) != 1 or len(block.output_labels) != 1:
            continue
        command, stem = str(block.input_labels[0]), given(diagram, block.name)
        if command not in record.pinned or stem not in record.pinned:
            continue
        good = record.log.good(command) & record.log.good(stem)
        OP, MV = record.log[command][good], record.log[stem][good]
        try:
            line = affine(block, np.array([float(OP.mean())]))
        except NotAffine:
            continue
        if line.states:
            continue
        slope, offset = float(line.given[0, 0]), float(line.given[0, -1])
        digits = 0.5 * (rounding(MV) + abs(slope) * rounding(OP)) + 1e-9 * float(np.ptp(OP))
        apart = np.abs(MV - (slope * OP + offset)) > SLACK * digits
        return LoggedStem(stem, block.name, bool(apart.sum() <= max(FEWEST, FEW * len(MV))))
    return None

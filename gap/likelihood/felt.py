"""Whether a loop feels what its log does not tell of a set point."""

import numpy as np
from stickslip.blocks.role import Role
from stickslip.gap.likelihood.hypothesis import Innovations
from stickslip.gap.likelihood.inputs import in_lines, moves, rounded

FELT = 0.1  # standard deviations of what a filter misses of OP, from which on a doubt shows in some hundred rows


def felt(plain: Innovations) -> bool:
    """Return whether outputs of controllers feel the doubts of their set points, beside what a filter misses."""
    f, record = plain.hypothesis.frame, plain.hypothesis.frame.record
    doubts = rounded(record)
    doubts |= {s: in_lines(record, s) for s in record.played if moves(record, s)}
    for block in (b for b in f.quiet.blocks if b.role is Role.CONTROLLER):
        op, sp = str(block.output_labels[0]), str(block.loop_signal("SP"))
        if sp in doubts and op in f.signals:
            off = abs(block.params.get("K_p", 1.0)) * (doubts[sp].step / np.sqrt(12.0) + doubts[sp].spread)
            if off > FELT * float(np.sqrt(np.nanmedian(plain.S[:, f.signals.index(op)]))):
                return True
    return False

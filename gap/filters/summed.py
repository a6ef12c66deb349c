"""The output of a controller that is logged with something added: a feedforward, a bias, a change of units.

    X = w OP + sum_j w_j u_j + c,  X and all u_j logged        OP = (X - sum_j w_j u_j - c) / w

OP is rounded as X is: by step(X) / |w|.
"""

from dataclasses import replace

import numpy as np
from stickslip.blocks.block import Block
from stickslip.diagram.diagram import Diagram
from stickslip.gap.filters.affine import NotAffine, affine
from stickslip.gap.records.record import Record, rounding
from stickslip.logs import Log


def with_outputs(diagram: Diagram, record: Record, outputs: tuple[str, ...]) -> Record:
    """Return the record with outputs of controllers in place of what is logged of them; as it is where they are logged.

    ``outputs``: signals that controllers give.
    """
    for OP in outputs:
        if OP in record.pinned:
            continue
        for block in diagram.blocks:
            if OP in map(str, block.input_labels) and (found := _computed(diagram, record, block, OP)) is not None:
                record = found
                break
    return record


def _computed(diagram: Diagram, record: Record, block: Block, OP: str) -> Record | None:
    """Return the record with OP from what a block that reads it gives; None if that is not logged, or not affine."""
    log, ins, outs = record.log, [str(s) for s in block.input_labels], [str(s) for s in block.output_labels]
    others = [s for s in ins if s != OP]
    if len(outs) != 1 or outs[0] not in record.pinned or not all(s in log for s in others) or block.dead_time > 0.0:
        return None
    X = outs[0]
    known = np.all([log.good(s) for s in (X, *others)], axis=0)
    means = {s: float(log[s][known].mean()) for s in (X, *others)} if known.any() else {}
    try:
        line = affine(block, np.array([means.get(s, 0.0) for s in ins]))
    except NotAffine:
        return None
    weights = dict(zip(ins, line.given[0, : len(ins)].tolist(), strict=True))
    if line.states or weights[OP] == 0.0:
        return None
    rest = np.sum([weights[s] * log[s] for s in others], axis=0) + line.given[0, -1]
    values = np.where(known, (log[X] - rest) / weights[OP], np.nan)
    step = rounding(log[X][log.good(X)]) / abs(weights[OP])
    note = f"{OP} was computed from the logged {', '.join((X, *others))}."
    kept = {s: OP if s == X else s for s in log.names}
    signals = {name: values if s == X else log[s] for s, name in kept.items()}
    quality = {s: mask for s, mask in log.quality.items() if s != X}
    other = Log(log.t, signals, quality=quality, origin=log.origin, start=log.start, notes=(*log.notes, note))
    pinned = tuple(kept.get(s, s) for s in record.pinned)
    return replace(record, log=other, pinned=pinned, computed={**record.computed, OP: step})

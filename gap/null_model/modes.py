"""Modes that no log shows: whether a stem sticks or slides.  A replay that has it wrong is wrong until the next slip.

The next row tells, so the interval before it is run again in each mode (``stickslip.diagram.branches``), and one that
brings the row down to half is kept.  Each costs ``CHARGE`` nats, what a mode of three at one row of a record is worth.

What tells is the controller's output, which is as sharp as it is rounded.  Where it is rounded so coarsely that no
wrong mode shows in it, the noisy measurement has to tell, some rows late: there the last ``SEVERAL`` intervals are run
again.
"""

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike
from stickslip.blocks.block import Block
from stickslip.diagram.branches import Branches
from stickslip.diagram.diagram import Diagram
from stickslip.gap.null_model.null_model import NullModel
from stickslip.gap.records.record import Record

BEYOND = 20.0  # of its scale without a gap, from which on an innovation tells a wrong mode
SHARE = 0.5  # of what it was, to which another mode must bring a row
LATEST, OF_LAG = 3, 2  # rows by which a mode that is wrong may show late, at most, and behind a lag
PATIENCE = 4  # rows that go by, at most, where no mode has helped before (branches)
COARSE = 0.01  # of its range: an output whose limit is larger shows no wrong mode
LEVEL, SEVERAL, PART = 4.0, 6, 0.7  # the same of a noisy level: its limit, rows that it may be late, share
CHARGE = 6.0  # nats of a mode that is set right


def sticking(block: Block) -> bool:
    """Return whether a block may stick or slide.

    >>> from stickslip.blocks import Deadband, FirstOrder
    >>> sticking(Deadband(0.1)), sticking(FirstOrder(1.0, 1.0))
    (True, False)
    """
    return "stuck" in block.modes and not block.sampled


def branches_of(
    diagram: Diagram,
    model: Diagram,
    record: Record,
    null_model: NullModel,
    params: Mapping[str, ArrayLike] | None = None,
) -> Branches | None:
    """Return when to try other modes of the stem that an effect has put into a diagram; None if there is none.

    ``model``: the diagram without any effect; ``params`` of the runs.  Changes of a controller's output tell, and the
    level of a stem; what is noisy only where these are too coarse; never residuals predicted from earlier ones.
    """
    known = {block.name for block in model.blocks}
    stems = [block.name for block in diagram.blocks if block.name not in known and sticking(block)]
    if not stems or null_model.coloured or record.filter is not None:
        return None
    scale = dict(zip(record.pinned, null_model.L.diagonal().tolist(), strict=True))
    changes = {s: BEYOND * scale[s] for s, yes in zip(record.pinned, null_model.changes, strict=True) if yes}
    stem = {str(s) for s in diagram[stems[0]].output_labels}
    if not stem & set(scale) and all(limit > COARSE * float(np.ptp(record.known(s))) for s, limit in changes.items()):
        levels = {s: LEVEL * scale[s] for s in record.pinned if s not in changes}
        return Branches(stems[0], offsets=levels, share=PART, patience=PATIENCE, back=SEVERAL) if levels else None
    offsets = {s: BEYOND * scale[s] for s in record.pinned if s in stem and s not in changes}
    if not (changes or offsets):
        return None
    back = 0 if offsets else _late(diagram, known, params or {}, record.log.dt)
    return Branches(stems[0], changes=changes, offsets=offsets, share=SHARE, patience=PATIENCE, back=back)


def _late(diagram: Diagram, known: set[str], params: Mapping[str, ArrayLike], dt: float) -> int:
    """Return how many rows late a wrong mode may show: behind dead times, and lags that an effect has put in."""
    dead = 0.0
    for block in diagram.blocks:
        if block.dead_time_param:
            dead += float(np.max(params.get(f"{block.name}.{block.dead_time_param}", block.dead_time)))
    added = [b for b in diagram.blocks if b.name not in known and not sticking(b)]
    lags = any(b.state_names and not b.role.drives for b in added)
    return min(LATEST, math.ceil(dead / dt) + (OF_LAG if lags else 0))

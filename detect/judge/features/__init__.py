"""What the judge is told of a loop record, without a unit: no amplitude, interval or offset of the record is in it.

    view         the record in its own units: OP and PV over their spread, time in turns of OP
    network      scores of learnt convolutions over OP, PV, e, what is new in PV, and what each size of stick leaves
    dead_travel  nats by which dead travel beats its rivals in the record's own likelihood, the best tenth left out
    likely_S     ln of the likeliest S over OP's travel, where dead travel gains ten nats
    likely_share gain / (gain + ``HALF_NATS``), how much that S counts beside the network's
    samples      ln of the samples of the record between two turns of OP;  turns   ln of how many turns there are

Of 290 features of ten families, and later of 60, the first two told loops of unseen physics apart as well as all.
"""

import math

from stickslip.detect.judge.features.earned import usable
from stickslip.detect.judge.features.network import network_features
from stickslip.detect.judge.features.view import View, view_of
from stickslip.detect.likelihood.pooled import GAIN_NATS
from stickslip.detect.prepare.prepared import Prepared

__all__ = ["MOST_NATS", "View", "features", "features_of", "view_of"]

MOST_NATS = 100.0  # nats: more of them tell no more
HALF_NATS = 50.0  # from which on the likeliest S counts more than the network's; of 20, 50, 100 on seeds 11 to 19


def features(loop: Prepared) -> dict[str, float] | None:
    """All features of a prepared record by name; None where the record shows too little for any (``view_of``).

    >>> import numpy as np
    >>> from stickslip.logs import LoopRecord
    >>> t = np.arange(500.0)
    >>> found = features(Prepared(LoopRecord.from_arrays(t, pv=np.sin(t / 8), op=50 - np.cos(t / 8), sp=0 * t)))
    >>> found is not None and found["network_sticky"] < 0
    True
    """
    view = view_of(loop)
    return None if view is None else features_of(loop, view)


def features_of(loop: Prepared, view: View) -> dict[str, float]:
    """All features of a record and its view by name [-]; NaN where dead travel cannot be weighed or does not gain."""
    found = loop.dead_travel if usable(loop) else None
    gain = math.nan if found is None else min(found.gain, found.without_best)
    likely = share = math.nan
    if found is not None and gain >= GAIN_NATS:
        travel = view.travel * view.op_scale
        likely = math.log(found.S / (loop.op_percent(travel) or travel))
        share = gain / (gain + HALF_NATS)
    return network_features(view) | {
        "dead_travel": min(max(gain, -MOST_NATS), MOST_NATS), "likely_S": likely, "likely_share": share,
        "samples": math.log(view.turn * view.block), "turns": math.log(len(view) / view.turn),
    }  # fmt: skip

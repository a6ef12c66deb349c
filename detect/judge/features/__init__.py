"""Features of a loop record that have no unit: no amplitude, length, period or offset of the record is in them.

    view        the record in its own units: OP and PV over their spread, time in turns of OP
    network     scores of learnt convolutions over OP, PV, e, what is new in PV, and what each size of stick would leave
    dead_travel what the record's own likelihood says, which nothing has to learn
    process     1 where PV is known to integrate, 0 where to settle: a play makes a level cycle as a stick does

Of 290 features of ten families the first two separated loops of unseen physics as well as all together, or better.
"""

from __future__ import annotations

import math

from stickslip.detect.judge.features.dead_travel import dead_travel_features
from stickslip.detect.judge.features.earned import usable
from stickslip.detect.judge.features.network import network_features
from stickslip.detect.judge.features.view import View, view_of
from stickslip.detect.prepare.prepared import Prepared

__all__ = ["View", "features", "features_of", "view_of"]


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
    """All features of a record and its view by name [-]; those of dead travel only where it can be weighed."""
    found = network_features(view) | _process(view)
    if usable(loop) and loop.stems is not None and loop.dead_travel is not None:
        found |= dead_travel_features(loop.dead_travel, loop.stems)
    return {name: float(value) if math.isfinite(value) else math.nan for name, value in sorted(found.items())}


def _process(view: View) -> dict[str, float]:
    """What is known of the process, by its tag or by what the user says."""
    return {"process_integrates": math.nan if view.integrating is None else float(view.integrating)}

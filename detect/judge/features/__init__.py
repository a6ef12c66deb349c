"""Features of a loop record that have no unit: no amplitude, length, period or offset of the record is in them.

    view        the record in its own units: OP and PV over their spread, time in turns of OP
    play        a play or stick between OP and PV against the same lag without
    innovations one step ahead: what the stem adds to OP, and the slips
    folds       the mean cycle of OP and PV, with a play on it
    shapes      half waves of OP, e and the slope of PV
    waves       regularity, harmonics, time shifts
    steps       how OP and PV move and stand
    setting     sampling, noise, resolution, drift, set point, controller
    patterns    scores of random convolution kernels over OP, PV, e and what is new in PV
    network     scores of learnt convolutions over these and over what each size of stick would leave new in PV

``features(loop)`` gives all of them by name, NaN where one does not apply; about 30 ms for 3,000 samples.
"""

from __future__ import annotations

import math

from stickslip.detect.judge.features.folds import fold_features
from stickslip.detect.judge.features.innovations import innovation_features
from stickslip.detect.judge.features.network import network_features
from stickslip.detect.judge.features.patterns import pattern_features
from stickslip.detect.judge.features.play import play_features
from stickslip.detect.judge.features.setting import setting_features
from stickslip.detect.judge.features.shapes import shape_features
from stickslip.detect.judge.features.steps import step_features
from stickslip.detect.judge.features.view import View, view_of
from stickslip.detect.judge.features.waves import wave_features
from stickslip.detect.prepare.prepared import Prepared

__all__ = ["View", "features", "features_of", "view_of"]

FAMILIES = (
    play_features, innovation_features, fold_features, shape_features, wave_features, step_features, setting_features,
    pattern_features, network_features,
)  # fmt: skip


def features(loop: Prepared) -> dict[str, float] | None:
    """All features of a prepared record by name; None where the record shows too little for any (``view_of``).

    >>> import numpy as np
    >>> from stickslip.logs import LoopRecord
    >>> t = np.arange(500.0)
    >>> found = features(Prepared(LoopRecord.from_arrays(t, pv=np.sin(t / 8), op=50 - np.cos(t / 8), sp=0 * t)))
    >>> found is not None and -0.01 < found["op_sine"] < 0.01
    True
    """
    view = view_of(loop)
    return None if view is None else features_of(view)


def features_of(view: View) -> dict[str, float]:
    """All features of a view by name [-], in the order of their names."""
    found: dict[str, float] = {}
    for family in FAMILIES:
        found |= family(view)
    return {name: float(value) if math.isfinite(value) else math.nan for name, value in sorted(found.items())}

"""Stiction detectors: functions from a LoopRecord to a Verdict; most can also take a loop sample by sample.

One loop in five lines:

>>> import numpy as np
>>> from stickslip.detect import diagnose
>>> from stickslip.logs import LoopRecord
>>> t = np.arange(1000.0)
>>> loop = LoopRecord.from_arrays(t, pv=np.sin(t / 8), op=50 + np.cos(t / 8), sp=0 * t, name="FIC211")
>>> answer = diagnose(loop)
>>> print(answer.verdict)  # clearing must be earned
inconclusive

``answer.reason`` says why, ``answer.to_dict()`` is ready for JSON, ``answer.plot()`` draws it. A single method is a
module with a CARD, Params and ``detect(record) -> Verdict``; all of them stand in METHODS. One from outside the
package is given as ``diagnose(loop, [*METHODS, mine])``; see ``Method``. ``compare(loop)`` shows all
methods side by side.
"""

from types import ModuleType

from stickslip.detect.card import Card
from stickslip.detect.comparison import Comparison, compare
from stickslip.detect.diagnosis import Diagnosis, diagnose
from stickslip.detect.method import Method
from stickslip.detect.methods import (
    area_ratio,
    bicoherence,
    change_no_change,
    cross_correlation,
    curve_fit,
    dead_travel,
    derivative_histogram,
    dtw_shapes,
    hagglund2011,
    hammerstein,
    harmonics,
    high_passed_pv,
    parallelogram,
    play_fit,
    qualitative_movements,
    qualitative_shapes,
    relay_fit,
    second_difference_kurtosis,
    segmentation,
    shifted_pv,
    stem_play,
    surrogates,
    window_tests,
)
from stickslip.detect.oscillation import (
    acf_crossings,
    forsman_stattin,
    hagglund1995,
    miao_seborg,
    salsbury_singhal,
    several_periods,
    thornhill1997,
)
from stickslip.detect.oscillation.gate import Gate
from stickslip.detect.plantwide.survey import Survey, survey
from stickslip.detect.verdict import Verdict

__all__ = [
    "GATES", "METHODS", "Card", "Comparison", "Diagnosis", "Gate", "Method", "Survey", "Verdict", "compare",
    "diagnose", "survey",
]  # fmt: skip

METHODS: tuple[Method, ...] = (
    area_ratio, bicoherence, change_no_change, cross_correlation, curve_fit, dead_travel, derivative_histogram,
    dtw_shapes, hagglund2011, hammerstein, harmonics, high_passed_pv, parallelogram, play_fit, qualitative_movements,
    qualitative_shapes, relay_fit, second_difference_kurtosis, segmentation, shifted_pv, stem_play, surrogates,
    window_tests,
)  # fmt: skip
"""Every stiction method, by hand; a test fails when a module with a CARD of kind "detector" is missing."""

GATES: tuple[ModuleType, ...] = (
    acf_crossings, forsman_stattin, hagglund1995, miao_seborg, salsbury_singhal, several_periods, thornhill1997,
)  # fmt: skip
"""Every oscillation detector: modules with ``find(record) -> Gate``."""

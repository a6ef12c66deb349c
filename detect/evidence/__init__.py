"""The evidence in a report, besides the verdict: stem, spectrum, correlations, and the verdict over time."""

from stickslip.detect.evidence.correlations import Correlation, correlation
from stickslip.detect.evidence.set_point import set_point_words
from stickslip.detect.evidence.spectra import Spectrum, spectrum
from stickslip.detect.evidence.stem import StemTrend, stem_trend
from stickslip.detect.evidence.windows import OverTime, Window, over_time

__all__ = [
    "Correlation", "OverTime", "Spectrum", "StemTrend", "Window", "correlation", "over_time", "set_point_words",
    "spectrum", "stem_trend",
]  # fmt: skip

"""What a report shows of a loop besides the verdict: stem, spectrum, correlations, and the verdict over time."""

from detect.evidence.correlations import Correlation, correlation
from detect.evidence.set_point import set_point_words
from detect.evidence.spectra import Spectrum, spectrum
from detect.evidence.stem import StemTrend, stem_trend
from detect.evidence.windows import OverTime, Window, over_time

__all__ = [
    "Correlation", "OverTime", "Spectrum", "StemTrend", "Window", "correlation", "over_time", "set_point_words",
    "spectrum", "stem_trend",
]  # fmt: skip

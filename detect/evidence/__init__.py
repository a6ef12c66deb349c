"""What a report shows of a loop beside the verdict: stem, spectrum, correlations, and the verdict over time."""

from detect.evidence.correlation import Correlation, correlation
from detect.evidence.over_time import OverTime, Window, over_time
from detect.evidence.spectrum import Spectrum, spectrum
from detect.evidence.stem import StemTrend, stem_trend

__all__ = [
    "Correlation", "OverTime", "Spectrum", "StemTrend", "Window", "correlation", "over_time", "spectrum", "stem_trend",
]  # fmt: skip

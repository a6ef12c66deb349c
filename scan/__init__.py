"""Many loops at once: read from a plant's files, judged on all cores or a cluster, ranked, and kept on the way."""

from stickslip.scan.result import ScanResult
from stickslip.scan.run import ScanError, scan

__all__ = ["ScanError", "ScanResult", "scan"]

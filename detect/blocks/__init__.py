"""Filters and detectors as sampled blocks of a diagram.

    PrefilterBlock   the Kalman noise prefilter: PV in, filtered PV and noise estimate out
    DetectorBlock    a streaming detector: SP, PV, OP in, index and verdict out

Their signals are signals of the simulation like any other: they can be logged, plotted and fed back.
"""

from stickslip.detect.blocks.detector import DetectorBlock
from stickslip.detect.blocks.prefilter import PrefilterBlock

__all__ = ["DetectorBlock", "PrefilterBlock"]

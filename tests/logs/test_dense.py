"""A long trend of many cycles is a band, not a solid block; a slow one of as many samples is a line."""

import numpy as np
import pytest
from stickslip.detect.figures.loop_trend import plot_trend
from stickslip.logs import LoopRecord

from stickslip.commands.report.page import figure_to_svg


@pytest.mark.parametrize(("period", "bands"), [(60.0, 2), (40_000.0, 0)])
def test_band_or_line(period, bands):
    t = np.arange(100_000.0)
    record = LoopRecord.from_arrays(t, pv=np.sin(2 * np.pi * t / period), op=50 + np.cos(2 * np.pi * t / period))
    figure = plot_trend(record)
    drawn = [one for axes in figure.axes for one in axes.collections]
    assert len(drawn) == bands
    assert len(figure_to_svg(figure)) < 400_000
    for band in drawn:  # analytic: a band reaches from the lowest to the highest value of the wave
        points = np.concatenate([path.vertices[:, 1] for path in band.get_paths()])
        assert np.ptp(points) == pytest.approx(2.0, abs=0.02)

"""Pictures and sentences of a study on a table written by hand: what oscillates, what rests, and what is said of it."""

from itertools import product

import numpy as np
import polars as pl
import pytest
from stickslip.study.axes import axes_of
from stickslip.study.findings import Findings
from stickslip.study.growth import draw_growth
from stickslip.study.maps import draw_maps
from stickslip.study.spread import draw_spread
from stickslip.study.summary import summary

GAINS, FRICTIONS = (1.0, 2.0), (10.0, 20.0, 30.0)


def findings(amplitude):
    """Runs over gain and friction, two starts each; ``amplitude`` of OP [%] by (gain, friction, start), PV a tenth."""
    rows = []
    for g, f, k in product(GAINS, FRICTIONS, (0, 1)):
        size = amplitude(g, f, k)
        row = {"run": 0, "point": 0, "kick": k, "c.gain": g, "v.F": f, "status": "OK", "reason": "", "ended": 100.0}
        for signal, percent in (("OP", size), ("PV", size / 10.0)):
            row |= {f"{signal}.mean": 1.0, f"{signal}.amplitude": percent / 100.0}
            row[f"{signal}.period"] = 50.0 if size else None
        rows.append(row)
    axes = axes_of("vary", {"v.F": list(FRICTIONS), "c.gain": list(GAINS)})
    request = {"subject": "hand", "measure_from": 50.0, "duration": 100.0}
    return Findings(pl.DataFrame(rows), request, axes, ("OP", "PV"), {}, {})


GROWS = findings(lambda gain, friction, start: friction if friction == 30.0 or (friction == 20.0 and not start) else 0)
STILL = findings(lambda gain, friction, start: 1e-9)
ONE_GAIN = findings(lambda gain, friction, start: friction if gain == 2.0 else 0.0)


def medians(figure):
    return [line.get_ydata().tolist() for line in figure.axes[0].lines]


def test_runs_at_rest_are_counted_and_drag_no_quantile_to_zero():
    figure = draw_spread(GROWS)
    assert medians(figure) == [[pytest.approx(20.0), pytest.approx(2.0)], [pytest.approx(30.0), pytest.approx(3.0)]]
    counts = [bar.get_height() for ax in figure.axes for bars in ax.containers for bar in bars]
    assert counts == [0.0, 50.0, 100.0] * 2
    low, high = figure.axes[0].get_ylim()
    assert low > 0.1 and high < 1000.0, "the axis spans what oscillates"


def test_columns_in_which_nothing_oscillates_are_said_and_not_drawn():
    figure = draw_spread(ONE_GAIN)
    assert sum("c.gain" in ax.get_title(loc="left") for ax in figure.axes) == 1
    assert "nothing oscillates at c.gain = 1" in figure.get_suptitle()


def test_values_at_which_all_rests_are_marked():
    upper = draw_growth(GROWS).axes[0]
    assert np.allclose(upper.lines[0].get_ydata(), [np.nan, 20.0, 30.0], equal_nan=True)
    crosses = next(line for line in upper.lines if line.get_marker() == "x")
    assert crosses.get_xdata().tolist() == [10.0]


def test_cells_at_rest_say_so():
    told_there = [text.get_text() for text in draw_maps(GROWS).axes[0].texts]
    assert told_there.count("at rest") == 2 and "30" in told_there


def test_sentences():
    said = summary(GROWS)
    assert said[""] == "6 of 12 runs oscillate; the others come to rest."
    assert said["spread"] == "Most at OP, 30 % in the median, least at PV, 3 %."
    assert said["growth"] == (
        "From v.F = 20 on half of the runs or more oscillate; OP swings by 20 % at 20 and 30 % at 30."
    )
    assert said["map"] == "PV swings most, 3 %, at v.F = 30, c.gain = 2."
    assert summary(STILL)[""] == "None of the 12 runs oscillates: all come to rest."


def test_a_study_at_rest_is_drawn():
    for figure in (draw_spread(STILL), draw_growth(STILL), draw_maps(STILL)):
        figure.canvas.draw()

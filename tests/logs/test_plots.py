"""Figures: what is drawn where; how they look is judged by eye."""

import io

import numpy as np
import pytest
from stickslip.logs import Log, LogError, LoopRecord


def lines_of(axes):
    return {line.get_label(): line for line in axes.lines}


def holed() -> LoopRecord:
    t = np.concatenate([np.arange(10.0), 40 + np.arange(10.0)])
    pv = np.arange(20.0)
    pv[3] = np.nan
    log = Log(
        t=t,
        signals={"SP": np.full(20, 9.0), "PV": pv, "OP": np.linspace(50, 60, 20), "MV": np.linspace(50, 59, 20)},
        units={"PV": "m3/h", "OP": "%"},
        quality={"PV": np.arange(20) != 6},
    )
    return log.loop(name="FIC7")


def test_loop_panels():
    axes = holed().plot().axes
    assert [a.get_ylabel() for a in axes] == ["PV [m3/h]", "OP [%]", "PV [m3/h]", "MV"]
    assert [a.get_xlabel() for a in axes] == ["", "time [s]", "OP [%]", "OP [%]"]
    assert {"SP", "PV"} <= set(lines_of(axes[0]))
    assert {"OP", "MV (stem)"} <= set(lines_of(axes[1]))


def test_missing_bad_and_gaps_break_the_line():
    upper = holed().plot().axes[0]
    line = lines_of(upper)["PV"].get_ydata()
    assert len(line) == 21, "20 samples and a break in the gap"
    assert np.flatnonzero(np.isnan(line)).tolist() == [3, 6, 10]
    crosses = [line for line in upper.lines if line.get_marker() == "x"]
    assert crosses[0].get_xydata().tolist() == [[6.0, 6.0]], "the bad value is shown, not joined"
    named = [patch.get_label() for patch in upper.patches]
    assert len(named) == 3 and {"not good", "gap"} <= set(named), "two bad stretches and the gap are shaded"


def test_phase_plot_joins_good_samples_only():
    phase = holed().plot().axes[2].lines[0]
    assert np.flatnonzero(np.isnan(phase.get_ydata())).tolist() == [3, 6, 10]


def test_log_panels():
    log = holed().log
    assert len(log.plot().axes) == 4
    assert [a.get_ylabel() for a in log.plot("PV").axes] == ["PV [m3/h]"]
    assert [a.get_ylabel() for a in log.plot(["OP", "PV"]).axes] == ["OP [%]", "PV [m3/h]"]
    with pytest.raises(LogError, match="no signal 'pv'"):
        log.plot("pv")
    with pytest.raises(LogError, match="no signal to plot"):
        log.plot([])


@pytest.mark.parametrize("kind", ["png", "svg"])
@pytest.mark.parametrize(
    "loop",
    [
        holed(),
        LoopRecord.from_arrays([5.0], pv=[1.0], op=[50.0]),
        LoopRecord.from_arrays([0, 1], pv=[np.nan, np.nan], op=[50, 50]),
        LoopRecord.from_arrays(range(30_000), pv=np.ones(30_000), op=np.ones(30_000)),
    ],
    ids=["holed", "one sample", "nothing good", "long and constant"],
)
@pytest.mark.filterwarnings("error")
def test_every_record_can_be_drawn(loop, kind):
    for figure in (loop.plot(), loop.log.plot()):
        file = io.BytesIO()
        figure.savefig(file, format=kind)
        assert file.tell() > 1000


def test_time_is_shown_in_a_fitting_unit():
    loop = LoopRecord.from_arrays(np.arange(0, 7200, 10.0), pv=np.ones(720), op=np.ones(720))
    lower = loop.plot().axes[1]
    assert lower.get_xlabel() == "time [min]"
    assert lower.get_xlim() == pytest.approx((0, 7190 / 60))


def test_no_global_state_of_matplotlib_is_touched():
    import matplotlib.pyplot as plt

    before = plt.get_fignums()
    holed().plot()
    assert plt.get_fignums() == before


def test_time_is_that_of_the_clock_where_it_is_known():
    from datetime import datetime

    from matplotlib.dates import num2date

    t = np.arange(7200.0)
    log = Log(t=t, signals={"PV": np.sin(t / 60)}, start=datetime(2024, 3, 30, 23, 0))
    ax = log.plot().axes[0]
    first, last = (num2date(x).replace(tzinfo=None) for x in ax.get_xlim())
    assert (first, last) == (datetime(2024, 3, 30, 23, 0), datetime(2024, 3, 31, 0, 59, 59))
    assert ax.get_xlabel() == "clock time, from 2024-03-30 23:00:00"
    ax.figure.canvas.draw()
    assert sum(first <= num2date(x).replace(tzinfo=None) <= last for x in ax.get_xticks()) >= 3


def test_a_long_record_is_drawn_with_few_points_that_keep_its_extremes():
    n = 500_000
    x = np.sin(np.arange(n) / 7.0)
    x[123_456] = 9.0
    (band,) = Log(t=np.arange(float(n)), signals={"PV": x}).plot().axes[0].collections
    (outline,) = band.get_paths()
    assert len(outline.vertices) <= 4001 and outline.vertices[:, 1].max() == 9.0
    slow = np.sin(np.arange(n) / 7000.0)
    slow[123_456] = 9.0
    line = Log(t=np.arange(float(n)), signals={"PV": slow}).plot().axes[0].lines[0]
    assert len(line.get_xdata()) <= 4001 and np.nanmax(line.get_ydata()) == 9.0


def test_rounding_is_drawn_as_rest():
    x = 40.95 + 1e-14 * np.arange(200.0)
    ax = Log(t=np.arange(200.0), signals={"V": x}).plot().axes[0]
    low, high = ax.get_ylim()
    assert high - low > 1.0 and ax.texts[0].get_text() == "at rest at 40.95"
    ax.figure.canvas.draw()
    assert max(len(label.get_text()) for label in ax.get_yticklabels()) <= 5


def test_every_axis_has_ticks_to_read_it_by():
    for values in ([5.0, 5.1], [0.0, 1e-9], [123456.0, 123457.0], [7.0, 7.0]):
        ax = Log(t=[0.0, 1.0], signals={"PV": values}).plot().axes[0]
        low, high = ax.get_ylim()
        assert sum(low <= tick <= high for tick in ax.get_yticks()) >= 2

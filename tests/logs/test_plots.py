"""Figures: what is drawn where; how they look is judged by eye."""

import io

import numpy as np
import pytest

from logs import Log, LogError, LoopRecord


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
    assert len(upper.patches) == 2, "two bad stretches are shaded"


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

"""Pictures of verdicts: sides and colours; how they look is judged by eye."""

import numpy as np
import pytest
from stickslip.detect import diagnose
from stickslip.detect.methods import area_ratio
from stickslip.logs import LoopRecord
from stickslip.logs.figures import COLOURS


@pytest.fixture
def lopsided():
    """A flow whose error rises slowly and falls fast while PV is below SP, and is a sine while PV is above it."""
    t = np.arange(3000.0)
    phase = t % 100.0 / 100.0
    late = np.where(phase < 0.45, phase / 0.45, (0.5 - phase) / 0.05)
    e = np.where(phase < 0.5, late, np.sin(2.0 * np.pi * phase))
    return LoopRecord.from_arrays(t, pv=50.0 - e, op=40.0 + np.cumsum(e) * 0.01, sp=np.full(3000, 50.0),
                                  process="self_regulating")  # fmt: skip


def test_each_half_cycle_stands_on_its_side_of_the_set_point(lopsided):
    axes = area_ratio.detect(lopsided).plot().axes[1]
    assert [tick.get_text() for tick in axes.get_xticklabels()] == ["PV below SP", "PV above SP"]
    below, above = (np.median(line.get_ydata()) for line in axes.lines[:2])
    assert below > 1.5 * above  # analytic: triangle with its peak at 0.9 of the half period, R = 9; sine, R = 1


def test_signals_have_the_colours_of_the_house(lopsided):
    figure = diagnose(lopsided).plot(words=False)
    drawn = {line.get_label(): line.get_color() for ax in figure.axes for line in ax.lines}
    assert {part: drawn[part] for part in ("SP", "PV", "OP")} == {part: COLOURS[part] for part in ("SP", "PV", "OP")}
    assert figure.axes[1].get_xlabel() == "time [min]" and figure.axes[0].get_ylabel() == "PV"


def test_a_unit_that_is_known_is_told(lopsided):
    log = lopsided.log
    assert diagnose(lopsided).plot().axes[1].get_ylabel() == f"OP [{log.units[lopsided.op_name]}]"

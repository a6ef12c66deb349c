"""The log against the model before and after: replays of known effects, so that each number here is analytic."""

from dataclasses import replace

import numpy as np
import pytest
from stickslip.cases.models import ideal_flow
from stickslip.gap import GapError, replayed
from stickslip.gap.answers.report import Cause, GapReport, Shrinkage, Size, Where
from stickslip.gap.likelihood.swapping import Swap

from tests.gap.test_latent import moved, report_at

SHRINKS = Shrinkage(before=10.0, after=2.0, floor=1.0, fraction=0.87, low=0.84, high=0.9)


def blamed(effect, place, causes=True, **sizes) -> GapReport:
    """A report that blames an effect of known sizes, without a diagnosis."""
    parameters = {name: Size(value, value, value, "-") for name, value in sizes.items()}
    found = (Cause(effect, place, 1.0, (), parameters),) if causes else (Cause("unknown", place, 1.0),)
    return replace(report_at(ideal_flow(), place), causes=found, shrinkage=SHRINKS)


@pytest.fixture(scope="module")
def gained():
    return moved(ideal_flow(), "process_gain", "process", factor=1.5)


def test_with_the_cause_the_model_is_the_log(gained):
    # analytic: the log is that of the model with this effect; what is left is OP between two rows
    found = replayed(blamed("process_gain", "process", factor=1.5), gained)
    assert (found.signal, found.inputs) == ("PV", ("OP",))
    before, after = (np.sqrt(np.mean((y - found.logged) ** 2)) for y in (found.as_it_is, found.with_cause))
    assert after < 0.05 * before
    # analytic: two thirds of the gain give two thirds of PV at rest
    assert np.median(found.as_it_is / found.logged) == pytest.approx(1.0 / 1.5, rel=0.02)
    assert f"with process gain at process by {after:.2g}" in str(found)


def test_the_worst_stretch_is_drawn(gained):
    report = blamed("process_gain", "process", factor=1.5)
    late = np.where(gained.t > 2000.0, 5.0, 0.1)
    found = replayed(replace(report, t=gained.t, residuals={"PV": np.array([late, late])}), gained)
    assert found.t[0] > 1900.0 and len(found.t) == len(gained) // 4


def test_the_picture_shows_the_shrinkage_and_one_scale(gained):
    figure = replayed(blamed("process_gain", "process", factor=1.5), gained).plot()
    bar, before, after = figure.axes
    assert [patch.get_width() for patch in bar.patches] == pytest.approx([0.87, 0.13])
    assert bar.texts[0].get_text() == "The gap shrinks by 87 % (84 to 90 %)"
    assert [line.get_label() for line in before.lines] == ["PV as logged", "the model as it is"]
    assert [line.get_label() for line in after.lines] == ["PV as logged", "with process gain at process"]
    assert before.get_ylim() == after.get_ylim()


def test_a_cause_without_a_name_is_not_put_in(gained):
    found = replayed(blamed("process_gain", "process", causes=False), gained)
    assert found.with_cause is None and len(found.plot().axes) == 1
    assert str(found).startswith("The model as it is misses PV, driven by the logged OP, by ")


def test_without_a_place_there_is_nothing_to_draw(gained):
    with pytest.raises(GapError, match="there is no gap"):
        replayed(replace(report_at(ideal_flow(), "process"), where=None), gained)


def test_the_diagram_names_the_cause_in_its_block():
    report = replace(blamed("stiction", "valve", S=3.0, J=1.0), where=Where("valve", 1.0, ("valve",), {"valve": 1.0}))
    told = [text.get_text() for text in report.plot_diagram().axes[0].texts]
    assert told[told.index("valve") : told.index("valve") + 3] == ["valve", "ideal valve", "stiction"]


def test_what_is_said_follows_the_numbers():
    assert str(SHRINKS) == "on rows that the fit has not seen the gap shrinks by 87 % (84 to 90 %)"
    assert "too small beside the noise to tell" in str(replace(SHRINKS, low=0.0, high=0.9))
    swap = Swap(("OP",), "PV", before=0.94, after=6.5, noise=0.1)
    assert "rises from 0.94 to 6.5 (so it says nothing" in str(swap) and "falls from 0.94 to 0.5" in str(
        replace(swap, after=0.5)
    )

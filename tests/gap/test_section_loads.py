"""Loads at the feed of a separator section, which nobody measures, beside a feed that swings by itself."""

import pytest
from stickslip.gap import diagnose
from stickslip.gap.effects import effect

from benchmarks.gap.plant import MODELS, PlantRun


@pytest.mark.parametrize(
    ("name", "size"), [("step_disturbance", ("time", 1500.0)), ("sine_disturbance", ("period", 300.0))]
)
def test_a_load_at_the_feed_of_a_section_is_found_at_its_time_or_period(name, size):
    # the response to a pulse was that of runs far from their rest, in which no load could be recognised
    run = PlantRun("separator_section", name, "F_in", 70)
    (cause,) = diagnose(MODELS[run.model][0](), run.made(), catalogue=[effect(name)], limits=False).causes
    parameter, true = size  # of the benchmark's SIZES
    assert cause.effect == name and cause.parameters[parameter].value == pytest.approx(true, rel=0.03)

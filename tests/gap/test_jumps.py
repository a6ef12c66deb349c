"""A load explains a record without jumps far better than one with a stem: beside such a stem nothing is looked for."""

import pytest
from stickslip.cases.models import ideal_flow
from stickslip.gap.diagnosis import prepared
from stickslip.gap.effects import effect
from stickslip.gap.explanations.jumps import too_smooth
from stickslip.gap.explanations.pairs import paired
from stickslip.gap.explanations.stem_beside import stem_beside
from stickslip.gap.explanations.unmeasured import unmeasured_load
from stickslip.gap.fits.adequacy import needed
from stickslip.gap.fits.search import Candidate, best_of
from stickslip.logs import Log

from benchmarks.gap.generator import record


def problem_of(effects=(), outside=""):
    made = record("ideal", effects, "typical", 9650, hours=1.0, outside=outside)
    return prepared(ideal_flow(), Log(made.signals["time"], {s: made.signals[s] for s in ("SP", "PV", "OP")}))


def fitted(problem, name, place, **values):
    return best_of(Candidate(problem, problem.quiet, effect(name), place).tried([values]))


@pytest.mark.parametrize(("effects", "outside", "smooth"), [
    (("stiction",), "", False), (("stiction", "sine_disturbance"), "", False),
    (("deadband", "sensor_drift"), "", False),
    (("sine_disturbance",), "", True), ((), "wave_packet", True), ((), "chirping_load", True),
])  # fmt: skip
def test_what_moves_without_jumps_is_too_smooth_for_a_stem(effects, outside, smooth):
    problem = problem_of(effects, outside)
    load = unmeasured_load(problem, needed(problem))
    assert too_smooth(problem, fitted(problem, "stiction", "valve", S=3.0, J=1.2), load) is smooth


def test_without_a_load_to_compare_with_nothing_is_too_smooth():
    problem = problem_of(("sine_disturbance",))
    assert too_smooth(problem, fitted(problem, "stiction", "valve", S=3.0, J=1.2), None) is False


def test_beside_a_stem_that_a_smooth_record_cannot_have_nothing_is_looked_for(monkeypatch):
    problem = problem_of(outside="wave_packet")
    asked = []
    monkeypatch.setattr(
        "stickslip.gap.explanations.pairs.with_second", lambda *a: asked.append(a[1].effect.name) or iter(())
    )
    monkeypatch.setattr("stickslip.gap.explanations.pairs.firsts", lambda problem, fits: list(fits))
    monkeypatch.setattr("stickslip.gap.explanations.pairs.ENOUGH", -1e9)
    stem = fitted(problem, "stiction", "valve", S=3.0, J=1.2)
    paired(problem, [stem], [effect("stiction"), effect("valve_gain")], False, unmeasured_load(problem, 0.0))
    assert asked == []
    paired(problem, [stem], [effect("stiction"), effect("valve_gain")], False, None)
    assert asked == ["stiction"]


@pytest.mark.parametrize(("effects", "outside", "there"), [
    (("deadband", "second_lag"), "", True), ((), "inverse_response", False), ((), "asymmetric_lag", False),
])  # fmt: skip
def test_a_stem_beside_a_lag_shows_in_the_grid_of_its_sizes(effects, outside, there):
    problem = problem_of(effects, outside)
    lag = fitted(problem, "second_lag", "process", tau=2.0)
    assert (stem_beside(problem, lag, None, [effect("deadband")]) is not None) is there

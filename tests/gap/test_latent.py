"""The latent input is what was put in: sizes of loads and plays are known, so that each number here is analytic."""

import numpy as np
import pytest
from stickslip.blocks import Staircase
from stickslip.cases.models import ideal_flow, level_loop, site_flow
from stickslip.diagram import simulate
from stickslip.gap import GapError, diagnose, latent_input
from stickslip.gap.answers.report import GapReport, Where
from stickslip.gap.effects import effect
from stickslip.gap.reporting.latent import _deconvolved
from stickslip.logs import Log


def report_at(model, place, signals=()):
    """A report of a gap at a place, without a diagnosis."""
    residuals = {s: np.zeros((2, 1)) for s in signals}
    where = Where(place, 1.0, (place,), {place: 1.0})
    return GapReport(True, where, (), (), None, ("",), (), np.zeros(1), residuals, model)


def moved(model, name, place, seconds=3600.0, every=1.0, **values):
    with_effect = effect(name).insert(model, place, **values)
    log = simulate(with_effect, seconds, every=every, inputs=set_point(model)).log
    return Log(log.t, {s: log[s] for s in log.names if s in ("SP", "PV", "OP")})


def set_point(model, dwell=240.0):
    """Levels of the set point that the model's loop is excited by."""
    levels = (0.45, 0.55, 0.5) if model.name == "level_loop" else (1.2, 1.6, 1.4)
    (name,) = model.open_inputs
    return {name: Staircase(name, levels * 40, dwell=dwell)}


def test_a_step_of_the_load_comes_out_as_it_went_in():
    log = moved(ideal_flow(), "step_disturbance", "feed", amplitude=0.03, time=1800.0)
    found = latent_input(report_at(ideal_flow(), "feed"), log)
    assert (found.signal, found.shown) == ("OP", "PV")
    early, late = found.values[found.t < 1700.0], found.values[found.t > 1900.0]
    assert np.mean(early) == pytest.approx(0.0, abs=1e-3) and np.mean(late) == pytest.approx(0.03, abs=1e-3)
    assert max(found.shares, key=found.shares.get) == "time" and found.shares["time"] > 0.9
    assert "goes with time" in str(found)


def test_a_play_parts_rising_from_falling_by_its_width():
    log = moved(site_flow(), "deadband", "valve", seconds=7200.0, every=5.0, width=6.0)
    found = latent_input(report_at(site_flow(), "valve"), log)
    way = found.against["the direction of OP"]
    apart = np.mean(found.values[way < 0.0]) - np.mean(found.values[way > 0.0])
    assert 0.03 < apart < 0.06  # as wide as the play, less the rows while OP crosses it
    assert max(found.shares, key=found.shares.get) == "the direction of OP"


def test_a_gap_of_the_controller_is_told_in_units_of_its_measurement():
    log = moved(ideal_flow(), "controller_gain", "controller", factor=1.5)
    found = latent_input(report_at(ideal_flow(), "controller"), log)
    assert (found.signal, found.shown) == ("PV", "OP")


def test_an_integrating_level_gives_the_inflow_that_a_step_adds():
    def late(amplitude):
        log = moved(
            level_loop(), "step_disturbance", "feed", seconds=14400.0, every=5.0, amplitude=amplitude, time=7200.0
        )
        found = latent_input(report_at(level_loop(), "feed"), log)
        assert (found.signal, found.shown) == ("OP", "PV")
        return float(np.mean(found.values[found.t > 8000.0])), found

    # the load wanders, with the same random numbers in both runs: what the step adds is the difference
    stepped, found = late(0.05)
    assert stepped - late(0.0)[0] == pytest.approx(0.05, rel=0.02)
    assert max(found.shares, key=found.shares.get) == "time"


def test_it_is_refused_where_there_is_no_gap_or_nothing_drives_the_place():
    log = simulate(ideal_flow(), 900.0, every=1.0, inputs=set_point(ideal_flow())).log
    with pytest.raises(GapError, match="there is no gap"):
        latent_input(diagnose(ideal_flow(), log, limits=False), log)
    with pytest.raises(GapError, match="no logged signal drives the blocks feed"):
        latent_input(report_at(ideal_flow(), "feed"), log)  # which holds its signal, load, too
    whole = latent_input(report_at(ideal_flow(), "process"), Log(log.t, {"SP": log["SP"], "OP": log["OP"]}))
    assert (whole.signal, whole.shown) == ("SP", "OP")  # one segment, which only the set point drives


def test_an_output_that_does_not_answer_a_lasting_input_has_a_finite_latent_one():
    # before: nothing divided by nothing at frequency zero, and "if nan in the mean, ... is added to SP" in the report
    answer = np.zeros(50)
    answer[3], answer[4] = 1.0, -1.0  # a pulse comes and goes: the sum of the answer is 0
    y = np.convolve(np.sin(np.arange(50) / 5.0), answer)[:50]
    found = _deconvolved(y, answer, integral=False)
    assert np.isfinite(found).all() and np.allclose(np.convolve(found, answer)[10:40], y[10:40], atol=0.05)

"""Noise and loads that a model states wrongly, in records of another hand's heat exchanger (plain numpy).

The truth is known from outside: the records are made with other standard deviations than the data sheet's.
"""

import pytest
from stickslip.gap import GapReport, diagnose
from stickslip.gap.effects import effect
from stickslip.logs import Log

from benchmarks.foreign.record import record
from benchmarks.foreign_models.heat_exchanger import model

NAMES = ("controller_gain", "process_gain", "process_time_constant", "sensor_noise", "valve_gain", "dead_time")


def diagnosed(**made: object) -> GapReport:
    """Return the diagnosis of a record through the sheet's model."""
    found, wired = record("heat_exchanger", seed=315452270, **made), model()  # type: ignore[arg-type]
    signals = {signal: factor * found.signals[tag] for signal, (factor, tag) in wired.signals.items()}
    catalogue = [effect(name) for name in NAMES]
    return diagnose(wired.diagram, Log(found.signals["time"], signals), catalogue=catalogue, limits=False)


def test_a_noise_that_is_off_by_less_than_a_factor_of_two_is_a_note_and_no_gap() -> None:
    report = diagnosed(noise_factor=1.6, load_factor=1.9)
    assert not report.gap
    notes = " ".join(report.notes)
    assert "sensor.sd is stated as 0.08; the log says 0.1" in notes  # truth 0.128
    assert "feed.sd is stated as" in notes


def test_a_noise_that_is_stated_rightly_has_no_note() -> None:
    assert not any("is stated as" in note for note in diagnosed().notes)


@pytest.mark.parametrize("name", ["process_gain", "controller_gain"])
def test_an_effect_beside_a_load_and_a_noise_that_are_stated_wrongly_is_named(name: str) -> None:
    report = diagnosed(effect=name, noise_factor=0.6, load_factor=1.8)
    assert [(one.effect, one.place) for one in report.causes] == [(name, name.partition("_")[0])]


def test_a_noise_that_is_off_by_far_more_is_a_gap() -> None:
    report = diagnosed(noise_factor=4.0)
    assert [one.effect for one in report.causes] == ["sensor_noise"]
    assert report.causes[0].parameters["factor"].value == pytest.approx(4.0, rel=0.1)
    assert report.causes[0].parameters["factor"].low < 4.0 < report.causes[0].parameters["factor"].high

"""Mistakes of people who bring a model and a log, put into records of two plants of another hand (plain Python).

The heat exchanger's controller acts directly and in percent; a trial of the flow loop takes a third of the time.
"""

from functools import cache

import numpy as np
import pytest
from stickslip.cases.models import site_flow
from stickslip.gap import diagnose
from stickslip.gap.effects import effect
from stickslip.gap.hints.hinted import hints
from stickslip.gap.hints.mistakes import of_units
from stickslip.gap.records.model import read
from stickslip.logs import Log

from benchmarks.foreign.record import Record, record
from benchmarks.foreign_models.heat_exchanger import model
from tests.gap.outside_loops import site_log


@cache
def made() -> Record:
    """Return a record of the heat exchanger."""
    return record("heat_exchanger", seed=77)


def right() -> tuple[object, np.ndarray, dict[str, np.ndarray]]:
    """Return a right model, and times and signals of a log of its plant."""
    wired = model()
    return (
        wired.diagram,
        made().signals["time"],
        {s: by * made().signals[tag] for s, (by, tag) in wired.signals.items()},
    )


def hint(diagram, t, signals) -> str:
    opened, kept = read(diagram, Log(t, signals))
    return " ".join(hints(opened, kept.log))


def later(values: np.ndarray, rows: int) -> np.ndarray:
    return np.concatenate([np.full(rows, values[0]), values[:-rows]])


MISTAKES = {
    "PV and SP are logged as 1.8 times what the model has plus 32": lambda v: {
        s: 1.8 * v[s] + 32.0 for s in ("PV", "SP")
    },
    "PV is logged as 10 times what the model has": lambda v: {"PV": 10.0 * v["PV"]},
    "OP is logged as 0.01 times what the model has": lambda v: {"OP": 0.01 * v["OP"]},
    "OP is logged as 1 minus what the model has": lambda v: {"OP": 1.0 - v["OP"]},
    "the time stamps of PV are 10 s too late": lambda v: {"PV": later(v["PV"], 2)},
    "the time stamps of OP are 15 s too late": lambda v: {"OP": later(v["OP"], 3)},
    "the columns of PV and SP are exchanged": lambda v: {"PV": v["SP"], "SP": v["PV"]},
}  # fmt: skip


@pytest.mark.parametrize("words", MISTAKES)
def test_a_mistake_in_the_log_is_said(words: str) -> None:
    log = site_log(hours=0.5)
    signals = {s: log[s] for s in ("SP", "PV", "OP")}
    assert words in hint(site_flow(), log.t, {**signals, **MISTAKES[words](signals)})


def test_an_output_that_was_logged_as_a_closing_is_said() -> None:
    diagram, t, signals = right()
    assert "OP is logged as 100 minus what the model has" in hint(diagram, t, {**signals, "OP": 100.0 - signals["OP"]})


def test_a_controller_that_acts_the_other_way_is_said() -> None:
    diagram, t, signals = right()
    turned = diagram.with_params({"controller.action": -diagram["controller"].params["action"]})
    assert "controller acts the other way" in hint(turned, t, signals)


def test_the_integral_of_the_other_error_is_said() -> None:
    diagram, log = site_flow(), site_log("none", hours=0.5)  # the plain program sums the present error
    other = diagram.replace("controller", diagram["controller"].with_params(present=0.0))
    assert 'integral="present"' in hint(other, log.t, {s: log[s] for s in ("SP", "PV", "OP")})


def test_no_unit_is_doubted_of_a_loop_that_is_at_its_set_point() -> None:
    log = site_log(hours=0.5)
    words = [one.words for one in of_units(site_flow(), Log(log.t, {s: log[s] for s in ("SP", "PV", "OP")}))]
    assert any(said.startswith("PV and SP are logged as 10 times") for said in words)
    assert not any(said.startswith("PV is logged as 10 times") for said in words)


def test_a_right_model_has_no_hint() -> None:
    assert hint(*right()) == ""


@pytest.mark.parametrize("name", ["steam_sag", "slow_cooling", "wet_steam"])
def test_what_no_catalogue_has_is_no_mistake(name: str) -> None:
    diagram, t, signals = right()
    other = record("heat_exchanger", effect=name, seed=77)
    assert hint(diagram, t, {s: other.signals[s] for s in signals}) == ""


def test_the_report_has_the_hint() -> None:
    diagram, t, signals = right()
    log = Log(t, {**signals, "OP": later(signals["OP"], 3)})
    report = diagnose(diagram, log, catalogue=[effect("process_gain")], limits=False)
    assert [one.effect for one in report.causes] == ["unknown"]
    assert "30 s too late" in str(report)
    assert report.to_dict()["hints"] == list(report.hints)

"""The list of records of the gap's benchmark: enough of each kind, and none of the report used for tuning."""

from collections import Counter

import pytest
from stickslip.cases.models import ideal_flow
from stickslip.gap.effects import effect

from benchmarks.gap.plant import runs as plant_runs
from benchmarks.gap.runs import CLASSES, PLACES, alike, benchmark
from benchmarks.gap.severities import IDEAL
from benchmarks.resumed import in_turn


def test_places_are_those_of_the_catalogue():
    for name in IDEAL:
        assert effect(name).places(ideal_flow()) == (PLACES[name],)
    assert alike("valve_gain") == CLASSES[0] and alike("positioner_lag", mv=True) == ("positioner_lag",)
    assert alike("sensor_span", setting="cascade") == ("sensor_span",) and alike("sensor_bias", setting="level") == (
        "sensor_bias",
    )


@pytest.mark.parametrize("family", ["report", "report_2", "report_3", "report_4"])
def test_there_are_enough_of_each_kind(family):
    runs = benchmark(family)

    def count(setting, **what):
        return sum(run.setting == setting and all(getattr(run, k) == v for k, v in what.items()) for run in runs)

    assert count("ideal", effects=(), outside="") == 300
    assert sum(run.setting == "ideal" and run.outside != "" for run in runs) >= 150
    assert sum(len(run.effects) == 2 for run in runs) >= 60
    assert sum(run.setting == "site" and len(run.effects) == 1 for run in runs) >= 300
    assert count("site", effects=(), outside="") >= 100
    assert sum(run.setting == "site" and run.outside != "" for run in runs) >= 100


@pytest.mark.parametrize("runs", [benchmark("report_3"), tuple(plant_runs("report_3"))], ids=["loops", "plant"])
def test_every_beginning_holds_each_kind_by_its_share(runs):
    of, some = Counter(run.kind for run in runs), in_turn(runs)
    assert sorted(run.key for run in some) == sorted(run.key for run in runs)
    for end in range(1, len(some) + 1):
        for kind, count in Counter(run.kind for run in some[:end]).items():  # analytic: half a place off per kind
            assert abs(count - of[kind] * end / len(some)) <= 0.5 * len(of)


def test_nothing_of_the_report_is_used_for_tuning():
    tuning, report = benchmark("tuning"), benchmark("report")
    assert len({run.key for run in (*tuning, *report)}) == len(tuning) + len(report)
    later = [run.key for family in ("report_2", "report_3", "report_4") for run in benchmark(family)]
    assert len({*later, *(run.key for run in report)}) == len(later) + len(report)
    assert not {run.outside for run in tuning if run.outside} & {run.outside for run in report}
    pairs = [{run.effects for run in family if len(run.effects) == 2} for family in (tuning, report)]
    assert len(pairs[0]) == 20 and len(pairs[1]) == 110


def test_a_run_makes_the_same_record_each_time():
    run = next(run for run in benchmark("tuning") if run.effects == ("sensor_bias",))
    one, other = run.made(), run.made()
    assert (one.signals["PV"] == other.signals["PV"]).all() and run.places == ("sensor",)
    assert run.key == "tuning/ideal/sensor_bias/just_visible/0/no_mv"

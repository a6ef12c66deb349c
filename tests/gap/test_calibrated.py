"""Self-calibration: runs with known effects are diagnosed, counted, kept and gone on with."""

import json

import pytest
from stickslip.cases.models import ideal_flow
from stickslip.gap import calibrated, diagnose
from stickslip.gap.answers.evidence import Evidence
from stickslip.gap.answers.hit_rates import HitRates, counted
from stickslip.gap.calibrating.calibration import Calibration, folder
from stickslip.gap.effects import effect

FEW = [effect(name) for name in ("process_gain", "valve_gain", "sensor_bias")]


@pytest.fixture(scope="module")
def log(recorded):
    return recorded("valve_gain", "valve", seed=7, factor=0.93)


@pytest.fixture(scope="module")
def found(log):
    return calibrated(ideal_flow(), log, catalogue=FEW, runs=1, progress=False)


def test_effects_put_into_the_model_are_counted_as_named_up_to_their_class(found):
    assert set(found.confusion) == {"none", "process_gain", "sensor_bias", "valve_gain"}
    assert found.confusion["none"] == {"none": 5}
    assert found.confusion["process_gain"] == {"process_gain": 1}  # its class, named whole, holds it
    least, missed, what = found.limits["process_gain"]
    assert what == "factor [-]" and 0.0 < least < 3.0 and missed != missed
    assert "8 runs" in str(found) and json.dumps(found.to_dict(), allow_nan=False)


def test_a_stopped_calibration_goes_on(found, log):
    file = next(folder().glob("*.runs.jsonl"))
    lines = file.read_text().splitlines()
    assert len(lines) == len(found.rows) == 8
    kept = lines[:4]
    file.write_text("\n".join(kept) + '\n{"key": "torn')
    stopped = calibrated(ideal_flow(), log, catalogue=FEW, runs=1, seconds=0.0, progress=False)
    assert [row["key"] for row in stopped.rows] == [json.loads(line)["key"] for line in kept]
    file.write_text("\n".join(lines) + "\n")
    assert calibrated(ideal_flow(), log, catalogue=FEW, runs=1, seconds=0.0, progress=False) == found


def test_a_diagnosis_states_the_shares_that_were_counted(found, log):
    report = diagnose(ideal_flow(), log, catalogue=FEW, progress=False)
    assert report.causes[0].probability == pytest.approx(found.hit_rates.probability(report.evidence))
    assert any("8 runs of this model" in note for note in report.notes)


def test_no_number_of_runs_makes_a_probability_of_one():
    # analytic: a Beta prior of A runs leaves 1 - A (1 - p_0)/(n + A)
    clear = Evidence("pair", 1e4)
    sure = HitRates({"pair": (1000, 1000)}, 1000)
    assert 0.995 < sure.probability(clear) < 1.0
    assert HitRates({"pair": (5, 10)}, 10).probability(clear) < 0.8
    assert "not in runs of this model" in str(HitRates())


def test_rows_without_a_gap_are_not_counted_as_names():
    rows = [
        {"evidence": {"kind": "none", "gap": 1.0, "share": 0.0, "margin": 0.0}, "right": True},
        {"evidence": {"kind": "pair", "gap": 1.0, "share": 1.0, "margin": 9.0}, "right": False},
    ]
    assert counted(rows) == {"pair": (0, 1)}


@pytest.mark.parametrize(
    ("neutral", "right", "wrong", "least", "missed"),
    [
        (0.0, [-0.5, 0.2], [-0.1, 0.05], 0.2, -0.1),  # a bias, to either side
        (1.0, [0.5, 1.3], [0.9, 1.05], 1.3, 0.9),  # a factor: halved is as much as doubled
        (float("inf"), [0.1, 2.0], [5.0, 9.0], 2.0, 5.0),  # a rate: the less, the more it limits
    ],
)
def test_the_smallest_size_is_that_nearest_to_neutral(neutral, right, wrong, least, missed):
    rows = [
        {
            "effect": "e",
            "size": size,
            "neutral": neutral,
            "right": ok,
            "parameter": "p [-]",
            "named": "",
            "evidence": None,
        }
        for ok, sizes in ((True, right), (False, wrong))
        for size in sizes
    ]
    assert Calibration(tuple(rows)).limits == {"e": (least, missed, "p [-]")}

"""The figures of the gap benchmark from rows whose shares are known by hand."""

import pytest

from benchmarks.gap.oracle import relative, right
from benchmarks.gap.required import NOTES, figures
from benchmarks.gap.table import COLUMNS, write_table

CLEAR = {"kind": "white", "gap": 1e4}
ROW = {
    "setting": "ideal", "severity": "typical", "mv": False, "effects": ["dead_time"], "outside": "", "visible": 1.0,
    "gap": True, "names": ["dead_time"], "sets": [["dead_time"]], "places": ["process"], "probability": 0.5,
    "cause": True, "strict": True, "place": True, "top3": True, "error": 0.01, "shrinkage": 0.8, "oracle": 0.8,
    "unknown": False, "confident_wrong": False, "evidence": CLEAR, "seconds": 2.0, "first": False,
    "free_run_place": "controller",
}  # fmt: skip
WRONG = ROW | {"cause": False, "names": ["sensor_lag"]}
OUTSIDE = ROW | {"effects": [], "outside": "wavy_trim", "names": ["sensor_noise"], "confident_wrong": False}


def test_shares_and_their_counts():
    out, counts = figures([ROW, ROW, ROW, WRONG])
    assert out["cause_top1"] == 0.75 and counts["cause_top1"].startswith("3 of 4")
    assert out["shrinkage_median"] == 1.0  # 0.8 of a possible 0.8
    assert out["calibration_error"] == pytest.approx(0.25)  # stated 0.5, right 0.75
    # analytic: of 4 fair coins |k/4 - 1/2| is 1/2, 1/4, 0, 1/4, 1/2 with probability 1, 4, 6, 4, 1 of 16
    assert out["calibration_floor"] == pytest.approx((2 * 0.5 + 8 * 0.25) / 16)
    assert out["parameter_error"] == 0.01 and out["stiction_error"] is None and out["unknown_recall"] is None


def test_what_is_right_is_said_for_each_kind_of_run():
    assert right(ROW) and not right(WRONG) and not right(OUTSIDE)
    assert right(OUTSIDE | {"unknown": True}) and right(ROW | {"effects": [], "gap": False})
    assert right(ROW | {"effects": ["dead_time", "stiction"], "both": True})


def test_shrinkage_is_relative_to_the_true_effect():
    assert relative({"shrinkage": 0.45, "oracle": 0.9}) == 0.5
    assert relative({"shrinkage": None, "oracle": 0.9}) is None


def test_the_plant_has_figures_of_its_own():
    row = {"model": "full_plant", "effect": "valve_gain", "visible": 9.0, "place": True, "cause": True,
           "confident_wrong": False, "gap": True}  # fmt: skip
    none = {"model": "full_plant", "effect": "", "gap": False}
    out, counts = figures([ROW], [row, row | {"cause": False}, row | {"visible": 0.1}, none])
    assert (out["plant_place"], out["plant_cause"], out["plant_false_alarm"]) == (1.0, 0.5, 0.0)
    assert counts["plant_cause"].startswith("1 of 2") and out["section_cause"] is None


def test_all_three_baselines_stand_beside_the_figures():
    out, _ = figures([ROW | {"parameters_only": 0.2, "flexible_residual": 0.4}])
    assert (out["free_run_place"], out["parameters_only"], out["flexible_residual"]) == (0.0, 0.2, 0.4)
    assert {"free_run_place", "parameters_only", "flexible_residual"} <= set(NOTES)


def test_the_site_loop_is_told_by_severity_and_small_gaps_need_not_shrink():
    site = ROW | {"setting": "site"}
    small = site | {"evidence": CLEAR | {"gap": 0.1 * 2880}, "shrinkage": 0.1}  # analytic: 4 h, a row every 5 s
    gross = site | {"severity": "gross", "place": False}
    out, _ = figures([site, small, gross])
    assert (out["site_cause_typical"], out["site_place_gross"], out["site_cause_gross"]) == (1.0, 0.0, 1.0)
    assert out["site_shrinkage"] == 0.8 and out["site_unknown_gross"] is None
    outside = site | {"effects": [], "outside": "wavy_trim", "severity": "gross", "unknown": True}
    out, _ = figures([outside, outside | {"unknown": False}, outside | {"severity": "typical"}])
    assert (out["site_unknown_typical"], out["site_unknown_gross"]) == (1.0, 0.5)


def test_every_row_is_a_line_of_the_table(tmp_path):
    loop = ROW | {"key": "report/ideal/dead_time/typical/0/no_mv", "cpu": 1.234}
    plant = {"key": "report/full_plant/none/-/1000", "gap": False, "names": [], "places": [], "probability": None,
             "cause": False, "place": False, "cpu": 20.0}  # fmt: skip
    write_table([loop, plant], tmp_path / "rows.csv")
    first, *lines = (tmp_path / "rows.csv").read_text().splitlines()
    assert first == ",".join(COLUMNS)
    assert lines == [
        "report/full_plant/none/-/1000,0.0,False,,,,False,False,,,20.0",
        "report/ideal/dead_time/typical/0/no_mv,1.0,True,dead_time,process,0.5,True,True,,False,1.2",
    ]

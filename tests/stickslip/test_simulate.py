"""`stickslip simulate`: the log, the pictures, the numbers, and a run that stops early."""

import json
from dataclasses import replace

import pytest
from stickslip.engine.status import Status
from stickslip.logs import read_log

from stickslip import diagram


def test_log_and_pictures_are_written(call, tmp_path):
    names = ["log.csv", "log.parquet", "trend.png", "trend.svg", "diagram.pdf"]
    csv, parquet, png, svg, pdf = (tmp_path / name for name in names)
    assert call("simulate", "sine", "--out", csv, "--plot", png, "--diagram", pdf, "--json", "-").exit_code == 0
    assert call("simulate", "sine", "--out", parquet, "--plot", svg).exit_code == 0
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(names)
    for log in (read_log(csv), read_log(parquet)):
        assert len(log) == 6001 and log.names == ("e",)
        assert abs(log["e"]).max() == pytest.approx(0.075, abs=1e-6)  # analytic: the amplitude
    assert png.read_bytes()[:4] == b"\x89PNG" and pdf.read_bytes()[:4] == b"%PDF" and b"<svg" in svg.read_bytes()


def test_document(call):
    result = call("simulate", "ideal_high", "--json", "-")
    answer = json.loads(result.stdout, parse_constant=lambda word: pytest.fail(word))
    assert list(answer) == [
        "schema", "case", "title", "status", "hint", "notes", "duration_s", "rows", "mode_changes", "steps", "final",
        "numbers",
    ]  # fmt: skip
    assert answer["schema"] == "stickslip.simulate/1" and answer["status"] == "ok"
    assert (answer["duration_s"], answer["rows"], answer["numbers"]) == (600.0, 6001, [])
    assert set(answer["final"]) == {"SP", "OP", "MV", "PV"}
    assert "600 s simulated" in result.stderr


def test_numbers_stand_side_by_side(call):
    result = call("simulate", "sine", "--numbers", "--json", "-")
    (number,) = json.loads(result.stdout)["numbers"]
    assert number["published"] == 1.03  # published: figure 6.1(a)
    assert number["analytic"] == 1.0
    assert number["reproduced"] == pytest.approx(1.025, abs=1e-3)
    assert number["note"] in " ".join(result.stderr.split())


def test_settings_reach_the_diagram(call):
    as_is = json.loads(call("simulate", "ideal_high", "--json", "-").stdout)
    free = json.loads(call("simulate", "ideal_high", "--set", "valve.F_s=1250", "--json", "-").stdout)
    assert as_is["mode_changes"] > 10  # slips and sticks for 600 s
    assert free["final"]["PV"] == pytest.approx(0.5, abs=0.03)  # without a jump the loop settles inside the deadband


def test_duration_shorter_than_the_cases_log_interval(call):
    answer = json.loads(call("simulate", "sine", "--duration", "0.05", "--json", "-").stdout)
    assert (answer["duration_s"], answer["rows"]) == (0.05, 2)


def test_a_run_that_stops_early_is_not_done(call, monkeypatch, tmp_path):
    whole = diagram.simulate
    monkeypatch.setattr(diagram, "simulate", lambda *a, **k: whole(*a, **k, max_steps=20))
    target = tmp_path / "answer.json"
    result = call("simulate", "ideal_high", "--json", target)
    assert result.exit_code == 2
    assert "Error: the run stopped early" in result.stderr
    answer = json.loads(target.read_text(), parse_constant=lambda word: pytest.fail(word))
    assert answer["status"] != "ok" and answer["hint"]
    assert answer["final"]["PV"] is None


def test_list_names_every_case(call):
    from stickslip.cases import names

    result = call("simulate", "--list", "--json", "-")
    answer = json.loads(result.stdout)
    assert result.exit_code == 0 and answer["schema"] == "stickslip.cases/1"
    assert tuple(case["name"] for case in answer["cases"]) == names()
    assert all(name in result.stderr for name in names())


def test_help_and_the_empty_request_say_how_to_list(call):
    assert "simulate --list" in call("simulate", "--help").stdout
    empty = call("simulate")
    assert empty.exit_code == 2 and "stickslip simulate --list" in empty.stderr


def test_new_topologies_run_by_name(call, tmp_path):
    picture = tmp_path / "trends.png"
    assert call("simulate", "split_range", "--numbers", "--plot", picture).exit_code == 0
    assert picture.read_bytes()[:4] == b"\x89PNG"


def test_time_simulated_is_that_of_the_run_not_of_its_rows(call):
    answer = json.loads(call("simulate", "sine", "--duration", "10", "--every", "3", "--json", "-").stdout)
    assert (answer["duration_s"], answer["rows"]) == (10.0, 4)
    full = call(
        "simulate", "plant_1_none", "--set", "F_in.value=1e6", "--duration", "10", "--every", "0.1", "--json", "-"
    )
    assert full.exit_code == 2 and "S1 is full" in full.stderr
    answer = json.loads(full.stdout)
    assert answer["status"] == "model_ended" and 0.3 < answer["duration_s"] < 0.6 and answer["rows"] == 101


def test_ctrl_c_has_an_exit_code_of_its_own(call, monkeypatch):
    whole = diagram.simulate
    monkeypatch.setattr(diagram, "simulate", lambda *a, **k: replace(whole(*a, **k), status=Status.INTERRUPTED))
    result = call("simulate", "sine")
    assert result.exit_code == 130 and "stopped early" in result.stderr


def test_the_largest_step_is_kept_and_checked(call, tmp_path):
    log = tmp_path / "log.csv"
    done = call("simulate", "ideal_high", "--duration", "10", "--max-step", "0.01", "--out", log)
    steps = int((done.stdout + done.stderr).split(" steps")[0].split()[-1])
    assert done.exit_code == 0 and steps >= 1000  # analytic: 10 s in steps of 0.01 s at most
    refused = call("simulate", "ideal_high", "--max-step", "-1")
    assert refused.exit_code == 2 and "max_step = -1.0" in " ".join((refused.stdout + refused.stderr).split())

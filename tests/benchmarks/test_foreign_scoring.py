"""What an answer on a foreign plant is worth, by answers made by hand; rows are kept whole and never asked twice."""

import json
from argparse import Namespace

import pytest

from benchmarks.foreign import command, trial
from benchmarks.foreign.answer import Answer, Cause
from benchmarks.foreign.record import NAMES, UNSEEN, plant
from benchmarks.foreign.scoring import NOTES, figures, scored
from benchmarks.foreign.trial import Run, Wired, diagnosed, runs
from benchmarks.resumed import resumed


def said(effect: str, place: str, p: float = 0.9) -> Answer:
    return Answer(True, place, (Cause(effect, place, p),), (place,))


UNSURE = Answer(True, "valve", (), ("valve", "sensor"))


def row(group: str, effect: str, place: str, answer: Answer | None, crash: str = "") -> dict[str, object]:
    kept = {"plant": "cone", "group": group, "change": 1.0, "cpu": 2.0, "crash": crash, "noise_factor": 1.0,
            "load_factor": 1.0}  # fmt: skip
    return kept | scored(group, effect, place, answer, None)


def test_a_name_is_right_up_to_what_leaves_the_same_log():
    exact = scored("effect", "valve_gain", "valve", said("valve_gain", "valve"), None)
    alike = scored("effect", "valve_gain", "valve", said("process_gain", "process"), None)
    wrong = scored("effect", "valve_gain", "valve", said("dead_time", "process"), None)
    assert exact["right_cause"] and exact["right_cause_strict"] and exact["right_place_strict"]
    assert alike["right_cause"] and alike["right_place"] and not alike["right_cause_strict"]
    assert not wrong["right_cause"] and not wrong["right_place"] and wrong["confident_wrong"]
    assert not scored("effect", "valve_gain", "valve", said("dead_time", "process", 0.7), None)["confident_wrong"]


def test_where_two_loops_meet_only_what_the_plant_says_leaves_the_same_log():
    several = plant("two_by_two").alike
    assert not scored("effect", "valve_gain", "valve_1", said("process_gain", "process_11"), several)["right_cause"]
    inner = plant("cascade").alike
    assert scored("effect", "positioner_lag", "valve", said("second_lag", "pipe"), inner)["right_cause"]
    assert not scored("effect", "positioner_lag", "valve", said("sensor_lag", "flow_sensor"), inner)["right_cause"]


def test_a_right_name_at_another_block_is_wrong():
    other = scored("effect", "controller_gain", "controller_2", said("controller_gain", "controller_1"), {})
    assert not other["right_cause"] and not other["right_place"]


def test_figures_by_hand():
    rows = [
        row("effect", "deadband", "valve", said("deadband", "valve")),
        row("effect", "deadband", "valve", said("stiction", "valve", 0.6)),
        row("effect", "deadband", "valve", Answer(False)),
        row("effect", "deadband", "valve", None, crash="ValueError: x"),
        row("none", "none", "", Answer(False)),
        row("none", "none", "", said("sensor_noise", "sensor")),
        row("outside", "vortex", "process", Answer(True, "process", (), ("process",))),
        row("outside", "vortex", "process", UNSURE),
        row("outside", "vortex", "process", said("deadband", "valve", 0.95)),
        row("effect", "valve_saturation", "valve", Answer(False)) | {"change": 0.0},
    ]
    found, words = figures(rows)
    assert found["place"] == 0.5 and found["cause"] == 0.25 and found["missed"] == 0.5  # analytic, as all here
    assert found["false_alarms"] == 0.5 and found["unknown"] == pytest.approx(2 / 3)
    assert found["unknown_at_place"] == pytest.approx(1 / 3)
    assert found["confident_wrong"] == pytest.approx(2 / 9) and found["crashes"] == 1 and found["no_trace"] == 1
    assert words["cause"] == "1 of 4, 0.25 (0.06 to 0.64)"  # analytic: Wilson, z = 1.645, by hand
    assert set(found) == set(NOTES)


def test_enough_records_of_every_kind():
    all_ = runs()
    count = {group: sum(run.group == group for run in all_) for group in ("effect", "none", "outside")}
    assert count["effect"] >= 300 and count["none"] >= 150 and count["outside"] >= 100
    assert len({run.key for run in all_}) == len(all_) and {run.plant for run in all_} == {*NAMES, *UNSEEN}
    stated = [run.noise_factor == 1.0 and run.load_factor == 1.0 for run in all_]
    assert 0.45 < sum(stated) / len(all_) < 0.56
    assert all(0.5 <= run.noise_factor <= 2.0 and 0.5 <= run.load_factor <= 2.0 for run in all_)


def test_rows_hold_the_answer_a_crash_and_nothing_is_asked_twice(tmp_path, monkeypatch):
    asked: list[str] = []
    monkeypatch.setattr(trial, "wired", lambda name: lambda: Wired(None, {"OP": (0.01, "OP")}, {}))  # type: ignore[arg-type]

    def ask(model: Wired, log: object) -> Answer:
        asked.append(str(model.signals))
        if len(asked) == 2:
            raise RuntimeError("out of luck")
        return said("valve_leak", "valve")

    some = [Run("sqrt_tank", "effect", "valve_leak", seed, 1.0, 1.0, 1.0) for seed in (1, 2)]
    file = tmp_path / "foreign.jsonl"
    rows = list(resumed(some, lambda run: diagnosed(run, ask), file, 1e9))
    assert [bool(one["crash"]) for one in rows] == [False, True] and "out of luck" in rows[1]["crash"]
    assert rows[0]["right_cause"] and not rows[1]["right_cause"] and rows[0]["change"] > 1.0
    assert [json.loads(line)["key"] for line in file.read_text().splitlines()] == [run.key for run in some]
    again = list(resumed(some, lambda run: diagnosed(run, ask), file, 1e9))
    assert json.dumps(again) == json.dumps(rows) and len(asked) == 2
    assert [one.name for one in tmp_path.iterdir()] == ["foreign.jsonl"]


def _none_found(run: Run) -> dict[str, object]:
    made = {**vars(run), "key": run.key, "change": 1.0, "cpu": 1.0, "crash": ""}
    return made | scored(run.group, run.effect, "valve", Answer(False), None)


def test_the_unseen_plants_are_asked_with_the_others_or_alone_and_counted_apart(tmp_path, monkeypatch, capsys):
    for room in (trial, command):
        monkeypatch.setattr(room, "wired", lambda name: (lambda: None) if name in ("cone", "quench") else None)
    monkeypatch.setattr(command, "diagnosed", _none_found)

    def counted(only: str, place: str) -> float:
        options = Namespace(only=only, quick=True, part=(0, 0), folder=tmp_path / place, minutes=1.0, csv=None,
                         json=str(tmp_path / f"{place}.json"))  # fmt: skip
        assert command.foreign(options)
        return json.loads((tmp_path / f"{place}.json").read_text())["plants"]

    assert counted("foreign", "both") == 1
    both = capsys.readouterr().out
    assert "2 of 2 records" in both and "of the unseen plants:" in both and "belt_dryer, pipeline_pack" in both
    assert counted("foreign/unseen", "unseen") == 1
    alone = capsys.readouterr().out
    assert "1 of 1 records" in alone and "quench" in alone and "cone " not in alone


def test_the_command_prints_what_it_counted(tmp_path, monkeypatch, capsys):
    for room in (trial, command):
        monkeypatch.setattr(room, "wired", lambda name: (lambda: None) if name == "cone" else None)
    monkeypatch.setattr(command, "diagnosed", _none_found)
    given = Namespace(only="foreign", quick=True, part=(0, 0), folder=tmp_path, minutes=1.0, csv=tmp_path / "rows.csv",
                     json=str(tmp_path / "out.json"))  # fmt: skip
    assert command.foreign(given)
    out = capsys.readouterr().out
    assert "no model of " in out and "1 of 1 records" in out and "a quick run is too short" in out
    assert json.loads((tmp_path / "out.json").read_text())["plants"] == 1
    assert (tmp_path / "rows.csv").read_text().startswith("plant,")

"""`stickslip table`: what it prints, writes and refuses."""

import csv
import json

import pytest
from stickslip.detect import METHODS

SOME = ("--method", "area_ratio", "--method", "cross_correlation")


def test_one_file(call, exports, tmp_path):
    names = {option: tmp_path / f"table.{option}" for option in ("csv", "html", "json")}
    files = [word for option, path in names.items() for word in (f"--{option}", path)]
    done = call("table", exports / "FIC101_pi_export.csv", *SOME, *files, "--plot", tmp_path / "table.png")
    assert done.exit_code == 1  # the export's valve sticks
    assert (
        "FIC101: stiction" in done.stdout
        and "area_ratio" in done.stdout
        and "The verdict is the calibrated one" in done.stdout
    )
    rows = list(csv.DictReader(names["csv"].open(newline="")))
    assert [row["method"] for row in rows] == ["area_ratio", "cross_correlation"]
    page = names["html"].read_text()
    assert "class='badge bad'>STICTION<" in page
    assert "<svg" in page and rows[1]["verdict"] in page and "<script" not in page
    document = json.loads(names["json"].read_text())
    assert document["schema"] == "stickslip.table/1"
    assert [m["name"] for m in document["loops"][0]["methods"]] == ["area_ratio", "cross_correlation"]
    assert document["loops"][0]["methods"][0]["milliseconds"] > 0.0
    assert (tmp_path / "table.png").stat().st_size > 5000


def test_a_folder_lists_what_it_could_not_read(call, exports, tmp_path):
    (tmp_path / "good.csv").write_bytes((exports / "FIC101_pi_export.csv").read_bytes())
    (tmp_path / "bad.csv").write_text("nothing here")
    done = call("table", tmp_path, *SOME, "--json", "-")
    assert [entry["file"] for entry in json.loads(done.stdout)["skipped"]] == ["bad.csv"]
    assert "not read: bad.csv" in done.stderr


def test_a_case(call):
    done = call("table", "ideal_high", "--method", "stem_play", "--json", "-")
    (loop,) = json.loads(done.stdout)["loops"]
    assert (loop["loop"], loop["methods"][0]["verdict"]) == ("ideal_high", "stiction")


def test_a_case_is_simulated_as_long_as_asked(call):
    done = call("table", "ideal_high", "--duration", "200", "--method", "area_ratio", "--json", "-")
    assert json.loads(done.stdout)["loops"][0]["samples"] == 2001  # analytic: 200 s, a row every 0.1 s


def test_a_loop_of_a_plants_case(call):
    done = call("table", "plant_1_high", "--loop", "PCS11", "--loop", "LCS11", "--method", "stem_play", "--json", "-")
    loops = json.loads(done.stdout)["loops"]
    assert [loop["loop"] for loop in loops] == ["plant_1_high PCS11", "plant_1_high LCS11"]
    assert [loop["methods"][0]["verdict"] for loop in loops] == ["stiction", "stiction"]  # both valves stick


def test_all_loops_of_several_cases(call):
    done = call("table", "ideal_high", "split_range", *SOME, "--json", "-")
    names = [loop["loop"] for loop in json.loads(done.stdout)["loops"]]
    assert names[0] == "ideal_high" and len(names) >= 2 and all(name.startswith("split_range") for name in names[1:])


def test_a_folder_with_labels(call, exports, tmp_path):
    (tmp_path / "good.csv").write_bytes((exports / "FIC101_pi_export.csv").read_bytes())
    (tmp_path / "labels.txt").write_text("loop,label,tag\nFIC101,stiction,FIC101\n")
    done = call("table", tmp_path / "good.csv", "--labels", tmp_path / "labels.txt", *SOME, "--json", "-")
    area, *_, combined = json.loads(done.stdout)["scores"]
    assert (area["method"], area["found"], area["sticky"]) == ("area_ratio", 1, 1)
    assert combined["method"] == "combined" and "18 of 20 right (74% to 97%)" in " ".join(done.stderr.split())


def test_simulated_loops(call):
    done = call("table", "--simulated", "3", "--seed", "4", *SOME, "--json", "-")
    names = [loop["loop"] for loop in json.loads(done.stdout)["loops"]]
    assert [name.split(": ")[0] for name in names] == ["0", "1", "2"]
    assert {name.split(": ")[1] for name in names} & {"cycling", "excited"}


def test_the_kind_of_process_is_handed_on(call, tmp_path):
    rows = "\n".join(f"{t},{40 + t % 7},{50 + t % 5}" for t in range(100))
    (tmp_path / "x.csv").write_text(f"time,PV,OP\n{rows}\n")
    words = ("table", tmp_path / "x.csv", "--method", "area_ratio", "--json", "-")
    alone, stated = (json.loads(call(*words, *more).stdout) for more in ((), ("--process", "integrating")))
    assert stated["loops"][0]["methods"][0]["code"] == "wrong_process_type"
    assert alone["loops"][0]["methods"][0]["code"] != "wrong_process_type"


def test_cards(call, tmp_path):
    done = call("table", "--cards", "--csv", tmp_path / "cards.csv", "--json", tmp_path / "cards.json")
    assert done.exit_code == 0 and "cons:" in done.stdout
    assert "thesis table 2.1" in done.stdout and "Measured on" in done.stdout and "Ours:" in done.stdout
    rows = list(csv.DictReader((tmp_path / "cards.csv").open(newline="")))
    assert [row["method"] for row in rows] == [method.CARD.name for method in METHODS]
    assert json.loads((tmp_path / "cards.json").read_text())["methods"] == rows
    assert {"hit rate", "false alarms", "abstentions", "delay [periods]", "us a sample"} <= set(rows[0])


def test_cards_as_a_page(call, tmp_path):
    done = call("table", "--cards", "--html", tmp_path / "cards.html")
    page = (tmp_path / "cards.html").read_text()
    assert done.exit_code == 0 and page.count("<table>") == 4 and "Half period integral ratio" in page


@pytest.mark.parametrize(
    "words, piece",
    [
        ((), "name a file, a folder or a case"),
        (("nowhere.csv",), "'nowhere.csv' is no file, no folder and no case; the cases are ideal_high"),
        (
            ("ideal_high", "--method", "magic"),
            "there is no method 'magic'; did you mean 'harmonics'? known: area_ratio",
        ),
        (("ideal_high", "--loop", "LIC9"), "no loop 'LIC9'; known: ideal_high"),
        (("ideal_high", "--cards"), "--cards needs no SOURCE"),
        (("ideal_high", "--simulated", "2"), "--simulated draws its own loops"),
        (("--simulated", "2", "--process", "integrating"), "--simulated draws its own loops"),
        (("ideal_high", "--plot", "x.doc"), "'.doc' is not a format it can write"),
    ],
)
def test_mistakes_are_said(call, words, piece):
    done = call("table", *words)
    assert done.exit_code == 2 and piece in done.stderr

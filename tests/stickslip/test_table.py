"""`stickslip table`: what it prints, writes and refuses."""

import csv
import json

import pytest

from detect import METHODS

SOME = ("--method", "area_ratio", "--method", "cross_correlation")


def test_one_file(call, exports, tmp_path):
    names = {option: tmp_path / f"table.{option}" for option in ("csv", "html", "json")}
    files = [word for option, path in names.items() for word in (f"--{option}", path)]
    done = call("table", exports / "FIC101_pi_export.csv", *SOME, *files, "--plot", tmp_path / "table.png")
    assert done.exit_code == 1  # the export's valve sticks
    assert "FIC101: stiction" in done.stdout and "area_ratio *" in done.stdout and "* votes (1 of 2)" in done.stdout
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


def test_cards(call, tmp_path):
    done = call("table", "--cards", "--csv", tmp_path / "cards.csv", "--json", tmp_path / "cards.json")
    assert done.exit_code == 0 and "cons:" in done.stdout
    rows = list(csv.DictReader((tmp_path / "cards.csv").open(newline="")))
    assert [row["method"] for row in rows] == [method.CARD.name for method in METHODS]
    assert json.loads((tmp_path / "cards.json").read_text())["methods"] == rows


@pytest.mark.parametrize(
    "words, piece",
    [
        ((), "name a file, a folder or a case"),
        (("nowhere.csv",), "'nowhere.csv' is no file, no folder and no case; the cases are ideal_high"),
        (("ideal_high", "--method", "magic"), "there is no method 'magic'; known: area_ratio"),
        (("plant_1_high", "--method", "harmonics"), "logs no signals PV and OP"),
        (("ideal_high", "--cards"), "--cards needs no SOURCE"),
        (("ideal_high", "--plot", "x.doc"), "'.doc' is not a format it can write"),
    ],
)
def test_mistakes_are_said(call, words, piece):
    done = call("table", *words)
    assert done.exit_code == 2 and piece in done.stderr

"""`stickslip check` on several loops: of a plant's own export, of a historian's, of several files."""

import json

import pytest
from stickslip.detect.words import WORDS


@pytest.fixture(scope="module")
def plant_file(tmp_path_factory):
    from stickslip.diagram import simulate
    from stickslip.plant import kicked, production_plant

    plant = kicked(production_plant(F_s="high", sticky=["VPCS1"]), 1.02, 1.03)
    log = simulate(plant, 1200.0, every=2.0, method="stiff").log.between(200.0, 1200.0)
    file = tmp_path_factory.mktemp("plant") / "plant.csv"
    log.to_csv(file)
    return file


def test_the_plants_own_export(call, plant_file, tmp_path):
    done = call("check", plant_file, "--json", tmp_path / "all.json", "--html", tmp_path / "all.html")
    assert done.exit_code in (0, 1) and "8 loops, those to look at first on top" in done.stdout
    rows = [line for line in done.stdout.split("\n") if line.startswith("│ ") and line[2] != " "]
    assert rows[0].startswith("│ PCS11")  # the sticky one, of eight
    assert "Look at the valve of PCS11 first" in " ".join(done.stdout.split())
    document = json.loads((tmp_path / "all.json").read_text())
    (one,) = document["files"]
    assert {loop["loop"] for loop in one["loops"]} == {
        "LCS11", "PCS11", "LCS21", "PCS21", "ASC2", "ASC3", "SC001", "SC002",
    }  # fmt: skip
    assert one["survey"]["suspects"][0]["loop"] == "PCS11" and one["survey"]["groups"][0]["tags"]
    assert all(loop["schema"] == "stickslip.check/2" for loop in one["loops"])
    stuck = [loop for loop in one["loops"] if loop["verdict"] == "stiction"]
    assert done.exit_code == (1 if stuck else 0)
    page = (tmp_path / "all.html").read_text()
    assert page.count("<article") == 1 + 1 + 8 and "<script" not in page


def test_slips_that_another_tag_shows_stand_beside_an_open_verdict(call, hidden_valve, tmp_path):
    out = tmp_path / "unit.json"
    done = call("check", hidden_valve, "--json", out)
    (one,) = json.loads(out.read_text())["files"]
    own = {loop["loop"]: loop["verdict"] for loop in one["loops"]}
    assert own["LC1"] in ("inconclusive", "not_applicable")
    first = one["survey"]["suspects"][0]
    assert (
        first["loop"] == "LC1" and first["slips"]["tag"] == "f" and first["slips"]["S"] == pytest.approx(4.0, rel=0.05)
    )
    assert done.exit_code == 0 and "stiction" not in own.values()  # the verdicts are the loops' own, as everywhere
    rows = [line for line in done.stdout.split("\n") if line.startswith("│ LC")]
    assert rows[0].startswith("│ LC1") and WORDS[own["LC1"]].spoken.split()[0] in rows[0]
    assert "f jumps when OP has come back by" in done.stdout and "as where a valve slips" in done.stdout


def test_one_loop_of_it_is_told_in_full(call, plant_file):
    done = call("check", plant_file, "--loop", "PCS21", "--json", "-")
    assert json.loads(done.stdout)["loop"] == "PCS21"


def test_several_files(call, exports, tmp_path):
    first, second = exports / "FIC101_pi_export.csv", tmp_path / "other.csv"
    second.write_bytes(first.read_bytes())
    done = call("check", first, second, "--json", "-")
    files = json.loads(done.stdout)["files"]
    assert done.exit_code == 1 and [len(file["loops"]) for file in files] == [1, 1]
    assert [file["survey"] for file in files] == [None, None]
    alone = json.loads(call("check", first, "--json", "-").stdout)
    assert files[0]["loops"][0] == alone  # each loop as it is judged alone


def test_a_historians_export_of_two_loops(call, tmp_path):
    rows = "\n".join(f"{t},{40 + t % 7},{50 + t % 5},{30 + t % 3},{60 + t % 9}" for t in range(200))
    file = tmp_path / "unit.csv"
    file.write_text(f"time,FIC1.PV,FIC1.OP,LIC2.PV,LIC2.OP\n{rows}\n")
    done = call("check", file, "--json", "-")
    (one,) = json.loads(done.stdout)["files"]
    assert [loop["loop"] for loop in one["loops"]] == ["FIC1", "LIC2"] and one["survey"]["suspects"]


@pytest.mark.parametrize(
    "options, piece",
    [
        (["--pv", "x"], "--pv names what belongs to one loop, but 2 files are given; give one file"),
        (["--op-span", "0", "100"], "--op-span names what belongs to one loop"),
        (["--loop", "x"], "--loop names what belongs to one loop"),
        (["--json", "a.csv"], "a.csv would overwrite the file that is read"),
    ],
)
def test_mistakes_are_said(call, exports, tmp_path, monkeypatch, options, piece):
    monkeypatch.chdir(tmp_path)
    for name in ("a.csv", "b.csv"):
        (tmp_path / name).write_bytes((exports / "FIC101_pi_export.csv").read_bytes())
    done = call("check", "a.csv", "b.csv", *options)
    assert done.exit_code == 2 and piece in done.stderr


def test_one_unreadable_file_among_several(call, exports, tmp_path):
    (tmp_path / "bad.csv").write_text("nothing here")
    done = call("check", exports / "FIC101_pi_export.csv", tmp_path / "bad.csv", "--json", tmp_path / "all.json")
    assert done.exit_code == 2 and "bad.csv" in done.stderr and "FIC101" in done.stdout  # the other is judged
    document = json.loads((tmp_path / "all.json").read_text())
    assert [file["file"].rsplit("/")[-1] for file in document["files"]] == ["FIC101_pi_export.csv"]
    assert [file["file"].rsplit("/")[-1] for file in document["skipped"]] == ["bad.csv"]


def test_none_of_several_can_be_read(call, tmp_path):
    for name in ("a.csv", "b.csv"):
        (tmp_path / name).write_text("nothing here")
    done = call("check", tmp_path / "a.csv", tmp_path / "b.csv")
    assert done.exit_code == 2 and "a.csv: " in done.stderr and "b.csv: " in done.stderr and done.stdout == ""


def test_files_of_one_loop_each_are_ranked_by_their_answers(call, exports, tmp_path):
    still = tmp_path / "still.csv"
    still.write_text("time,PV,OP\n" + "".join(f"{i},4,50\n" for i in range(300)))
    done = call("check", still, exports / "FIC101_pi_export.csv")
    names = [line.split("│")[1].strip() for line in done.stdout.split("\n") if line.startswith("│")]
    assert done.exit_code == 1 and names[0].startswith("FIC101") and names[-1].startswith("still")


def test_a_loop_that_is_logged_in_part_is_judged_in_part(call, tmp_path):
    cells = [(f"{40 + t % 7},{50 + t % 5}", f"{30 + t % 3},{60 + t % 9}" if t < 150 else ",") for t in range(600)]
    file = tmp_path / "unit.csv"
    rows = "\n".join(f"{t},{','.join(both)}" for t, both in enumerate(cells))
    file.write_text(f"time,FIC1.PV,FIC1.OP,FIC2.PV,FIC2.OP\n{rows}\n")
    done = call("check", file, "--json", tmp_path / "all.json")
    said = " ".join(done.stdout.split())
    assert "hardly moves" not in said and "FIC2: it is logged in 25 % of the time, too little to ask" in said
    assert "Each verdict is that of --loop" in said and "no tag shows" not in said
    (one,) = json.loads((tmp_path / "all.json").read_text())["files"]
    alone = json.loads(call("check", file, "--loop", "FIC2", "--json", "-").stdout)
    assert {loop["loop"]: loop for loop in one["loops"]}["FIC2"]["verdict"] == alone["verdict"]
    assert any("judged is one piece of 150 samples" in said for said in alone["assumptions"])

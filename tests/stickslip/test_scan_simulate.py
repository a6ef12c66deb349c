"""``stickslip scan --simulate N``: simulation at a record's own conditions for the top of the list, kept on the way."""

import json

import pytest


@pytest.fixture
def plant(tmp_path):
    """Three loops, of which two can be judged."""
    from dataclasses import replace

    from stickslip.calibration import simulate
    from stickslip.calibration.drawing import one

    folder = tmp_path / "plant"
    folder.mkdir()
    specs = [replace(one("cycling", (21, k)), samples=400) for k in (5, 6)]
    for k, (record, _) in enumerate(simulate(specs)):
        record.log.to_parquet(folder / f"FIC{k}.parquet")
    (folder / "FIC9.csv").write_text("time,PV,OP\n" + "".join(f"{i},4,50\n" for i in range(300)))
    return folder


def test_the_first_are_simulated_and_kept(call, plant, tmp_path, monkeypatch):
    from stickslip import calibration

    whole = calibration.at_record
    asked = []

    def few(record, **more):
        asked.append(record.name)
        return whole(record, loops=100, workers=1)

    monkeypatch.setattr(calibration, "at_record", few)
    words = ("scan", plant, "--out", tmp_path / "out", "--workers", "1", "--json", "-", "--simulate")
    done = call(*words, "1")
    (one,) = json.loads(done.stdout)["simulations"]
    assert done.exit_code in (0, 1) and one["rank"] == 1 and len(asked) == 1
    assert 0.0 <= one["simulation"]["probability"] <= 1.0 and "detection_limit" in one["simulation"]
    assert "loops were simulated under the conditions of this record" in " ".join(done.stderr.split())
    page = tmp_path / "scan.html"
    again = json.loads(call(*words, "5", "--html", page).stdout)["simulations"]  # one is kept, one is at rest
    assert again[0] == one and len(again) == 2 and len(asked) == 2
    html = page.read_text(encoding="utf-8")
    assert "Simulated under their own conditions" in html
    for each in again:
        assert each["loop"] in html and each["sentences"][-1] in html


def test_a_damaged_note_is_made_again(tmp_path):
    from stickslip.commands.scan_beside import _kept

    file = tmp_path / "simulated.json"
    for content in ("{", "[]", '{"of": "other", "loops": {"1": {}}}'):
        file.write_text(content)
        assert _kept(file, "mine") == {}

"""What the fit says beside ``check`` and ``scan``: the remedy in place of a general rule, and what the stick costs."""

import json


def test_a_scan_ranks_what_stick_costs(call, plant, tmp_path):
    words = ("scan", plant, "--out", tmp_path / "out", "--workers", "1", "--json", "-", "--cost", "5")
    content = json.loads(call(*words).stdout)
    found, sticky_loops = content["costs"], {x["loop"] for x in content["loops"] if x["verdict"] == "stiction"}
    assert {one["loop"] for one in found} == sticky_loops
    assert any("FIC1" in one["loop"] and one["cost"]["pv_sd_ratio"]["value"] > 1.1 for one in found)
    assert (tmp_path / "out" / "costs.json").exists()


def test_check_says_what_the_fit_says_to_do(call, plant):
    result = call("check", plant / "FIC1.csv", "--remedy", "--json", "-")
    document = json.loads(result.stdout)
    assert result.exit_code == 1, document["reason"]
    assert set(document["remedy"]) == {"until_shutdown", "at_shutdown", "cost", "words"}
    assert any("Until the shutdown" in sentence for sentence in document["remedy"]["words"])
    assert "remedy" not in json.loads(call("check", plant / "FIC1.csv", "--json", "-").stdout)

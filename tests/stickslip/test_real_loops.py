"""`stickslip check` on every real file: it runs, gives a reason, and is never wrong."""

import csv
import json


def test_every_file(call, real_data):
    with open(real_data / "loops.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) >= 30
    for row in rows:
        process = ["--process", "integrating"] if row["integrating"] == "true" else []
        result = call("check", real_data / row["file"], *process, "--no-simulate", "--json", "-")
        assert result.exit_code in (0, 1), row["loop"]
        answer = json.loads(result.stdout)
        assert answer["schema"] == "stickslip.check/2"
        assert (answer["verdict"] == "stiction") == (result.exit_code == 1)
        assert len(answer["reason"]) > 40, row["loop"]
        wrong = "no_stiction" if row["label"] == "stiction" else "stiction"
        assert answer["verdict"] != wrong, row["loop"]
        for method in answer["methods"]:
            assert method["reason"] and (method["index"] is not None or method["verdict"] != "stiction")

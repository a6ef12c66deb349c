"""One valve, many records: weak traces add up, one odd day does not convict, and the order does not matter."""

from pathlib import Path

import numpy as np
import pytest
from stickslip.detect.judge.answer import Answer
from stickslip.detect.tag import judge_tag
from stickslip.logs import LoopRecord
from stickslip.logs.tags import valve_in

from .likelihood.loops import run

WEAK = {"S": 2.0, "noise": 0.16, "n": 700}


def record(name="", **how):
    op, pv = run(**how)
    return LoopRecord.from_arrays(np.arange(float(len(op))), pv=pv, op=op, op_span=(0, 100), name=name)


def said(word, p):
    return Answer(word, p, {"stiction": p, "healthy": 1.0 - p}, None, None, None, "Seen so.", "")


OPEN, STICKY, SOUND = said("inconclusive", 0.3), said("stiction", 0.99), said("no_stiction", 0.005)


def test_weak_days_that_the_model_leaves_open_are_found_together():
    days = [record(seed=seed, **WEAK) for seed in range(8)]
    found = judge_tag("FIC1", days, [OPEN] * 8)
    assert found.verdict == "stiction" and found.answer.S is not None
    assert found.answer.S.value == pytest.approx(2.0, rel=0.25) and found.answer.S.unit == "% of OP"
    assert "8 records of one valve, by themselves 8 inconclusive" in found.answer.reason
    assert found.answer.probability > OPEN.probability and len(found.rows) == 8
    content = found.to_dict()
    assert content["agreeing"] >= 5 and len(content["records"]) == 8 and all("S" in day for day in content["records"])
    assert [len(axes.get_title(loc="left")) > 0 for axes in found.plot().axes] == [True] * 3


def test_one_odd_day_convicts_nobody():
    days = [record(seed=3, **{**WEAK, "noise": 0.05})]
    days += [record(seed=seed, **{**WEAK, "S": 0.0}) for seed in range(10, 14)]
    found = judge_tag("FIC1", days, [STICKY, OPEN, OPEN, OPEN, OPEN])
    assert found.verdict == "inconclusive"
    assert judge_tag("FIC1", days[::-1], [OPEN, OPEN, OPEN, OPEN, STICKY]).verdict == "inconclusive"


def test_a_valve_with_one_sticky_record_is_not_cleared():
    days = [record(seed=seed, moves=3.0) for seed in range(3)]
    assert judge_tag("FIC1", days, [SOUND] * 3).verdict == "no_stiction"
    assert judge_tag("FIC1", days, [SOUND, SOUND, STICKY]).verdict == "inconclusive"


def test_the_same_record_counts_once():
    day = record(seed=1, **WEAK)
    once, twice = judge_tag("FIC1", [day], [OPEN]), judge_tag("FIC1", [day, day], [OPEN, OPEN])
    assert twice.counted == (0,) and twice.evidence.gain == pytest.approx(once.evidence.gain)


def test_a_record_by_itself_keeps_its_answer():
    alone = said("inconclusive", 0.97)  # its record settles nothing, however probable
    found = judge_tag("FIC1", [record(seed=1, S=0.0, noise=0.05)], [alone])
    assert found.answer is alone
    days = [record(seed=seed, S=0.0, noise=0.05) for seed in (1, 2)]
    assert judge_tag("FIC1", days, [alone, alone]).verdict == "inconclusive"  # nor do two of them


def test_no_records():
    with pytest.raises(ValueError, match="records of FIC1 is empty"):
        judge_tag("FIC1", [])


def test_names_of_records_of_one_valve():
    assert {valve_in(f"LIC31102B_202408{day}_2155") for day in (23, 24, 25)} == {"LIC31102B"}
    assert valve_in("CHEM1") == "CHEM1" and valve_in("PAP2") == "PAP2"  # numbers of tags stay


def test_check_gives_the_days_of_a_real_valve_one_verdict(tmp_path):
    import json
    import os

    from click.testing import CliRunner

    from stickslip.commands.cli import cli

    data = Path(os.environ.get("STICKSLIP_DATA", Path(__file__).parents[3] / "shared" / "data")) / "refinery"
    if not data.exists():
        pytest.skip(f"real loops not found at {data}; set STICKSLIP_DATA")
    files = [str(file) for file in sorted(data.glob("FIC46005*.csv"))]
    done = CliRunner().invoke(cli, ["check", *files, "--json", "-", "--html", str(tmp_path / "a.html")])
    assert done.exit_code == 1
    (tag,) = json.loads(done.stdout)["tags"]
    assert tag["tag"] == "FIC46005" and tag["verdict"] == "stiction" and tag["agreeing"] == 3
    assert 20.0 < tag["gain_nats"] < 21.0  # snapshot; no day alone reaches 10
    assert max(day["gain_nats"] for day in tag["records"]) < 10.0
    assert "FIC46005: 3 records" in (tmp_path / "a.html").read_text()

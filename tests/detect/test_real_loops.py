"""Real loops. Labels are checked once, never tuned on: the only claim is that no verdict is the wrong way round."""

import csv
import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from stickslip.detect import diagnose
from stickslip.logs import LoopRecord

DATA = Path(os.environ.get("STICKSLIP_DATA", Path(__file__).parents[3] / "shared" / "data"))
LIST = DATA / "loops.csv"
pytestmark = pytest.mark.skipif(not LIST.exists(), reason=f"real loops not found at {DATA}; set STICKSLIP_DATA")
ROWS = list(csv.DictReader(LIST.open(encoding="utf-8"))) if LIST.exists() else []
STANDARDISED = ("CHEM10", "CHEM12", "CHEM13")  # their OP has no known span


def read(row):
    table = np.genfromtxt(DATA / row["file"], delimiter=",", names=True)
    record = LoopRecord.from_arrays(
        table["time"],
        pv=table["PV"],
        op=table["OP"],
        sp=table["SP"] if "SP" in table.dtype.names else None,
        name=row["loop"],
        op_span=None if row["loop"] in STANDARDISED else (0, 100),
        process="integrating" if row["integrating"] == "true" else "unknown",
    )
    return replace(record, measurement=row["measurement"])


@pytest.mark.parametrize("row", ROWS, ids=[row["loop"] for row in ROWS])
def test_never_the_wrong_way_round(row):
    answer = diagnose(read(row))
    wrong = "no_stiction" if row["label"] == "stiction" else "stiction"
    assert answer.verdict != wrong
    if row["integrating"] == "true":
        assert answer.methods[0].code == "wrong_process_type"


def test_clear_loops_are_decided():
    said = {row["loop"]: diagnose(read(row)) for row in ROWS if row["loop"] in ("CHEM10", "PAP2", "CHEM13", "PAP9")}
    words = {"CHEM10": "stiction", "PAP2": "stiction", "CHEM13": "inconclusive", "PAP9": "inconclusive"}
    assert {loop: answer.verdict for loop, answer in said.items()} == words  # snapshot

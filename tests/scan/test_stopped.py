"""Ctrl-C ends a scan with one sentence, and the same command goes on to the same bytes."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from stickslip.cases.stories import EXPORTS
from stickslip.scan import scan

pytestmark = pytest.mark.skipif(not hasattr(os, "killpg"), reason="no process groups on this system")


def test_ctrl_c_and_on(tmp_path):
    plant = tmp_path / "plant"
    plant.mkdir()
    quick, slow = ((EXPORTS / name).read_bytes() for name in ("FIC512_compressed.csv", "FIC101_pi_export.csv"))
    for i in range(16):  # two jobs of eight files; the first is done long before the other
        (plant / f"FIC{100 + i}.csv").write_bytes(quick if i < 8 else slow)
    scan(plant, tmp_path / "whole", workers=1)  # first, so that no process below has to compile
    words = [sys.executable, "-m", "stickslip", "scan", str(plant), "--out", str(tmp_path / "cut"), "--workers", "2"]
    begun = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True)
    parts = tmp_path / "cut" / "parts"
    deadline = time.monotonic() + 200.0
    while time.monotonic() < deadline and begun.poll() is None and not list(parts.glob("0*.parquet")):
        time.sleep(0.02)
    os.killpg(begun.pid, signal.SIGINT)  # what a terminal does at Ctrl-C: every process of the command has it
    _, said = begun.communicate(timeout=100)
    assert begun.returncode == 130, said
    assert "Traceback" not in said and "the same command goes on" in " ".join(said.split()), said
    assert list(parts.glob("0*.parquet")) and not (tmp_path / "cut" / "scan.parquet").exists()
    scan(plant, tmp_path / "cut", workers=1)
    cut, whole = (Path(tmp_path, out, "scan.parquet").read_bytes() for out in ("cut", "whole"))
    assert cut == whole

"""A file of half a million rows is judged within ten seconds of one processor and half a gigabyte."""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("resource", reason="what a process has used is told on Unix")

ROWS = 500_000
SECONDS, MEGABYTES = 10.0, 500.0  # required, without loops simulated like the record: they cost the same for any
PROGRAM = r"""
import json, pathlib, re, resource, sys
from stickslip.commands.cli import cli

try:
    cli.main(["check", sys.argv[1], "--no-simulate", "--json", sys.argv[2]], standalone_mode=False)
except SystemExit as end:
    code = end.code
used = resource.getrusage(resource.RUSAGE_SELF)
status = pathlib.Path("/proc/self/status")  # ru_maxrss would count the process before this one, too
peak = float(re.search(r"VmHWM:\s+(\d+)", status.read_text())[1]) if status.exists() else used.ru_maxrss
peak /= 1024.0 if sys.platform != "darwin" else 1024.0**2
print(json.dumps({"code": code, "seconds": used.ru_utime + used.ru_stime, "megabytes": peak}))
"""


def test_half_a_million_rows(tmp_path):
    from datetime import datetime

    import polars as pl

    t, draw = np.arange(ROWS), np.random.default_rng(1)
    clock = pl.datetime_range(datetime(2024, 5, 6), datetime(2024, 6, 1), "1s", eager=True).head(ROWS)
    pl.DataFrame({
        "time": clock, "FIC1.SP": np.full(ROWS, 50.0),
        "FIC1.PV": 50 + 5 * np.sin(2 * np.pi * t / 120) + draw.normal(0, 0.2, ROWS),
        "FIC1.OP": 45 + 8 * np.sign(np.sin(2 * np.pi * t / 120 + 1)) + draw.normal(0, 0.1, ROWS),
    }).write_csv(tmp_path / "long.csv", float_precision=3, datetime_format="%Y-%m-%d %H:%M:%S")  # fmt: skip
    root = Path(__file__).parents[2]
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM, str(tmp_path / "long.csv"), str(tmp_path / "found.json")],
        capture_output=True, text=True, timeout=300, cwd=root, check=False,
        env={**os.environ, "PYTHONPATH": str(root), "OPENBLAS_NUM_THREADS": "1"},
    )  # fmt: skip
    used = json.loads(done.stdout.splitlines()[-1])
    assert used["code"] in (0, 1), done.stderr
    # analytic: the period that the record was made with
    assert json.loads((tmp_path / "found.json").read_text())["period_s"] == pytest.approx(120.0, rel=0.02)
    assert used["seconds"] <= SECONDS and used["megabytes"] <= MEGABYTES, used

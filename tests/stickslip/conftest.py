"""A user at the shell: in-process for speed, as a process of its own where that matters."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from stickslip.commands.cli import cli

ROOT = Path(__file__).resolve().parents[2]
GOOD = "time,SP,PV,OP\n" + "".join(f"{i},5,{4 + 0.1 * (i % 7):.1f},{50 + i % 5}\n" for i in range(100))


@pytest.fixture
def call():
    """Run a command line in this process; a crash is a failure of the test, not an exit code."""

    def run(*arguments):
        return CliRunner().invoke(cli, [str(a) for a in arguments], catch_exceptions=False)

    return run


@pytest.fixture
def shell():
    """Run `python -m stickslip` as a process."""

    def run(*arguments, cwd=None, environment=None, command=(sys.executable, "-m", "stickslip")):
        env = dict(os.environ, PYTHONPATH=str(ROOT), **(environment or {}))
        words = [*command, *map(str, arguments)]
        return subprocess.run(words, capture_output=True, timeout=120, env=env, cwd=cwd, check=False)

    return run


@pytest.fixture
def good(tmp_path):
    """A readable file with too coarse a PV to judge."""
    path = tmp_path / "good.csv"
    path.write_text(GOOD)
    return path


@pytest.fixture
def plant(tmp_path):
    """A folder with a sticky loop, FIC1, and a sound one, FIC2."""
    from stickslip.remedy.example import sticky

    folder = tmp_path / "plant"
    folder.mkdir()
    for name, S, J in (("FIC1", 5.0, 1.5), ("FIC2", 0.0, 0.0)):
        record = sticky(hours=2.0, S=S, J=J)
        columns = np.column_stack([record.t, record.sp, record.op, record.pv])
        head = f"time,{name}.SP,{name}.OP,{name}.PV"
        np.savetxt(folder / f"{name}.csv", columns, fmt="%.6f", delimiter=",", header=head, comments="")
    return folder


@pytest.fixture
def exports():
    return ROOT / "cases" / "exports"


@pytest.fixture(scope="session")
def real_data():
    """The folder of real loops; skips loudly where there is none."""
    folder = Path(os.environ.get("STICKSLIP_DATA") or ROOT.parent / "shared" / "data")
    if not (folder / "loops.csv").is_file():
        pytest.skip(f"real loops not found at {folder}: NOT TESTED; set STICKSLIP_DATA")
    return folder

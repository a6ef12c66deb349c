"""An installation that cannot be written keeps its compiled code elsewhere, whichever room compiles first."""

import os
import shutil
import stat
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from stickslip.logs.compiled import own_folder

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def sealed(tmp_path_factory):
    """An installation where nothing can be written but a folder for temporary files, and how to run Python there."""
    home = tmp_path_factory.mktemp("sealed")
    for package in sorted(path.parent for path in ROOT.glob("*/__init__.py")):
        if package.name in ("tests", "benchmarks"):
            continue
        shutil.copytree(package, home / package.name, ignore=shutil.ignore_patterns("__pycache__"))
        for folder in (home / package.name, *(p for p in (home / package.name).rglob("*") if p.is_dir())):
            (folder / "__pycache__").touch()  # a file in its place: no user, not even root, can write there
    (home / "tmp").mkdir()
    environment = {k: v for k, v in os.environ.items() if not k.startswith(("NUMBA", "XDG"))} | {
        "PYTHONPATH": str(home), "HOME": "/dev/null", "TMPDIR": str(home / "tmp"), "MPLCONFIGDIR": str(home / "tmp"),
    }  # fmt: skip

    def run(*arguments):
        command = [sys.executable, *map(str, arguments)]
        return subprocess.run(command, capture_output=True, text=True, env=environment, cwd=home)

    return home, run


def kept_in(home):
    """Return the folders among the temporary files that hold compiled code."""
    kept = {home / "tmp" / path.relative_to(home / "tmp").parts[0] for path in (home / "tmp").rglob("*.nbc")}
    assert kept
    return kept


def test_the_engine_finds_a_place(sealed):
    home, run = sealed
    code = (
        "from stickslip import plant;"
        "from stickslip.blocks import FirstOrder; from stickslip.engine.call import address;"
        "address(FirstOrder(1.0, 1.0).kernels.out)"
    )
    done = run("-c", code)
    assert done.returncode == 0, done.stderr
    for own in kept_in(home):
        assert own.name.startswith("stickslip") and stat.S_IMODE(own.stat().st_mode) == 0o700


def test_a_command_that_detects_finds_a_place(sealed, tmp_path):
    home, run = sealed
    record = tmp_path / "test.csv"
    op = 50.0 + np.repeat(np.cumsum([0, 1, 1, -1, -1, 2, 2, -2, -2, 5, 5, -5, -5]), 60)
    t = np.arange(len(op))
    moved = op + 0.02 * np.sin(0.7 * t)
    rows = [f"{t[i]},{op[i]},{moved[max(i - 3, 0)]},{moved[i]}" for i in range(len(t))]
    record.write_text("\n".join(["time,OP,PV,MV", *rows]))
    done = run("-m", "stickslip", "valve", record)
    assert done.returncode in (0, 1) and "Traceback" not in done.stderr, done.stderr
    assert "locator" not in done.stderr and done.stdout
    assert kept_in(home)


def test_every_module_finds_a_place(sealed):
    """Numba refuses a kernel without a place as its module is loaded, so loading shows it without compiling."""
    home, run = sealed
    files = [file.relative_to(home).with_suffix("") for file in home.rglob("*.py") if file.stem != "__main__"]
    names = [
        ".".join(file.parts).removesuffix(".__init__") for file in files if file.parts[0] not in ("docs", "stickslip")
    ]
    code = f"import importlib\nfor name in {sorted(names)}: importlib.import_module('stickslip.' + name)"
    done = run("-c", code)
    assert done.returncode == 0, done.stderr
    assert len(names) > 500


@pytest.mark.skipif(not hasattr(os, "getuid"), reason="no user ids on this system")
def test_a_folder_that_others_can_write_is_not_trusted(tmp_path):
    first = own_folder(tmp_path)
    assert own_folder(tmp_path) == first
    first.chmod(0o777)
    other = own_folder(tmp_path)
    assert other != first and stat.S_IMODE(other.stat().st_mode) == 0o700
    shutil.rmtree(first)
    (tmp_path / "elsewhere").mkdir()
    first.symlink_to(tmp_path / "elsewhere")
    assert own_folder(tmp_path) != first

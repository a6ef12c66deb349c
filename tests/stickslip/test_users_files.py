"""No file or folder of the user's own is taken for one of ours, or for one that we need."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
ROOMS = ["blocks", "cases", "detect", "diagram", "engine", "gap", "logs", "plant", "scan", "study"]
OURS = [f"{room}.py" for room in ROOMS] + [f"{room}/__init__.py" for room in ROOMS]
OTHERS = ["control.py", "numpy/__init__.py", "click.py", "filelock.py"]
PYTHONS = ["typing.py", "random.py", "json.py", "pathlib/__init__.py"]


@pytest.fixture
def folder(tmp_path):
    """A folder with files of all these names; each of them leaves a mark as it is executed."""
    for name in [*OURS, *OTHERS, *PYTHONS]:
        file = tmp_path / name
        file.parent.mkdir(exist_ok=True)
        file.write_text("import os\nopen('executed', 'a').write(__file__)\nraise RuntimeError('not ours')\n")
    return tmp_path


def test_a_loop_is_judged_beside_them(shell, folder, exports):
    done = shell("check", exports / "FIC101_pi_export.csv", "--json", "-", cwd=folder)
    assert done.returncode == 1, done.stderr
    assert json.loads(done.stdout)["verdict"] == "stiction"
    assert not (folder / "executed").exists()


def test_the_processes_of_a_scan_do_not_import_them_either(shell, folder, exports):
    done = shell("scan", exports, "--workers", "2", "--out", "kept", cwd=folder)
    assert done.returncode == 1, done.stderr
    assert not (folder / "executed").exists()


def test_a_plain_folder_of_that_name_is_read(shell, tmp_path, exports):
    (tmp_path / "logs").mkdir()
    (tmp_path / "logs" / "FIC1.csv").write_bytes((exports / "FIC101_pi_export.csv").read_bytes())
    assert shell("check", "logs/FIC1.csv", cwd=tmp_path).returncode == 1


@pytest.mark.parametrize("folder", [".", "models"])
def test_a_model_may_import_what_lies_beside_it(shell, tmp_path, folder):
    (tmp_path / folder).mkdir(exist_ok=True)
    (tmp_path / folder / "gains.py").write_text("K = 3.0\n")
    (tmp_path / folder / "model.py").write_text(
        "import stickslip as ss\nfrom gains import K\n\n\ndef loop():\n"
        "    process = ss.blocks.FirstOrder(K, 10.0, inputs='OP')\n"
        "    return ss.wire([ss.blocks.Step('SP'), ss.blocks.PI(0.4, 10.0), process])\n"
    )
    done = shell("simulate", f"{folder}/model.py:loop", "--duration", "20", cwd=tmp_path)
    assert done.returncode == 0, done.stderr


def test_python_imports_ours_beside_a_users_folders(tmp_path):
    for name in ("logs/__init__.py", "engine.py", "plant.py", "blocks/__init__.py"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text("raise RuntimeError('not ours')\n")
    code = f"import sys; sys.path.append({str(ROOT)!r}); import stickslip as ss; print(ss.blocks.PI, ss.plant.SETS)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=tmp_path)
    assert done.returncode == 0 and "PI" in done.stdout, done.stderr

"""Importing the package loads numpy and nothing heavy; nothing of the house is imported at all."""

import ast
import subprocess
import sys
from pathlib import Path

PACKAGE = Path(__file__).resolve().parents[2] / "logs"


def test_import_is_light():
    code = (
        "import sys; import logs; "
        "print([m for m in ('polars', 'matplotlib', 'scipy', 'control', 'numba', 'pandas') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=PACKAGE.parent, capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_nothing_of_the_house_is_imported():
    house = {"blocks", "cases", "control", "detect", "diagram", "engine", "numba", "plant", "stickslip", "study"}
    files = sorted(set(PACKAGE.rglob("*.py")) - {PACKAGE / "compiled.py"})  # numba's njit, for the other rooms
    assert len(files) > 10
    for file in files:
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom):
                assert (node.module or "").split(".")[0] not in house, file
            elif isinstance(node, ast.Import):
                assert not {name.name.split(".")[0] for name in node.names} & house, file

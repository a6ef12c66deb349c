"""Importing the package loads numpy and nothing heavy; nothing of the house is imported at all."""

import ast
import subprocess
import sys
from pathlib import Path

PACKAGE = Path(__file__).resolve().parents[2] / "logs"


def test_import_is_light():
    code = (
        "import sys; import stickslip.logs; "
        "print([m for m in ('polars', 'matplotlib', 'scipy', 'control', 'numba', 'pandas') if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=PACKAGE.parent, capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_nothing_of_the_house_is_imported():
    others = {"control", "numba"}
    files = sorted(set(PACKAGE.rglob("*.py")) - {PACKAGE / "compiled.py"})  # numba's njit, for the other rooms
    assert len(files) > 10
    for file in files:
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom):
                names = (
                    [node.module or ""] if node.module != "stickslip" else [f"stickslip.{a.name}" for a in node.names]
                )
            elif isinstance(node, ast.Import):
                names = [alias.name for alias in node.names]
            else:
                continue
            for name in names:
                first, _, rest = name.partition(".")
                assert first not in others and (first != "stickslip" or rest.split(".")[0] == "logs"), (file, name)

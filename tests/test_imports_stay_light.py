"""Detectors run on site data with no simulator loaded, and help is quick because imports are lazy."""

import subprocess
import sys

import pytest


def loaded_by(statement: str) -> set[str]:
    code = f"{statement}\nimport sys\nprint(' '.join(sys.modules))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return {name.split(".")[0] for name in done.stdout.split()}


@pytest.mark.parametrize("package", ["logs", "detect"])
def test_site_packages_load_no_simulator(package: str) -> None:
    heavy = {"control", "numba", "blocks", "diagram", "plant", "engine", "matplotlib", "polars", "scipy", "filterpy"}
    assert not loaded_by(f"import {package}") & heavy


def test_command_line_loads_nothing_heavy() -> None:
    heavy = {"control", "numba", "numpy", "matplotlib", "polars", "scipy", "rich"}
    assert not loaded_by("import stickslip.cli") & heavy

"""Detectors run on site data with no simulator loaded, and help is quick because imports are lazy."""

import subprocess
import sys

import pytest


def loaded_by(statement: str) -> set[str]:
    code = f"{statement}\nimport sys\nprint(' '.join(sys.modules))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return set(done.stdout.split())


@pytest.mark.parametrize("package", ["logs", "detect"])
def test_site_packages_load_no_simulator(package: str) -> None:
    heavy = {"control", "numba", "matplotlib", "polars", "scipy", "filterpy"}
    heavy |= {f"stickslip.{room}" for room in ("blocks", "diagram", "plant", "engine")}
    loaded = loaded_by(f"import stickslip.{package}")
    assert f"stickslip.{package}" in loaded and not loaded & heavy


def test_the_front_door_loads_nothing_before_it_is_asked() -> None:
    assert {name for name in loaded_by("import stickslip") if "stickslip" in name} == {"stickslip"}
    loaded = loaded_by("import stickslip as ss; ss.read_loop")
    assert "stickslip.logs" in loaded and "stickslip.blocks" not in loaded


def test_a_fit_loads_no_simulator_and_its_refusals_not_even_the_fit() -> None:
    loaded = loaded_by("from stickslip.remedy import fit")
    assert "stickslip.remedy.search" in loaded and not loaded & {"control", "stickslip.blocks", "stickslip.diagram"}
    loaded = loaded_by("from stickslip.remedy import FitError")
    assert "stickslip.remedy.refusal" in loaded and not loaded & {"numpy", "numba", "stickslip.remedy.search"}


def test_command_line_loads_nothing_heavy() -> None:
    heavy = {"control", "numba", "numpy", "matplotlib", "polars", "scipy", "rich"}
    assert not loaded_by("import stickslip.commands.cli") & heavy


def loaded_when_compiled(code: str) -> set[str]:
    loaded_by(code)  # the first may have to compile
    return loaded_by(code)


def test_a_simulation_that_is_compiled_already_does_not_wake_the_compiler() -> None:
    loaded = loaded_when_compiled("""
from stickslip.diagram import simulate
from stickslip.plant.loops import self_regulating_loop
simulate(self_regulating_loop(), 10.0)
""")
    assert not loaded & {"numba.np.linalg", "numba.np.arraymath", "polars"}


def test_a_verdict_by_methods_that_are_compiled_already_does_not_wake_the_compiler() -> None:
    loaded = loaded_when_compiled("""
from stickslip.cases.stories import EXPORTS
from stickslip.detect import diagnose
from stickslip.logs import read_loop
diagnose(read_loop(EXPORTS / "FIC101_pi_export.csv"))
""")
    assert not loaded & {"numba.cpython.printimpl", "numba.np.arraymath", "scipy.linalg"}

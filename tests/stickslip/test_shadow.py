"""A file of the user's that hides a package is named, not run."""

from pathlib import Path

import pytest


@pytest.mark.parametrize(
    "name", ["plant.py", "logs/__init__.py", "gap.py", "control.py", "numpy/__init__.py", "click.py"]
)
def test_a_users_file_is_named(shell, tmp_path, name):
    file = tmp_path / name
    file.parent.mkdir(exist_ok=True)
    file.write_text("raise RuntimeError('not ours')\n")
    done = shell("simulate", "sine", cwd=tmp_path)
    message = done.stderr.decode()
    assert done.returncode == 2 and done.stdout == b""
    assert message.startswith("Error: ") and "Traceback" not in message
    assert str(tmp_path / name.removesuffix("/__init__.py")) in message
    assert f"'{name.split('/')[0].removesuffix('.py')}'" in message and "rename" in message


def test_every_package_of_the_wheel_is_looked_for():
    import tomllib

    from stickslip.shadow import PACKAGES

    table = tomllib.loads((Path(__file__).parents[2] / "pyproject.toml").read_text())
    assert {*PACKAGES, "stickslip"} == set(table["tool"]["hatch"]["build"]["targets"]["wheel"]["packages"])


def test_a_plain_folder_of_that_name_is_no_trouble(shell, tmp_path):
    (tmp_path / "logs").mkdir()
    (tmp_path / "logs" / "FIC1.csv").write_text("time,PV,OP\n0,1,2\n")
    assert shell("check", "logs/FIC1.csv", cwd=tmp_path).returncode == 0


@pytest.mark.parametrize("name", ["filelock.py", "random.py", "json.py", "pathlib/__init__.py"])
def test_a_file_that_hides_what_python_needs_is_named_too(shell, tmp_path, name):
    file = tmp_path / name
    file.parent.mkdir(exist_ok=True)
    file.write_text("x = 1\n")
    done = shell("study", "ideal_high", "--duration", "10", "--vary", "valve.F_s=1750,2250", cwd=tmp_path)
    message = done.stderr.decode()
    assert done.returncode == 2 and done.stdout == b"", message
    assert message.startswith("Error: ") and "Traceback" not in message
    assert str(tmp_path / name.removesuffix("/__init__.py")) in message and "rename" in message


def test_a_name_of_pythons_own_that_nobody_needs_is_no_trouble(shell, tmp_path):
    (tmp_path / "turtle.py").write_text("raise RuntimeError('not ours')\n")
    assert shell("blocks", "Shaft", cwd=tmp_path).returncode == 0

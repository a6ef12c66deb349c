"""The group of commands: help that teaches, nearest names, exit codes that mean what they say."""

import sys
import tomllib
from pathlib import Path

import pytest

import stickslip
from stickslip.cli import COMMANDS

ROOT = Path(__file__).resolve().parents[2]


def test_help_teaches(call):
    result = call("--help")
    assert result.exit_code == 0
    for word in (
        "stickslip demo",
        "stickslip check my_loop.csv",
        "stickslip simulate ideal_high",
        "Exit codes: 0 done",
    ):
        assert word in result.stdout
    assert all(name in result.stdout for name in COMMANDS)
    assert "--pv" in result.stdout and "--process integrating" in result.stdout


@pytest.mark.parametrize("command", list(COMMANDS))
def test_every_command_shows_examples_and_exit_codes(call, command):
    result = call(command, "--help")
    assert result.exit_code == 0
    assert f"stickslip {command}" in result.stdout
    assert "Examples:" in result.stdout and "Exit codes:" in result.stdout


def test_version_is_the_one_of_the_package(call):
    result = call("--version")
    assert result.exit_code == 0
    assert stickslip.__version__ in result.stdout
    assert stickslip.__version__ == tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["version"]


def test_installed_command(shell, exports, tmp_path):
    script = Path(sys.executable).with_name("stickslip")
    if not script.exists():
        pytest.skip(f"{script} is not there: the installed command is NOT TESTED; pip install -e .")
    (tmp_path / "plant.py").write_text("raise RuntimeError('not ours')\n")  # an installed command looks elsewhere
    done = shell("check", exports / "FIC101_pi_export.csv", cwd=tmp_path, command=(script,))
    assert done.returncode == 1
    assert done.stdout.decode().startswith("FIC101: STICTION\n")


def test_a_terminal_without_our_signs_still_gets_the_answer(shell):
    done = shell("simulate", "sine", "--numbers", environment={"PYTHONIOENCODING": "ascii"})
    assert done.returncode == 0
    assert b"1.03 (figure 6.1(a))" in done.stdout

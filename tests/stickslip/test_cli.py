"""The group of commands: help that teaches, nearest names, exit codes that mean what they say."""

import ast
import re
import sys
import tomllib
from pathlib import Path

import pytest
from stickslip.engine.status import HINTS

import stickslip
from stickslip.commands.cli import COMMANDS, cli

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


@pytest.mark.parametrize("command", list(COMMANDS))
def test_every_option_is_explained_by_a_sentence_and_names_its_unit(command):
    for option in cli.get_command(None, command).params:
        if option.param_type_name != "option":
            continue
        help_ = option.help or ""
        assert help_[:1].isupper() and help_.endswith("."), option.opts
        if option.type.name.split()[0] in (
            "float",
            "integer",
        ):  # FLOAT or INTEGER RANGE says nothing of seconds or hours
            assert option.metavar, option.opts
        if isinstance(option.default, int | float | Path) and not option.is_flag:
            assert option.show_default, option.opts


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


def options(command):
    return {
        option
        for parameter in cli.get_command(None, command).params
        for option in (*parameter.opts, *parameter.secondary_opts)
    }


def texts(source):
    """Return every string that a source file holds, the pieces of f-strings joined."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.JoinedStr):
            yield "".join(str(part.value) for part in node.values if isinstance(part, ast.Constant))
        elif isinstance(node, ast.Constant) and isinstance(node.value, str):
            yield node.value


def test_messages_name_options_that_there_are():
    known = set().union(*map(options, COMMANDS)) | {"--help", "--version"}
    others = {"--markdown"} | {"--json", "--quick", "--write"}  # of `stickslip blocks`, and of benchmarks
    for room in ("blocks", "cases", "detect", "diagram", "engine", "logs", "plant", "stickslip", "study"):
        for path in (ROOT / room).rglob("*.py"):
            for text in texts(path.read_text()):
                named = set(
                    re.findall(r"(?<![\w(-])--[a-z][a-z-]+(?![\w:-])", text)
                )  # not those of the page's style sheet
                assert named <= known | others, (path.name, named - known - others)


@pytest.mark.parametrize("command", ["simulate", "study"])
def test_what_a_failed_run_advises_can_be_done_here(command):
    """The hints of the engine end on the terminal of these commands."""
    for hint in HINTS.values():
        assert set(re.findall(r"--[a-z-]+", hint)) <= options(command)
        bare = re.sub(r"in Python raise max_steps", "", hint)
        for word in re.findall(r"rtol|method=|max_steps|atol", bare):  # a keyword of Python alone helps nobody here
            assert word not in ("max_steps", "atol") and f"--{word.rstrip('=')}" in hint


def test_advice_that_says_how_to_integrate_works(call):
    import json

    plain, stiff, loose = (
        json.loads(call("simulate", "ideal_high", *more, "--json", "-").stdout)
        for more in ((), ("--method", "stiff"), ("--rtol", "1e-3"))
    )
    assert stiff["final"]["PV"] == pytest.approx(plain["final"]["PV"], abs=1e-4)
    assert loose["steps"] < plain["steps"] != stiff["steps"]
    assert call("simulate", "ideal_high", "--rtol", "7").exit_code == 2
    assert call("simulate", "ideal_high", "--method", "euler").exit_code == 2


def test_the_methods_named_here_are_the_engines():
    from stickslip.engine.run import METHODS as OF_ENGINE

    from stickslip.commands.simulate import METHODS

    assert set(METHODS) == set(OF_ENGINE)


def test_help_promises_published_numbers_only_where_they_are_shown(call):
    promised = "published beside reproduced"
    assert promised not in call("simulate", "sine").stdout
    lines = [line for line in call("--help").stdout.splitlines() if promised in line or "published numbers" in line]
    assert lines and all("--numbers" in line or "reproduce" in line for line in lines)

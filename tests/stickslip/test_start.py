"""`start.py` without installing anything: what it would do, and what it must never clear."""

import importlib.util
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def start(monkeypatch, tmp_path):
    """The script with its environment in a temporary folder, and everything it would run written down."""
    monkeypatch.setenv("STICKSLIP_VENV", str(tmp_path / "venv"))
    spec = importlib.util.spec_from_file_location("start", ROOT / "start.py")
    script = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(script)
    script.ran = []

    def create(home, with_pip, clear):
        script.ran.append(("create", clear))
        script.BIN.mkdir(parents=True, exist_ok=True)
        (script.BIN / "python").write_text("")
        (script.BIN / "python").chmod(0o755)

    def run(words, **options):
        script.ran.append(tuple(words[1:]))
        return subprocess.CompletedProcess(words, 0)

    monkeypatch.setattr(script.venv, "create", create)
    monkeypatch.setattr(script.subprocess, "run", run)
    monkeypatch.setattr(sys, "argv", ["start.py", "check", "loop.csv"])
    return script


def test_sets_up_once_and_passes_the_command_on(start):
    assert start.main() == 0
    assert start.ran[0] == ("create", True)
    assert start.ran[1][-1] == str(ROOT) and "-e" in start.ran[1]
    assert start.ran[2] == ("-m", "stickslip", "check", "loop.csv")
    assert start.main() == 0
    assert start.ran[3:] == [("-m", "stickslip", "check", "loop.csv")]


def test_no_argument_is_the_demonstration(start, monkeypatch):
    monkeypatch.setattr(sys, "argv", ["start.py"])
    assert start.main() == 0
    assert start.ran[-1] == ("-m", "stickslip", "demo")


def test_the_first_check_that_fails_is_told_and_nothing_is_tested(start, monkeypatch, capfd):
    monkeypatch.setattr(sys, "argv", ["start.py", "test"])
    start.main()
    monkeypatch.setattr(start, "CHECKS", [["a", "1"], ["b", "2"], ["c", "3"]])
    fails = {"1": 0, "2": 4, "3": 5}
    monkeypatch.setattr(
        start.subprocess, "run", lambda words, **_: subprocess.CompletedProcess(words, fails[words[1]], "said\n")
    )
    assert start.main() == 4  # with the tests, of which nothing is said here, it would be a KeyError
    assert capfd.readouterr().out.endswith("+ a 1\nsaid\n+ b 2\nsaid\n")


@pytest.mark.parametrize(("code", "again"), [(0, False), (1, True), (5, False)])
def test_what_fails_runs_once_more_and_says_why_in_full(start, monkeypatch, code, again):
    ran = []

    def run(words, **options):
        ran.append(words[1:])
        return subprocess.CompletedProcess(words, code)

    monkeypatch.setattr(start.subprocess, "run", run)
    assert start.tested() == code
    assert ran == [start.TESTS[1:], *([start.FAILED[1:]] if again else [])]


def test_tests_need_more_and_serve_the_commands_too(start, monkeypatch):
    start.main()
    monkeypatch.setattr(sys, "argv", ["start.py", "test"])
    assert start.main() == 0
    assert start.ran[3] == ("create", False)  # kept, and more installed into it
    assert start.ran[4][-1] == f"{ROOT}[test]"
    assert sorted(start.ran[5:-1]) == sorted(tuple(step[1:]) for step in start.CHECKS)
    assert start.ran[-1] == tuple(start.TESTS[1:])
    monkeypatch.setattr(sys, "argv", ["start.py", "demo"])
    before = len(start.ran)
    start.main()
    assert start.ran[before:] == [("-m", "stickslip", "demo")]


def test_the_site_needs_its_own_tools_and_serves_the_commands_too(start, monkeypatch):
    monkeypatch.setattr(sys, "argv", ["start.py", "docs", "--quick"])
    assert start.main() == 0
    assert start.ran[1][-1] == f"{ROOT}[docs]"
    assert start.ran[2:] == [("docs/build.py", "--quick")]
    monkeypatch.setattr(sys, "argv", ["start.py", "demo"])
    assert start.main() == 0
    assert start.ran[3:] == [("-m", "stickslip", "demo")]


def test_a_folder_of_the_users_is_never_cleared(start, tmp_path, capsys):
    start.HOME.mkdir()
    (start.HOME / "thesis.tex").write_text("years of work")
    assert start.main() == 2
    assert "was not made by this script" in capsys.readouterr().err
    assert start.ran == [] and (start.HOME / "thesis.tex").exists()


def test_an_interrupted_set_up_is_done_again(start, monkeypatch):
    def fail(words, **options):
        raise subprocess.CalledProcessError(1, words)

    with monkeypatch.context() as patch:
        patch.setattr(start.subprocess, "run", fail)
        assert start.main() == 2
    assert start.main() == 0
    assert start.ran[-1] == ("-m", "stickslip", "check", "loop.csv")


def test_an_environment_whose_python_is_gone_is_made_again(start):
    start.main()
    (start.BIN / "python").unlink()
    start.main()
    assert [step for step in start.ran if step[0] == "create"] == [("create", True), ("create", True)]


def test_no_venv_module_says_what_to_install(start, monkeypatch, capsys):
    def fail(*_, **__):
        raise subprocess.CalledProcessError(1, "ensurepip")

    monkeypatch.setattr(start.venv, "create", fail)
    assert start.main() == 2
    assert "python3-venv" in capsys.readouterr().err


def test_the_rooms_are_linked_to_where_mypy_looks_for_them(start, monkeypatch, tmp_path):
    monkeypatch.setattr(start, "ROOT", tmp_path)
    (tmp_path / "pyproject.toml").write_text((ROOT / "pyproject.toml").read_text())
    for room in ("blocks", "logs"):
        (tmp_path / room).mkdir()
        (tmp_path / room / "__init__.py").write_text("")
    start.linked()
    start.linked()  # what is there already is left
    assert (tmp_path / "build" / "typed" / "stickslip" / "logs" / "__init__.py").samefile(
        tmp_path / "logs" / "__init__.py"
    )

"""What every command shares, without any command."""

import os
import re
import subprocess
import sys
from pathlib import Path

import click
import pytest
from click.testing import CliRunner

from stickslip.commands.console import LONGEST_MESSAGE, Speaker, json_option, user_errors

ROOT = Path(__file__).resolve().parents[2]


def command_that_raises(error):
    @click.command()
    @user_errors
    def command():
        raise error

    return CliRunner().invoke(command, [])


@pytest.mark.parametrize(
    ("error", "code", "words"),
    [
        (ValueError("value, rule, remedy"), 2, "Error: value, rule, remedy"),
        (FileNotFoundError(2, "No such file or directory", "x.csv"), 2, "Error: x.csv: No such file or directory"),
        (MemoryError("4 TiB"), 2, "not enough memory (4 TiB)"),
        (KeyError("SP"), 2, "defect of stickslip, not of your input"),  # Python's own code, 1, means stiction
        (KeyboardInterrupt(), 130, "stopped by the keyboard"),
        (click.UsageError("no such thing"), 2, "Error: no such thing"),
    ],
    ids=lambda value: type(value).__name__,
)
def test_errors_become_one_message_and_never_exit_code_1(error, code, words):
    result = command_that_raises(error)
    assert result.exit_code == code
    assert words in result.stderr and "Traceback" not in result.stderr


def test_exit_codes_pass_through():
    assert command_that_raises(SystemExit(1)).exit_code == 1


def test_a_defect_says_where():
    assert "test_console.py, line" in command_that_raises(KeyError("SP")).stderr


def test_a_huge_message_is_cut_in_the_middle():
    result = command_that_raises(ValueError("a" * 10**6 + " remedy"))
    assert len(result.stderr) < LONGEST_MESSAGE + 20
    assert result.stderr.endswith(" remedy\n")


def test_tables_do_not_read_markup():
    @click.command()
    @json_option
    def command(json_file):
        Speaker(json_file).table(["quantity"], [["period [s]"], ["[/b] :smile:"]])

    out = CliRunner().invoke(command, [], catch_exceptions=False).stdout
    assert "period [s]" in out and "[/b] :smile:" in out


def test_paragraphs_wrap_at_words():
    @click.command()
    def command():
        Speaker(None).paragraph("word " * 60, "  - ")

    lines = CliRunner().invoke(command, []).stdout.splitlines()
    assert len(lines) > 2 and max(map(len, lines)) <= 100
    assert lines[0].startswith("  - word") and lines[1].startswith("    word")


def first_line_of(*arguments):
    """Exit code, first line and complaints when the reader closes the pipe after one line."""
    command = [sys.executable, "-m", "stickslip", *map(str, arguments)]
    env = dict(os.environ, PYTHONPATH=str(ROOT), PYTHONUNBUFFERED="1")
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=env) as process:
        line = process.stdout.readline()
        process.stdout.close()
        complaints = process.stderr.read().decode()
        return process.wait(timeout=120), line.decode().rstrip(), complaints


@pytest.mark.parametrize(
    ("export", "code", "line"),
    [
        ("FIC101_pi_export.csv", 1, "FIC101: STICTION"),
        ("PIC305_long_form.csv", 0, "PIC305: NO STICTION"),
    ],
)
def test_a_closed_pipe_leaves_the_exit_code_to_the_verdict(exports, tmp_path, export, code, line):
    page = tmp_path / "report.html"
    assert first_line_of("check", exports / export, "--html", page) == (code, line, "")
    assert page.is_file(), "what was asked for is written all the same"


def test_a_closed_pipe_is_no_fault_of_a_table():
    code, line, complaints = first_line_of("blocks")
    assert (code, complaints) == (0, "") and line


def seen_on_a_terminal(path, **environment):
    """What a command prints where standard output is a terminal."""
    pty = pytest.importorskip("pty", reason="NO TERMINAL TESTED: this system has no pseudo-terminals")
    leader, follower = pty.openpty()
    env = {key: value for key, value in os.environ.items() if key not in ("NO_COLOR", "TERM")}
    env |= {"PYTHONPATH": str(ROOT), "TERM": "xterm"} | environment
    command = [sys.executable, "-m", "stickslip", "check", str(path)]
    process = subprocess.Popen(command, stdout=follower, stderr=follower, env=env)
    os.close(follower)
    seen = b""
    while True:
        try:
            part = os.read(leader, 4096)
        except OSError:  # how Linux says that the other end is closed
            break
        if not part:
            break
        seen += part
    os.close(leader)
    process.wait(timeout=120)
    return seen


COLOUR = re.compile(rb"\x1b\[[\d;]*m")


@pytest.mark.parametrize("name", ["constant.csv", "absent.csv"])
def test_no_color_is_obeyed_on_a_terminal(tmp_path, name):
    file = tmp_path / name
    if name == "constant.csv":  # a verdict that takes no time
        file.write_text("time,PV,OP\n" + "".join(f"{i},5,50\n" for i in range(100)))
    assert COLOUR.search(seen_on_a_terminal(file)), "the test sees colours where there are any"
    assert COLOUR.search(seen_on_a_terminal(file, NO_COLOR="")), "empty means not set (no-color.org)"
    plain = seen_on_a_terminal(file, NO_COLOR="1")
    assert plain and not re.search(rb"\x1b\[[\d;]*3[0-7]", plain)

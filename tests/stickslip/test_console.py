"""What every command shares, without any command."""

import click
import pytest
from click.testing import CliRunner

from stickslip.console import LONGEST_MESSAGE, Speaker, json_option, user_errors


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

"""Compiling is no silence."""

import io
import sys

from numba import njit
from stickslip.engine.notice import noticed


class Terminal(io.StringIO):
    def isatty(self):
        return True


def test_compiling_is_told_once_and_only_if_it_happens(monkeypatch):
    def twice(x):
        return 2 * x

    def four_times(x):
        return inner(inner(x))

    for stream, words in ((io.StringIO(), "engine, once; up to a minute"), (Terminal(), "engine, once: 2 of ")):
        inner, outer = njit(twice), njit(four_times)
        monkeypatch.setattr(sys, "stderr", stream)
        with noticed():
            assert outer(1.0) == 4.0
        monkeypatch.undo()
        assert words in stream.getvalue()
        assert isinstance(stream, Terminal) or stream.getvalue().count("\n") == 1
    again = io.StringIO()
    monkeypatch.setattr(sys, "stderr", again)
    for _ in range(2):
        with noticed("methods"):
            njit(lambda x: 5 * x)(1.0)
    assert again.getvalue().count("\n") == 1, "in one run it is said once"
    silent = io.StringIO()
    monkeypatch.setattr(sys, "stderr", silent)
    with noticed():
        assert outer(2.0) == 8.0  # compiled before
    assert silent.getvalue() == ""


def test_a_check_says_that_the_methods_are_being_compiled(monkeypatch, tmp_path):
    from click.testing import CliRunner
    from stickslip.cases.stories import EXPORTS

    from stickslip import detect
    from stickslip.commands.cli import cli

    diagnose = detect.diagnose

    def first_on_this_machine(record):
        njit(lambda x: 3 * x)(1.0)
        return diagnose(record)

    monkeypatch.setattr(detect, "diagnose", first_on_this_machine)
    said = CliRunner().invoke(cli, ["check", str(EXPORTS / "LIC410_level.csv")]).stderr
    assert said.startswith("stickslip: compiling what is new here of the detection methods, once")
    assert said.count("\n") == 1

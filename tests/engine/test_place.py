"""An installation that cannot be written keeps its compiled code elsewhere, and compiling is no silence."""

import io
import os
import shutil
import stat
import subprocess
import sys
from pathlib import Path

import pytest
from numba import njit

from engine import place
from engine.notice import noticed

ROOT = Path(__file__).resolve().parents[2]


def test_nothing_writable_but_a_folder_for_temporary_files(tmp_path):
    for package in ("blocks", "diagram", "engine", "logs", "plant"):
        shutil.copytree(ROOT / package, tmp_path / package, ignore=shutil.ignore_patterns("__pycache__"))
        for folder in (tmp_path / package, *(p for p in (tmp_path / package).rglob("*") if p.is_dir())):
            (folder / "__pycache__").touch()  # a file in its place: no user, not even root, can write there
    (tmp_path / "tmp").mkdir()
    environment = {k: v for k, v in os.environ.items() if not k.startswith(("NUMBA", "XDG"))} | {
        "PYTHONPATH": str(tmp_path), "HOME": "/dev/null", "TMPDIR": str(tmp_path / "tmp"),
        "MPLCONFIGDIR": str(tmp_path / "tmp"),
    }  # fmt: skip
    code = (
        "import plant; from blocks import FirstOrder; from engine.call import address;"
        "address(FirstOrder(1.0, 1.0).kernels.out)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=environment, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    kept = list((tmp_path / "tmp").rglob("*.nbc"))
    assert kept
    own = tmp_path / "tmp" / kept[0].relative_to(tmp_path / "tmp").parts[0]
    assert own.name.startswith("stickslip") and stat.S_IMODE(own.stat().st_mode) == 0o700


@pytest.mark.skipif(not hasattr(os, "getuid"), reason="no user ids on this system")
def test_a_folder_that_others_can_write_is_not_trusted(tmp_path):
    first = place.own_folder(tmp_path)
    assert place.own_folder(tmp_path) == first
    first.chmod(0o777)
    other = place.own_folder(tmp_path)
    assert other != first and stat.S_IMODE(other.stat().st_mode) == 0o700
    shutil.rmtree(first)
    (tmp_path / "elsewhere").mkdir()
    first.symlink_to(tmp_path / "elsewhere")
    assert place.own_folder(tmp_path) != first


class Terminal(io.StringIO):
    def isatty(self):
        return True


def test_compiling_is_told_once_and_only_if_it_happens(monkeypatch):
    def twice(x):
        return 2 * x

    def four_times(x):
        return inner(inner(x))

    for stream, words in ((io.StringIO(), "once per machine; this takes"), (Terminal(), "once per machine: 2 of ")):
        inner, outer = njit(twice), njit(four_times)
        monkeypatch.setattr(sys, "stderr", stream)
        with noticed():
            assert outer(1.0) == 4.0
        monkeypatch.undo()
        assert words in stream.getvalue()
        assert isinstance(stream, Terminal) or stream.getvalue().count("\n") == 1
    silent = io.StringIO()
    monkeypatch.setattr(sys, "stderr", silent)
    with noticed():
        assert outer(2.0) == 8.0  # compiled before
    assert silent.getvalue() == ""


def test_a_check_says_that_the_methods_are_being_compiled(monkeypatch, tmp_path):
    from click.testing import CliRunner

    import detect
    from cases.stories import EXPORTS
    from stickslip.cli import cli

    diagnose = detect.diagnose

    def first_on_this_machine(record):
        njit(lambda x: 3 * x)(1.0)
        return diagnose(record)

    monkeypatch.setattr(detect, "diagnose", first_on_this_machine)
    said = CliRunner().invoke(cli, ["check", str(EXPORTS / "LIC410_level.csv")]).stderr
    assert said.startswith("stickslip: compiling the detection methods, once per machine") and said.count("\n") == 1

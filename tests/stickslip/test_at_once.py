"""Commands that take long say at once what they do, and refuse at once what they cannot do."""

import io
import subprocess
import sys

import numpy as np
import pytest
from stickslip.logs import LoopRecord

from stickslip.commands import fit
from stickslip.commands.scan import command as scan

ASKED = """
import sys
from click.testing import CliRunner
from stickslip.commands.cli import cli
done = CliRunner().invoke(cli, sys.argv[1:])
print(done.exit_code, "numba" in sys.modules, done.stderr)
"""


@pytest.mark.parametrize("command", ["fit", "remedy"])
@pytest.mark.parametrize(("rows", "op", "why"), [(2, "50", "2 samples"), (300, "50", "OP or PV stands still")])
def test_what_cannot_be_fitted_is_refused_before_anything_heavy_is_loaded(tmp_path, command, rows, op, why):
    file = tmp_path / "loop.csv"
    file.write_text("time,PV,OP\n" + "".join(f"{t},{t % 7},{op}\n" for t in range(rows)))
    words = [sys.executable, "-c", ASKED, command, str(file)]
    said = subprocess.run(words, capture_output=True, text=True, check=True).stdout
    assert said.startswith("2 False Error: ") and why in said


@pytest.mark.parametrize(("rows", "op"), [(199, None), (300, 50.0)])
def test_the_command_refuses_what_the_fit_refuses_and_in_its_words(rows, op):
    from stickslip import remedy

    t = np.arange(float(rows))
    record = LoopRecord.from_arrays(t, pv=np.sin(t / 8), op=np.cos(t / 8) if op is None else np.full(rows, op))
    with pytest.raises(remedy.FitError) as before:
        fit.refuse_unfit([record])
    with pytest.raises(remedy.FitError) as within:
        remedy.fit(record)
    assert str(before.value) == str(within.value)


class Terminal(io.StringIO):
    def isatty(self):
        return True


def test_a_terminal_hears_at_once(monkeypatch, tmp_path):
    file = tmp_path / "loop.csv"
    file.write_text("time,PV,OP\n0,1,2\n1,2,3\n")
    heard = Terminal()
    monkeypatch.setattr(sys, "stderr", heard)
    with pytest.raises(ValueError, match="2 samples"):
        fit.fitted([file], {})
    assert heard.getvalue().startswith("reading the log ...")
    with pytest.raises(SystemExit):
        scan.main([str(tmp_path / "nothing"), "--out", str(tmp_path / "out")], standalone_mode=False)
    assert "reading; a first scan on this machine also compiles" in heard.getvalue()

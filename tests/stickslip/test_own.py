"""Cases and detectors of the user's own, FILE.py:FUNCTION, and a file that is piped in."""

import gzip
import json
from pathlib import Path

import pytest

OWN = """
from stickslip.blocks import FirstOrder, IdealValve, PI, Step
from stickslip.detect import Verdict
from stickslip.diagram import wire


def loop():
    return wire([Step("SP", after=1.0), PI(K_p=0.4, T_i=10.0), IdealValve(), FirstOrder(K=3.0, tau=10.0)])


def detect(record):
    return Verdict("mine", "no_stiction", 0.25, 1.0, "A quarter of the limit.")


wired = loop()


def five():
    return 5


def broken(*anything):
    raise RuntimeError("planted")
"""


@pytest.fixture
def own(tmp_path):
    path = tmp_path / "my_own.py"
    path.write_text(OWN)
    return path


@pytest.fixture
def record(exports):
    return exports / "FIC101_pi_export.csv"


def test_a_detector_of_ones_own_is_shown_and_has_no_vote(call, own, record):
    plain = json.loads(call("check", record, "--json", "-").stdout)
    done = call("check", record, "--method", f"{own}:detect", "--json", "-")
    found = json.loads(done.stdout)
    assert done.exit_code == 1 and found["verdict"] == plain["verdict"]
    assert found["probability"] == plain["probability"]
    assert found["methods"][:-1] == plain["methods"] and found["methods"][-1]["name"] == "mine"


def test_a_table_of_a_case_and_a_detector_of_ones_own(call, own):
    done = call("table", f"{own}:loop", "--method", f"{own}:detect", "--method", "area_ratio", "--json", "-")
    (loop,) = json.loads(done.stdout)["loops"]
    assert [method["name"] for method in loop["methods"]] == ["mine", "area_ratio"]
    assert done.exit_code == 0 and "no" in done.stderr  # it is on trial


def test_a_case_of_ones_own_is_simulated_linearised_and_studied(call, own, tmp_path):
    done = call("simulate", f"{own}:loop", "--json", "-")
    found = json.loads(done.stdout)
    assert found["duration_s"] == 600.0 and found["final"]["PV"] == pytest.approx(1.0, abs=1e-3)  # analytic: it settles
    assert "was executed" in done.stderr
    assert json.loads(call("linearise", f"{own}:loop", "--json", "-").stdout)["stable"]
    done = call("study", f"{own}:loop", "--vary", "process.K=1,2", "--duration", "60", "--out", tmp_path / "study")
    assert done.exit_code == 0 and "2 runs" in done.stdout


def test_a_diagram_that_stands_in_the_file_is_taken_as_it_is(call, own):
    # python-control calls a system with its inputs: "missing 1 required positional argument: 'u'"
    found = [json.loads(call("simulate", f"{own}:{name}", "--json", "-").stdout) for name in ("loop", "wired")]
    assert found[0]["final"] == found[1]["final"]


@pytest.mark.parametrize(
    ("arguments", "piece"),
    [
        (["simulate", "nowhere.py:loop"], "there is no file 'nowhere.py'; give FILE.py:FUNCTION"),
        (["simulate", "{own}"], "give {own}:loop or {own}:detect or {own}:five or {own}:broken"),
        (["simulate", "{own}:lop"], "has no function 'lop'; did you mean 'loop'"),
        (["simulate", "{own}:five"], "returned int; return stickslip.diagram.wire([...]) or a stickslip.cases.Case"),
        (["study", "{own}:broken"], "the function failed (RuntimeError: planted)"),
        (["table", "{own}:loop", "--method", "{own}:broken"], "failed on a record (RuntimeError: planted)"),
        (["table", "{own}:loop", "--method", "{own}:five"], "failed on a record (TypeError"),
        (
            ["table", "ideal_high", "--method", "area_ratoi"],
            "there is no method 'area_ratoi'; did you mean 'area_ratio'",
        ),
        (["check", "{record}", "--method", "{own}:broken"], "failed on a record (RuntimeError: planted)"),
        (["check", "{record}", "--method", "area_ratio"], "all methods of detect are shown anyway"),
        (["check", "{record}", "{record}", "--method", "{own}:detect"], "--method is of one loop"),
        (["simulate", "{bad}:loop"], "cannot be executed (SyntaxError"),
    ],
)
def test_what_is_wrong_is_said(call, own, record, tmp_path, arguments, piece):
    bad = tmp_path / "bad.py"
    bad.write_text("def loop(:\n")
    names = {"own": own, "record": record, "bad": bad}
    done = call(*(word.format(**names) for word in arguments))
    assert done.exit_code == 2 and piece.format(**names) in done.stderr, done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.parametrize("command", ["check", "table", "simulate", "study", "linearise", "gap"])
def test_the_help_says_that_the_file_is_executed(call, command):
    assert "IS EXECUTED" in " ".join(call(command, "--help").stdout.split())


@pytest.fixture
def piped():
    """Run `stickslip check -` in this process with bytes on standard input."""
    from click.testing import CliRunner

    from stickslip.commands.cli import cli

    def run(content, *arguments):
        return CliRunner().invoke(cli, ["check", *map(str, arguments)], input=content, catch_exceptions=False)

    return run


@pytest.mark.parametrize("packed", [False, True])
def test_a_file_that_is_piped_in(call, piped, record, packed):
    content = gzip.compress(record.read_bytes()) if packed else record.read_bytes()
    done = piped(content, "-", "--json", "-")
    found, plain = json.loads(done.stdout), json.loads(call("check", record, "--json", "-").stdout)
    assert done.exit_code == 1 and {**found, "assumptions": 0} == {**plain, "assumptions": 0}
    assert found["period_s"] > 0.0 and found["amplitude"] > 0.0


def test_mistakes_on_standard_input(piped, record):
    done = piped(b"", "-")
    assert done.exit_code == 2 and "standard input: the file is empty" in done.stderr and "/tmp" not in done.stderr
    done = piped(b"x", "-", "-")
    assert done.exit_code == 2 and "- is given twice" in done.stderr


def test_one_of_several_files_is_piped_in(piped, record):
    done = piped(record.read_bytes(), record, "-", "--json", "-")
    assert len(json.loads(done.stdout)["files"]) == 2


def test_every_command_that_executes_a_file_is_named_by_the_security_page():
    root = Path(__file__).parents[2]
    page = (root / "SECURITY.md").read_text()
    sources = {path.stem: path.read_text() for path in (root / "stickslip" / "commands").glob("*.py")}
    executing = {
        name
        for name, source in sources.items()
        if name != "own" and ("IS EXECUTED" in source or "stickslip.commands.own import" in source)
    }
    assert {"simulate", "gap"} <= executing
    assert {name for name in executing if f"`{name}`" not in page and f"`stickslip {name}`" not in page} == set()

"""`stickslip gap`: words, document and exit code for a gap, for none, and for what cannot be read."""

import json

import numpy as np
import pytest

KNOWN = {}  # what a log says -> its report
MODEL = """
from stickslip.cases.models import ideal_flow


def loop():
    return ideal_flow()


def nothing():
    return 5
"""


@pytest.fixture
def model(tmp_path):
    path = tmp_path / "model.py"
    path.write_text(MODEL)
    return path


@pytest.fixture
def written(tmp_path):
    """Write ten minutes of the ideal flow loop under a controller of another gain."""

    def write(factor):
        from stickslip.cases.models import ideal_flow
        from stickslip.diagram import ensemble
        from stickslip.gap.effects import effect
        from stickslip.logs import Log

        t = np.arange(601.0)
        SP = np.where(t < 300.0, 1.5, 1.6)
        model = effect("controller_gain").insert(ideal_flow(rest=1.5), "controller", factor=factor)
        many = ensemble(
            model, 600.0, times=t, inputs=Log(t, {"SP": SP}), seeds=[1], signals=["OP", "PV"], progress=False
        )
        path = tmp_path / "run.csv"
        columns = np.column_stack([t, SP, many.values["OP"][0], many.values["PV"][0]])
        np.savetxt(path, columns, fmt="%.6f", delimiter=",", header="time,SP,OP,PV", comments="")
        return path

    return write


@pytest.fixture
def once(monkeypatch):
    """Diagnose each log once, however many tests of this file give it to the command."""
    from stickslip import gap

    plain = gap.diagnose

    def remembered(diagram, log, **settings):
        key = tuple(log[s].tobytes() for s in log.names)
        if key not in KNOWN:
            KNOWN[key] = plain(diagram, log, **settings)
        return KNOWN[key]

    monkeypatch.setattr(gap, "diagnose", remembered)


def test_a_gap_is_exit_code_one_and_named(call, once, written, model, tmp_path):
    page = tmp_path / "gap.html"
    result = call("gap", written(1.3), "--model", f"{model}:loop", "--json", "-", "--html", page)
    assert result.exit_code == 1, result.output
    found = json.loads(result.stdout, parse_constant=lambda word: pytest.fail(word))
    assert set(found) == {"schema", "gap", "where", "causes", "ranking", "hints", "shrinkage"}
    assert found["where"]["place"] == "controller" and found["causes"][0]["effect"] == "controller_gain"
    assert found["causes"][0]["parameters"]["factor"]["value"] == pytest.approx(1.3, rel=1e-3)
    assert "Cause: controller_gain at controller" in " ".join(result.stderr.split())
    rows = [row for row in result.stderr.splitlines() if row.startswith("│")]
    assert rows and not any("1.000" in row for row in rows) and any("over 99 %" in row for row in rows)
    html = page.read_text(encoding="utf-8")
    first = html[: html.index(">Why<")]
    assert "OP as logged" in first and "with controller gain at controller" in first and "The gap shrinks by" in first


def test_no_gap_is_exit_code_zero(call, written, model, tmp_path):
    document = tmp_path / "gap.json"
    result = call("gap", written(1.0), "--model", f"{model}:loop", "--json", document)
    assert result.exit_code == 0 and result.stdout.startswith("NO GAP")
    assert json.loads(document.read_text())["gap"] is False


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--model", "nowhere"], "there is no case 'nowhere'"),
        (["--model", "nowhere.py:loop"], "there is no file 'nowhere.py'"),
        (["--model", "{model}:lop"], "has no function 'lop'; did you mean 'loop'"),
        (["--model", "{model}:nothing"], "returned int"),
    ],
)
def test_bad_input_is_exit_code_two(call, model, good, arguments, words):
    result = call("gap", good, *[word.format(model=model) for word in arguments])
    assert result.exit_code == 2 and words in " ".join(result.stderr.split())


def test_help_says_that_the_file_is_executed(call):
    assert "IS EXECUTED" in " ".join(call("gap", "--help").stdout.split())


def test_a_calibration_takes_the_minutes_that_are_given(call, once, written, model, monkeypatch):
    from stickslip import gap

    asked = []
    monkeypatch.setattr(gap, "calibrated", lambda *_, seconds, **__: asked.append(seconds) or "")
    path = written(1.3)
    for options in ((), ("--minutes", "10")):
        assert call("gap", path, "--model", f"{model}:loop", "--calibrate", *options).exit_code == 1
    assert asked == [float("inf"), 600.0]
    refused = call("gap", path, "--model", f"{model}:loop", "--calibrate", "--minutes", "0")
    assert refused.exit_code == 2 and "--minutes" in refused.output


def as_exported(path):
    """The same file as a plant writes it: its own tags, percent, clock times, commas."""
    lines = path.read_text().splitlines()
    rows = [[float(cell) for cell in line.split(",")] for line in lines[1:]]
    out = ["Zeit;FC101.SP;FC101.OP;FT101"]
    for t, SP, OP, PV in rows:
        clock = f"01.03.2026 08:{int(t) // 60:02d}:{int(t) % 60:02d}"
        out.append(";".join([clock, *(f"{v:.6f}".replace(".", ",") for v in (SP, 100.0 * OP, PV))]))
    other = path.with_name("export.csv")
    other.write_text("\n".join(out) + "\n")
    return other


NAMED = ("--signal", "SP=FC101.SP", "--signal", "PV=FT101", "--signal")


def test_an_export_with_other_names_units_and_marks_gives_the_same_answer(call, once, written, model):
    path = written(1.3)
    mine = json.loads(call("gap", path, "--model", "ideal_flow", "--json", "-").stdout)
    form = ("--time", "Zeit", "--time-format", "%d.%m.%Y %H:%M:%S", "--decimal", ",", "--separator", ";")
    result = call("gap", as_exported(path), "--model", "ideal_flow", *NAMED, "OP=0.01*FC101.OP", *form, "--json", "-")
    found = json.loads(result.stdout)
    assert result.exit_code == 1 and found["causes"][0]["effect"] == mine["causes"][0]["effect"] == "controller_gain"
    factors = [one["causes"][0]["parameters"]["factor"]["value"] for one in (mine, found)]
    assert factors[0] == pytest.approx(factors[1], rel=1e-6)


def test_percent_where_the_model_has_a_share_is_refused_with_the_remedy(call, written, model):
    result = call("gap", as_exported(written(1.0)), "--model", "ideal_flow", *NAMED, "OP=FC101.OP")
    assert result.exit_code == 2 and "keeps it within 0 and 1" in result.output and "factor of 0.01" in result.output


@pytest.mark.parametrize(("given", "said"), [
    ("OP", "give NAME=COLUMN"), ("=FC101.OP", "give NAME=COLUMN"), ("OP=0.01*", "give NAME=COLUMN"),
    ("OP=FT101", "give each column once"), ("OP=FC102.OP", "FC102.OP"), ("SP=FC101.OP", "called 'SP'"),
])  # fmt: skip
def test_a_signal_that_cannot_be_is_said(call, written, model, given, said):
    result = call("gap", as_exported(written(1.0)), "--model", "ideal_flow", *NAMED, given)
    assert result.exit_code == 2 and said in result.output and "Traceback" not in result.output


def test_without_a_model_two_records_of_a_loop_say_what_changed(call, tmp_path):
    from stickslip.remedy.example import sticky

    def file(name, K_p):
        record = sticky(hours=0.6, seed=3)
        op = 40.0 + K_p * (record.op - 40.0)  # the same loop behind a controller with another gain
        path = tmp_path / name
        columns = np.column_stack([record.t, record.sp, op, record.pv, record.sp, record.op, record.pv])
        header = "time,FIC1.SP,FIC1.OP,FIC1.PV,FIC2.SP,FIC2.OP,FIC2.PV"  # of two loops in one file
        np.savetxt(path, columns, fmt="%.6f", delimiter=",", header=header, comments="")
        return path

    given = "gap", file("later.csv", 0.5), "--fit", file("earlier.csv", 1.0)
    assert call(*given).exit_code == 2
    result = call(*given, "--loop", "FIC1", "--json", "-", "--html", tmp_path / "changed.html")
    assert result.exit_code == 1, result.output
    found = json.loads(result.stdout, parse_constant=lambda word: pytest.fail(word))
    assert set(found) == {"schema", "gap", "where", "causes", "ranking", "hints", "shrinkage"}
    page = (tmp_path / "changed.html").read_text()
    assert "The answer" in page and "Earlier: the fitted loop" in page and "Later: the fitted loop" in page
    gain = next(one for one in found["causes"] if one["effect"] == "controller_gain")
    assert gain["parameters"]["ratio"]["value"] == pytest.approx(0.5, rel=0.02)
    short = tmp_path / "short.csv"
    short.write_text("\n".join((tmp_path / "earlier.csv").read_text().splitlines()[:50]))
    refused = call("gap", tmp_path / "later.csv", "--fit", short, "--loop", "FIC1")
    assert refused.exit_code == 2 and "short.csv: the record has" in refused.output  # which of the two it is


def test_a_model_and_an_earlier_record_are_not_both_asked(call, written, model):
    result = call("gap", written(1.0), "--model", f"{model}:loop", "--fit", written(1.0))
    assert result.exit_code == 2 and "leave out the other" in result.output
    result = call("gap", written(1.0), "--model", f"{model}:loop", "--pv", "FT101")
    assert result.exit_code == 2 and "--signal PV=COLUMN says which column is which signal" in result.output
    result = call("gap", written(1.0), "--signal", "OP=x")
    assert result.exit_code == 2 and "need a --model" in result.output

"""`stickslip study`: the folder, the page, the document, and requests that make no sense."""

import json
import signal
import subprocess
import sys
import time

import polars as pl
import pytest
from stickslip.cases import find
from stickslip.cases.production import CASES_BY_NAME
from stickslip.study.request import fingerprint

from stickslip.commands.cli import COMMANDS
from stickslip.commands.study import subject_of
from tests.stickslip.conftest import ROOT

IDEAL = ("study", "ideal_integrating", "--duration", "300", "--every", "1", "--vary", "valve.F_s=1750:2250:3")


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    from click.testing import CliRunner

    from stickslip.commands.cli import cli

    folder = tmp_path_factory.mktemp("study") / "folder"
    arguments = [*IDEAL, "--vary", "controller.K_p=0.1,0.2", "--kicks", "2", "--out", str(folder), "--json", "-"]
    return CliRunner().invoke(cli, arguments, catch_exceptions=False), folder


def test_document_and_folder(done):
    result, folder = done
    assert result.exit_code == 0
    answer = json.loads(result.stdout, parse_constant=lambda word: pytest.fail(word))
    assert answer["schema"] == "stickslip.study/1" and answer["case"] == "ideal_integrating"
    assert answer["runs"] == answer["ok"] == 12
    table = pl.read_parquet(folder / "study.parquet")
    assert len(table) == 12 and table["valve.F_s"].unique().sort().to_list() == [1750.0, 2000.0, 2250.0]
    manifest = json.loads((folder / "study.json").read_text())
    assert manifest["status"] == "complete" and manifest["ok"] == 12 and manifest["request"] == answer["request"]
    assert set(answer["pictures"]) == {"spread.png", "growth.png", "map.png"}
    assert sorted(p.name for p in folder.iterdir()) == sorted(
        [".lock", "index.html", "study.json", "study.parquet", *answer["pictures"]]
    )
    footer = json.loads(pl.read_parquet_metadata(folder / "study.parquet")["stickslip"])
    assert footer["request"] == answer["request"]


def test_page_needs_no_network(done):
    text = (done[1] / "index.html").read_text()
    assert (
        "Study of ideal_integrating" in text
        and "Along the chain" in text
        and "runs oscillate" in text
        and text.count("<svg") == 3
    )
    assert "<script" not in text and "src=" not in text and "http" not in text.replace("http://www.w3.org", "")


def test_the_same_request_again_changes_no_row(done, call):
    _, folder = done
    before = (folder / "study.parquet").read_bytes()
    result = call(*IDEAL, "--vary", "controller.K_p=0.1,0.2", "--kicks", 2, "--out", folder)
    assert result.exit_code == 0 and (folder / "study.parquet").read_bytes() == before
    refused = call(*IDEAL, "--kicks", 2, "--out", folder)
    assert refused.exit_code == 2 and "holds another study" in refused.stderr and "--fresh" in refused.stderr
    assert "controller.K_p: there [0.1, 0.2], now not given" in refused.stderr
    assert (folder / "study.parquet").read_bytes() == before


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["ideal_integrate"], "did you mean 'ideal_integrating'"),
        (["ideal_high", "--vary", "valve.f_S=1,2"], "did you mean 'valve.F_s'"),
        (["ideal_high", "--vary", "valve.F_s=1:2"], "low:high:count"),
        (["ideal_high", "--vary", "valve.F_s=2000", "--vary", "valve.F_s=1750"], "given twice"),
        (["ideal_high", "--vary", "valve.F_s=uniform(1750,2250)"], "--random"),
        (["ideal_high", "--plant", "F_in=8000"], "no quantity 'F_in'"),
        (["plant_1_high", "--plant", "F_inn=8000"], "did you mean 'F_in'"),
        (["plant_1_high", "--plant", "F_in=1e5"], "none of the 1 runs is possible; the first: VPCS2 .* lower the feed"),
        (["plant_1_high", "--vary", "VPCS1.F_s=1:2:1000000", "--kicks", "20"], "20,000,000 runs"),
        (["ideal_high", "--longest", "-1"], "positive number of hours"),
        (["ideal_high", "--from", "900"], "must lie within the run"),
        (["ideal_high", "--from", "599.95"], "leaves 1 rows of the log"),
        (["plant_2_high", "--plant", "sine.amplitude=0.4"], "the feed goes from Z_I = -0.15 to 0.65"),
    ],
)
def test_mistakes_get_one_line_and_exit_code_2(call, tmp_path, arguments, words):
    import re

    result = call("study", *arguments, "--out", tmp_path / "folder")
    assert result.exit_code == 2, result.output
    assert re.search(words, result.stderr) and "Traceback" not in result.output
    assert not (tmp_path / "folder" / "study.json").exists()  # the next try finds no other study there


def test_a_plant_at_rest_is_told_how_to_move(call, tmp_path):
    result = call("study", "plant_1_none", "--plant", "F_in=7500,8000", "--duration", 20, "--out", tmp_path)
    assert result.exit_code == 0 and "--kicks N" in result.stdout


def test_runs_without_a_result_are_told(call, tmp_path):
    result = call("study", "plant_1_high", "--plant", "F_in=8000,20000", "--duration", 20, "--out", tmp_path)
    assert result.exit_code == 0 and "1 x infeasible: " in result.stdout
    assert "Runs without a result" in (tmp_path / "index.html").read_text()


def test_alike_reasons_are_counted_together_and_old_pictures_go(call, tmp_path):
    arguments = ["study", "plant_1_high", "--duration", 20, "--every", 1, "--out", tmp_path]
    call(*arguments, "--vary", "PCS11.K_p=5e-7,7e-7", "--vary", "PCS11.T_i=8,9")
    assert (tmp_path / "map.png").exists()
    result = call(*arguments, "--fresh", "--vary", "F_in.value=7600,1e6,2e6", "--kicks", 2)
    assert "4 x model ended: S1 is full: 81.9 of 81.9 m3 are liquid" in " ".join(result.stdout.split())
    assert not (tmp_path / "map.png").exists() and (tmp_path / "spread.png").exists()


@pytest.mark.skipif(sys.platform == "win32", reason="signals")
def test_ctrl_c_keeps_what_is_finished_and_the_same_command_goes_on(tmp_path, call):
    arguments = ["study", "ideal_integrating", "--vary", "valve.F_s=1750:2250:40000", "--out", str(tmp_path)]
    arguments += ["--duration", "1000", "--every", "1", "--workers", "1"]
    process = subprocess.Popen(
        [sys.executable, "-m", "stickslip", *arguments], cwd=ROOT, stderr=subprocess.PIPE, stdout=subprocess.PIPE
    )
    deadline = time.monotonic() + 90.0
    while not list(tmp_path.glob("parts/*.parquet")) and process.poll() is None and time.monotonic() < deadline:
        time.sleep(0.02)
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=60)
    assert process.returncode == 130, errors
    assert b"stopped by the keyboard" in errors and b"Traceback" not in errors
    kept = sum(len(pl.read_parquet(part)) for part in tmp_path.glob("parts/*.parquet"))
    assert kept > 0 and not (tmp_path / "study.parquet").exists()


@pytest.mark.parametrize("name", CASES_BY_NAME)
def test_the_subject_of_a_plant_case_is_the_case(name):
    subject = subject_of(find(name))
    assert fingerprint(subject.start(subject.build({}))) == fingerprint(find(name).build())


def test_a_plant_with_another_part_keeps_its_chain():
    subject = subject_of(find("plant_own_map"))
    assert subject.signals == subject_of(find("plant_1_high")).signals and subject.settings.method == "stiff"
    assert subject.kicked == ("S1.N_oil", "S1.N_metL", "S1.N_metG")


def test_it_is_listed(call):
    assert "study" in COMMANDS and "study" in call("--help").stdout

"""Broken and hostile files end in a clear error or a flagged result: no traceback, hang, script or formula.

The files and the rules are those of ``benchmarks.hostile``, which also changes good files at random.
"""

import warnings
from collections import Counter

import pytest

pytest.importorskip("resource", reason="limits of memory are of Unix")

from benchmarks.hostile import MODEL, faults_of_csv, faults_of_page, good_files, run, tried
from benchmarks.hostile_files import files, mutated
from benchmarks.hostile_rows import good_rows, table
from benchmarks.hostile_text import INJECTIONS
from stickslip.commands.report.page import Section, page

COMMANDS = ("check", "valve", "gap", "scan")
HEAVY = ("bomb", "million", "thousand million", "thirty thousand")  # through one command only: they take a second each


@pytest.fixture(scope="module")
def hostile():
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # zipfile does not like what is made here
        return list(files())


def kinds():
    return ("container", "workbook", "parquet", "encoding", "shape", "value", "time", "name")


def test_there_are_more_than_two_hundred_and_of_every_kind(hostile):
    counts = Counter(one.what.split(":")[0] for one in hostile)
    assert sum(counts.values()) >= 300 and set(counts) == set(kinds())
    assert len({one.what for one in hostile}) == len({one.name for one in hostile}) == len(hostile)
    assert len(INJECTIONS) >= 40


@pytest.mark.parametrize("kind", kinds())
def test_every_command_on_every_file(hostile, kind, tmp_path, monkeypatch):
    out = tmp_path / "out"
    out.mkdir()
    monkeypatch.chdir(out)
    for one in hostile:
        if not one.what.startswith(f"{kind}: "):
            continue
        file = tmp_path / one.name
        file.write_bytes(one.content)
        heavy = any(word in one.what for word in HEAVY)
        model = "loop" if "everywhere" in one.what and kind == "value" else "other"
        for command, _, found in tried(file, out, False, ("check",) if heavy else COMMANDS, model):
            assert found == [], f"{one.what}: {command}"
        file.unlink()
    assert not list(tmp_path.glob("*escaped*")) and not list(tmp_path.parent.glob("*escaped*"))


def test_a_scan_of_all_of_them_at_once(hostile, tmp_path):
    """One bad file stops no other: a row for each that is no archive of several, and nothing that runs."""
    folder, page_file, csv_file = tmp_path / "in", tmp_path / "all.html", tmp_path / "all.csv"
    folder.mkdir()
    few = [one for one in hostile if not any(word in one.what for word in HEAVY)]
    for one in few:
        (folder / one.name).write_bytes(one.content)
    (folder / "<img src=x onerror=alert(1)>.csv").write_text("time,PV,OP\n0,4,50\n")
    (folder / "=cmd.csv").write_text("time,PV,OP\n0,4,50\n")
    done = run("scan", str(folder), "--out", str(tmp_path / "scan"), "--workers", "1", "--html", str(page_file),
               "--csv", str(csv_file))  # fmt: skip
    assert done.exit_code in (0, 1), done.output
    import polars as pl

    table = pl.read_parquet(tmp_path / "scan" / "scan.parquet")
    assert len(table) >= len(few) and table["error"].is_not_null().sum() >= 100
    assert "Traceback" not in " ".join(table["error"].drop_nulls())
    errors = table["error"].drop_nulls().str.extract(r"^(\w+Error|Panic\w*):").drop_nulls().unique().to_list()
    assert errors == []  # a fault of ours stands in a row with the name of its class
    assert faults_of_page(page_file.read_text()) == [] and faults_of_csv(csv_file.read_text()) == []


@pytest.mark.parametrize("text", [text for text in INJECTIONS if "<" in text or "script" in text or "=" in text])
def test_a_page_runs_nothing_that_a_file_says(text, tmp_path, monkeypatch):
    section = Section(text, text, "bad", text, before=text, aside=text, after=text, notes=[text])
    assert faults_of_page(page(text, text, [section], table=[[text], [text]], guide=text)) == []


@pytest.mark.parametrize("text", ["<img src=x onerror=alert(1)>", '"><svg onload=alert(1)>', "$\\frac{1}{"])
def test_the_report_of_a_hostile_tag(text, tmp_path):
    assert text in INJECTIONS
    cell = text.replace('"', '""')
    file = tmp_path / "tag.csv"
    file.write_text(table(("time", f'"{cell}.PV"', f'"{cell}.OP"'), good_rows(120)))
    for command, _, found in tried(file, tmp_path, True, ("check", "scan"), "other"):
        assert found == [], command
    assert "<svg" in (tmp_path / "page.html").read_text()


def test_the_judges_of_this_test_can_find_something():
    assert faults_of_page("<p onclick='x'>") and faults_of_page("<script>x</script>")
    assert faults_of_page("<a href='http://x/'>") and not faults_of_page("<a href='#s0'>")
    assert faults_of_csv("a,=1+1\n") and faults_of_csv('"\t=1"\n') and not faults_of_csv("a,-1.5e3\n")
    assert "def other" in MODEL


@pytest.mark.parametrize("ending", list(good_files()))
def test_good_files_changed_at_random(ending, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    good = good_files()[ending]
    for seed in range(40):
        file = tmp_path / f"changed.{ending}"
        file.write_bytes(mutated(good, seed))
        for _, _, found in tried(file, tmp_path, False, ("check",)):
            assert found == [], f"seed {seed}"

"""A scan gives one row a loop whatever the form of the source, whatever falls over, however often it is begun."""

import os
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import polars as pl
import pytest
from stickslip.logs import ReadError
from stickslip.scan import ScanError, ScanResult, scan
from stickslip.scan.judge import judged, row_of
from stickslip.scan.loop_map import read_map
from stickslip.scan.sources import Job, source_of
from stickslip.scan.table import csv_bytes, ranked, table_of
from stickslip.scan.together import grouped, phasors

TAGS = ("FIC101", "LIC102", "PIC103", "TIC104")  # of conftest.py
PLAIN = ["loop", "verdict", "period_s", "samples", "interval_s"]
FORMS = ["wide", "text", "long", "folder", "tags", "query"]


@pytest.fixture(scope="session")
def rows(forms, tmp_path_factory) -> pl.DataFrame:
    return scan(forms["wide"], tmp_path_factory.mktemp("out"), workers=1).table.sort("loop")


def test_one_row_a_loop(rows) -> None:
    assert rows["loop"].to_list() == list(TAGS)
    assert rows["error"].is_null().all()
    # analytic: the periods that the records were made with, 100 and 140 s
    assert rows["period_s"].to_list()[:2] == [pytest.approx(100.0, rel=0.02), pytest.approx(140.0, rel=0.02)]
    assert rows["samples"].to_list() == [600] * 4


@pytest.mark.parametrize("form", FORMS[1:])
def test_every_form_gives_the_same_rows(form, forms, rows, tmp_path) -> None:
    if form == "query":
        pytest.importorskip("duckdb")
    found = scan(forms[form], tmp_path / "out", workers=1).table.sort("loop")
    assert found.select(PLAIN).equals(rows.select(PLAIN))


def test_processes_give_the_same_bytes(forms, tmp_path) -> None:
    scan(forms["folder"], tmp_path / "one", workers=1)
    source = source_of(forms["folder"], tmp_path / "kept")
    assert len(source.jobs) == 1 and source.count == len(TAGS)
    scan(forms["folder"], tmp_path / "two", workers=2)
    one, two = ((tmp_path / name / "scan.parquet").read_bytes() for name in ("one", "two"))
    assert one == two


def test_a_finished_scan_is_read_and_another_is_refused(forms, tmp_path) -> None:
    first = scan(forms["wide"], tmp_path, workers=1)
    progress = []
    again = scan(forms["wide"], tmp_path, workers=1, tell=lambda done, total: progress.append((done, total)))
    assert again.table.equals(first.table) and progress == [(4, 4)]
    with pytest.raises(ScanError, match="holds another scan"):
        scan(forms["long"], tmp_path, workers=1)
    fresh = scan(forms["long"], tmp_path, workers=1, fresh=True)
    assert len(fresh.table) == 4 and fresh.changes == ()


def test_a_killed_scan_goes_on_to_the_same_bytes(forms, tmp_path) -> None:
    many = tmp_path / "many"
    many.mkdir()
    for i in range(24):  # three jobs of eight files
        for tag in TAGS[:1]:
            (many / f"{tag}_{i:02d}.csv").write_bytes((Path(forms["folder"]) / f"{tag}.csv").read_bytes())
    command = [
        sys.executable,
        "-c",
        f"from stickslip.scan import scan; scan({str(many)!r}, {str(tmp_path / 'cut')!r}, workers=1)",
    ]
    process = subprocess.Popen(command, env={**os.environ})
    parts = tmp_path / "cut" / "parts"
    deadline = time.monotonic() + 120.0
    while time.monotonic() < deadline and process.poll() is None and not list(parts.glob("0*.parquet")):
        time.sleep(0.02)
    process.send_signal(signal.SIGKILL)
    process.wait()
    assert list(parts.glob("0*.parquet")) and not (tmp_path / "cut" / "scan.parquet").exists()
    scan(many, tmp_path / "cut", workers=1)
    scan(many, tmp_path / "whole", workers=1)
    cut, whole = ((tmp_path / name / "scan.parquet").read_bytes() for name in ("cut", "whole"))
    assert cut == whole


def test_a_scan_of_new_data_in_the_same_place_tells_what_changed(forms, wide, tmp_path) -> None:
    file = tmp_path / "trend.parquet"
    wide.write_parquet(file)
    first = scan(file, tmp_path / "out", workers=1)
    columns = {f"FIC101.{part}": pl.lit(1.0).alias(f"FIC101.{part}") for part in ("PV", "OP", "SP")}
    wide.with_columns(**columns).write_parquet(file)  # since then the loop stands still
    second = scan(file, tmp_path / "out", workers=1)
    before, now = (dict(zip(r.table["loop"], r.table["verdict"], strict=True))["FIC101"] for r in (first, second))
    assert [(c.loop, c.before, c.now) for c in second.changes] == ([("FIC101", before, now)] if before != now else [])
    assert now == "not_applicable"


def test_one_bad_loop_stops_no_other(forms, tmp_path, monkeypatch) -> None:
    folder = tmp_path / "plant"
    folder.mkdir()
    for tag in TAGS:
        (folder / f"{tag}.csv").write_bytes((Path(forms["folder"]) / f"{tag}.csv").read_bytes())
    (folder / "FIC900.csv").write_bytes(b"\x00\x01\x02" * 50)
    (folder / "FIC901.csv").write_text("time,PV,OP\n0,four,5\n")
    table = scan(folder, tmp_path / "out", workers=1).table
    assert len(table) == 6
    bad = table.filter(pl.col("error").is_not_null())
    assert sorted(bad["loop"]) == ["FIC900", "FIC901"] and bad["rank"].to_list() == [5, 6]
    assert "'four' is not a number" in " ".join(bad["error"])


def test_a_fault_of_ours_is_a_row_too(forms, monkeypatch) -> None:
    import stickslip.scan.judge

    def broken(record):
        if record.name == "LIC102":
            raise ZeroDivisionError("planted")
        return row_of(record)

    monkeypatch.setattr(stickslip.scan.judge, "row_of", broken)
    job = source_of(forms["wide"], Path("unused")).jobs[0]
    rows = judged(job, 3)
    assert [row["loop"] for row in rows] == list(TAGS)
    assert [row["order"] for row in rows] == [30_000, 30_001, 30_002, 30_003]
    assert rows[1]["error"] == "ZeroDivisionError: planted" and "verdict" in rows[2]


def test_a_loop_that_never_ends_is_given_up(forms, monkeypatch) -> None:
    import stickslip.scan.judge

    def endless(record):
        while True:
            time.sleep(0.01)

    monkeypatch.setattr(stickslip.scan.judge, "row_of", endless)
    monkeypatch.setattr(stickslip.scan.judge, "LOOP_MAX_S", 1)
    job = source_of(forms["wide"], Path("unused")).jobs[0]
    rows = judged(replace(job, loops=job.loops[:1]), 0)
    assert rows[0]["error"] == "TimeoutError: the loop took more than 1 s"


def test_a_loop_map_names_what_tags_do_not(wide, tmp_path) -> None:
    wide.select("time", pl.col("FIC101.PV").alias("FT-A"), pl.col("FIC101.OP").alias("FCV-A")).write_parquet(
        tmp_path / "trend.parquet"
    )
    with pytest.raises(ReadError, match="--map"):
        scan(tmp_path / "trend.parquet", tmp_path / "none")
    (tmp_path / "loops.csv").write_text("loop,pv,op,process,op_low,op_high\nFIC101,FT-A,FCV-A,self_regulating,0,100\n")
    result = scan(tmp_path / "trend.parquet", tmp_path / "out", loop_map=tmp_path / "loops.csv", workers=1)
    assert result.table["loop"].to_list() == ["FIC101"] and result.table["error"].is_null().all()


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("loop,pv\nA,B\n", "no column 'op'"),
        ("loop,pv,op,size\nA,B,C,3\n", "'size' that means nothing"),
        ("loop,pv,op\n", "no loop"),
        ("loop,pv,op\nA,B,C\nA,B,C\n", "line 3 names the loop 'A' again"),
        ("loop,pv,op\nA,,C\n", "line 2 has no pv"),
        ("loop,pv,op,process\nA,B,C,fast\n", "process = 'fast'"),
        ("loop,pv,op,op_low,op_high\nA,B,C,1,\n", "two numbers, or both blank"),
        ("loop,pv,op,op_low,op_high\nA,B,C,5,1\n", "op_low = 5 is not below op_high = 1"),
    ],
)
def test_a_bad_map_says_what_is_wrong(text, words, tmp_path) -> None:
    (tmp_path / "loops.csv").write_text(text)
    with pytest.raises(ReadError, match=words):
        read_map(tmp_path / "loops.csv")


def test_sources_that_are_none(tmp_path) -> None:
    with pytest.raises(ReadError, match="no such file or folder"):
        scan(tmp_path / "nothing", tmp_path / "out")
    (tmp_path / "empty").mkdir()
    with pytest.raises(ReadError, match="holds no record"):
        scan(tmp_path / "empty", tmp_path / "out")
    with pytest.raises(ScanError, match="at least one process"):
        scan(tmp_path / "empty", tmp_path / "out", workers=0)
    pytest.importorskip("duckdb")
    with pytest.raises(ReadError, match="the query failed"):
        scan("duckdb:SELECT FROM WHERE", tmp_path / "out")


def test_no_cell_of_the_csv_starts_a_formula() -> None:
    names = ["=1+1", "+A1", "-A1", "@SUM(A1)", "\t=1", "FIC1"]
    table = ranked(table_of([{"order": i, "loop": name} for i, name in enumerate(names)]))
    cells = pl.read_csv(csv_bytes(table), infer_schema=False)["loop"].to_list()
    assert cells == ["'=1+1", "'+A1", "'-A1", "'@SUM(A1)", "'\t=1", "FIC1"]


def test_ranking_and_changes(forms, tmp_path) -> None:
    rows = [("a", "inconclusive", 0.4), ("b", "stiction", 0.7), ("c", "stiction", 0.9), ("d", None, None)]
    table = ranked(table_of([
        {"order": i, "loop": name, "verdict": word, "probability": p} for i, (name, word, p) in enumerate(rows)
    ]))  # fmt: skip
    assert table["loop"].to_list() == ["c", "b", "a", "d"] and table["rank"].to_list() == [1, 2, 3, 4]
    assert ScanResult(table, "x").counts == {"stiction": 2, "inconclusive": 1, "error": 1}


def test_a_job_can_be_sent_to_another_machine(forms) -> None:
    import pickle

    job = source_of(forms["long"], Path("unused")).jobs[0]
    assert isinstance(job, Job) and pickle.loads(pickle.dumps(job)) == job


def test_the_picture_names_its_finding(forms, tmp_path) -> None:
    figure = scan(forms["wide"], tmp_path, workers=1).plot()
    assert "of 4 loops oscillate" in figure.get_suptitle()


def shared(rows: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """A wave whose period wanders, and a clock [s]."""
    phase = np.cumsum(2.0 * np.pi / 120.0 * (1.0 + 0.05 * np.random.default_rng(seed).normal(size=rows)))
    slow = np.convolve(np.random.default_rng(seed + 1).normal(size=rows + 299), np.ones(300) / 300, "valid")
    return np.arange(float(rows)), phase + 3.0 * slow * np.sqrt(300) / 3.0


def test_loops_that_share_an_oscillation_are_told_from_loops_of_the_same_period() -> None:
    t, phase = shared(7200, 1)
    _, other = shared(7200, 7)
    waves = {"A": np.sin(phase), "B": 3.0 * np.cos(phase - 1.0), "C": np.sin(other), "D": np.sin(2.7 * phase)}
    periods = (120.0, 120.5, 120.2, 44.4)
    table = pl.DataFrame({
        "loop": list(waves), "probability": [0.2, 0.9, 0.5, 0.1], "period_s": periods, "hours": 2.0, "start": 0.0,
        "source": "a",
        "phasors": [phasors(t, x, period) for x, period in zip(waves.values(), periods, strict=True)],
    })  # fmt: skip
    assert grouped(table) == ["B", "B", None, None]
    later = table.with_columns(start=pl.Series([0.0, 9000.0, 0.0, 0.0]))
    assert grouped(later) == [None] * 4  # not at the same time
    no_clock = table.with_columns(start=pl.lit(None, pl.Float64))
    assert grouped(no_clock) == ["B", "B", None, None]  # of one file
    assert grouped(no_clock.with_columns(source=pl.Series(list("abcd")))) == [None] * 4  # seconds of different files


def test_two_files_that_hold_no_clock_are_not_in_step(tmp_path: Path) -> None:
    t = np.arange(2400.0)
    for month in ("08", "11"):
        lines = [f"{s:g},50,{50 + np.sin(s / 10):.6f},{40 + np.cos(s / 10):.6f}" for s in t]
        (tmp_path / f"LIC1_{month}.csv").write_text("time,SP,PV,OP\n" + "\n".join(lines))
    job = Job("file", tuple(str(tmp_path / f"LIC1_{month}.csv") for month in ("08", "11")))
    table = ranked(table_of(judged(job, 0)))
    assert table["period_s"].null_count() == 0
    assert table["group"].to_list() == [None, None]


def test_a_stick_that_was_seen_ranks_before_one_that_is_probable() -> None:
    """Where the stem or slips of the valve were seen there is no probability."""
    said = [("A", "stiction", 0.97), ("B", "stiction", None), ("C", "inconclusive", 0.7), ("D", "inconclusive", None)]
    rows = [{"order": i, "loop": loop, "verdict": word, "probability": p} for i, (loop, word, p) in enumerate(said)]
    assert ranked(table_of(rows))["loop"].to_list() == ["B", "A", "C", "D"]


@pytest.mark.parametrize("ending", ["csv", "parquet"])
def test_a_file_whose_columns_name_no_loop_names_it_itself(ending, tmp_path) -> None:
    t = np.arange(300.0)
    frame = pl.DataFrame({"time": t, "PV": 50 + np.sin(t / 9), "OP": 45 + np.cos(t / 9)})
    file = tmp_path / f"FIC7.{ending}"
    frame.write_csv(file) if ending == "csv" else frame.write_parquet(file)
    row = scan(file, tmp_path / "out", workers=1).table.row(0, named=True)
    assert row["loop"] == "FIC7"


def test_a_loop_of_two_files_is_called_by_its_file() -> None:
    said = [("FIC1", "a/FIC1.csv"), ("FIC1", "a/wide.csv"), ("FIC2", "a/wide.csv"), ("FIC3", None)]
    table = ranked(table_of([{"order": i, "loop": loop, "source": file} for i, (loop, file) in enumerate(said)]))
    assert table["loop"].to_list() == ["FIC1 (FIC1.csv)", "FIC1 (wide.csv)", "FIC2", "FIC3"]
    assert b"FIC1 (wide.csv)" in csv_bytes(table)


def test_the_picture_says_how_many_of_the_sticky_loops_oscillate() -> None:
    said = [("stiction", 60.0), ("stiction", None), ("inconclusive", 30.0), ("inconclusive", None)]
    rows = [{"order": i, "loop": f"FIC{i}", "verdict": word, "period_s": s} for i, (word, s) in enumerate(said)]
    title = ScanResult(ranked(table_of(rows)), "x").plot().get_suptitle()
    assert title == "2 of 4 loops oscillate; of all 4, 2 called sticky, 1 of them oscillating"

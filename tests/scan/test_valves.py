"""A scan of days: one row a valve, judged by all of its records, with a page that shows each."""

from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from stickslip.detect.tag import judge_tag
from stickslip.logs import LoopRecord, read_loop
from stickslip.logs.tags import valve_in
from stickslip.scan.judge import judged
from stickslip.scan.sources import source_of
from stickslip.scan.table import table_of
from stickslip.scan.valves import records_at, with_valves

from stickslip.commands.cli import cli

N, EVERY, DAYS = 600, 5.0, 3


def day(seed, S, noise=0.16):
    """OP and PV of a valve with play S [%] before a slow flow, by plain recursions."""
    rng, t = np.random.default_rng(seed), np.arange(float(N))
    op = 50 + 4 * np.sin(2 * np.pi * np.cumsum(1 + 0.1 * rng.normal(size=N)) / 90) + np.sin(t / 31)
    pv, x, flow = np.empty(N), op[0], 0.0
    for k, u in enumerate(op):
        pv[k] = 50 + flow + noise * rng.normal()
        x = min(max(x, u - S / 2), u + S / 2)
        flow += (x - 50 - flow) / 8
    return EVERY * t, pv, op


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Three days of two valves, one of which sticks a little on each, and the same tag in another unit's folder."""
    place = tmp_path_factory.mktemp("days")
    (place / "other").mkdir()
    for i in range(DAYS):
        write(place / f"FIC12_2024-05-{i + 1:02d}.csv", *day(i, 1.8))
        write(place / f"FIC13_2024-05-{i + 1:02d}.csv", *day(20 + i, 0.0))
    write(place / "other" / "FIC12_2024-05-01.csv", *day(40, 0.0))
    return place


def write(file: Path, t, pv, op):
    lines = [f"{a:g},{b:.4f},{c:.4f}" for a, b, c in zip(t, pv, op, strict=True)]
    file.write_text("\n".join(["time,PV,OP", *lines]) + "\n")


@pytest.fixture(scope="module")
def source(folder, tmp_path_factory):
    return source_of(folder, tmp_path_factory.mktemp("kept"))


@pytest.fixture(scope="module")
def records(source):
    """The rows of all records, as a scan keeps them."""
    return table_of([row for number, job in enumerate(source.jobs) for row in judged(job, number)])


@pytest.fixture(scope="module")
def table(source, records):
    return with_valves(source, records, 1)


def row(table, loop):
    (found,) = (one for one in table.iter_rows(named=True) if one["loop"] == loop)
    return found


def test_a_valve_of_several_days_has_one_row(table, folder):
    assert sorted(table["loop"]) == ["FIC12", "FIC12_2024-05-01", "FIC13"]  # the other unit's is by itself
    found = row(table, "FIC12")
    together = judge_tag("FIC12", [read_loop(file) for file in sorted(folder.glob("FIC12_*.csv"))]).answer
    assert found["verdict"] == together.word == "stiction"  # as ``check`` of these files says
    assert found["probability"] == pytest.approx(together.probability)
    assert len(found["records"].split()) == DAYS
    assert row(table, "FIC13")["verdict"] != "stiction" and row(table, "FIC12_2024-05-01")["records"] is None


def test_its_records_are_read_again(table, source):
    orders = [int(one) for one in row(table, "FIC12")["records"].split()]
    again = [record for _, record in records_at(source, orders)]
    assert all(isinstance(one, LoopRecord) and valve_in(one.name) == "FIC12" for one in again) and len(again) == DAYS


def test_processes_give_the_same_table(source, records, table):
    assert with_valves(source, records, 2).equals(table)


def test_a_valve_that_fails_keeps_the_rows_of_its_records(source, records, monkeypatch):
    def broken(name, records):
        raise ZeroDivisionError("planted")

    monkeypatch.setattr("stickslip.scan.valves.row_of_valve", broken)
    assert with_valves(source, records, 1).equals(records)


def test_the_page_of_a_valve_shows_its_days(folder, tmp_path):
    html = tmp_path / "scan.html"
    places = ["--out", str(tmp_path / "out"), "--html", str(html)]
    done = CliRunner().invoke(cli, ["scan", str(folder), *places, "--reports", "1", "--workers", "1"])
    assert done.exit_code == 1, done.output
    (page,) = (tmp_path / "scan-loops").glob("*.html")
    text = page.read_text()
    assert f"FIC12: {DAYS} records" in text and "S of each record" in text and "adds [nats]" in text

"""The page of a scan says what changed since the last one, and which loops share an oscillation with which source."""

import re

import polars as pl
from stickslip.scan import ScanResult
from stickslip.scan.changes import Change, changes
from stickslip.scan.table import ranked, table_of

from stickslip.commands.scan_page import scan_page


def table(*rows):
    return ranked(table_of([
        {"order": i, "loop": loop, "verdict": verdict, "probability": p} for i, (loop, verdict, p) in enumerate(rows)
    ]))  # fmt: skip


def words(html):
    return " ".join(re.sub(r"<[^>]+>", " ", re.sub(r"<svg.*?</svg>|<style.*?</style>", " ", html, flags=re.S)).split())


def test_new_gone_and_changed_loops_are_listed():
    last = table(("A", "inconclusive", 0.4), ("B", "stiction", 0.9), ("GONE", "stiction", 0.9))
    now = table(("A", "stiction", 0.95), ("B", "stiction", 0.9), ("NEW", "no_stiction", 0.02))
    found = changes(last, now)
    assert set(found) == {
        Change("A", "inconclusive", "stiction"), Change("GONE", "stiction", ""), Change("NEW", "", "no_stiction"),
    }  # fmt: skip
    said = words(scan_page(ScanResult(now, "x", changes=found), "3 loops"))
    assert "What changed since the last scan 3 loops" in said
    for row in ("A inconclusive stiction", "GONE stiction gone", "NEW new no stiction"):
        assert row in said
    assert "What changed" not in words(scan_page(ScanResult(now, "x"), "3 loops"))


def test_a_group_stands_under_its_likely_source():
    rows = table(("A", "inconclusive", 0.4), ("B", "stiction", 0.997), ("C", "no_stiction", 0.02))
    rows = rows.with_columns(
        group=pl.when(pl.col("loop") != "C").then(pl.lit("B")), period_s=pl.when(pl.col("loop") != "C").then(120.0)
    )
    said = words(scan_page(ScanResult(rows, "x"), "3 loops"))
    assert "Loops that share an oscillation 1 group The same period" in said
    assert "B stiction over 99 % 2 120 A" in said

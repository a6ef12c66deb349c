"""The rows of a scan as a table: its columns, its order, and files that a spreadsheet opens safely."""

from __future__ import annotations

import io
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from stickslip.detect.comparison import harmless
from stickslip.scan.together import grouped

if TYPE_CHECKING:
    import polars as pl

__all__ = ["COLUMNS", "csv_bytes", "ranked", "table_of"]

# column -> type; every scan writes all of them.  ``records``: the orders of those that were pooled, parted by blanks
COLUMNS = {
    "order": "Int64", "loop": "String", "verdict": "String", "probability": "Float64", "cause": "String",
    "cause_probability": "Float64", "S": "Float64", "S_low": "Float64", "S_high": "Float64", "J": "Float64",
    "J_low": "Float64", "J_high": "Float64", "detection_limit": "Float64", "size_unit": "String",
    "period_s": "Float64", "amplitude": "Float64", "health": "String", "reason": "String", "action": "String",
    "samples": "Int64", "interval_s": "Float64", "hours": "Float64", "start": "Float64", "error": "String",
    "records": "String", "phasors": "List", "source": "String",
}  # fmt: skip
FIRST = ("stiction", "inconclusive", "no_stiction", "not_applicable")  # verdicts in the order to look at them


def table_of(rows: Sequence[dict[str, Any]]) -> pl.DataFrame:
    """The rows with all columns; what a row does not say is null."""
    import polars as pl

    schema = {name: pl.List(pl.Float64) if kind == "List" else getattr(pl, kind) for name, kind in COLUMNS.items()}
    return pl.DataFrame([{name: row.get(name) for name in COLUMNS} for row in rows], schema=schema, orient="row")


def ranked(table: pl.DataFrame) -> pl.DataFrame:
    """Return the table ranked, with the columns ``rank`` and ``group``.

    Rows are ordered by verdict, then by probability, then as before; ``together`` says what a group is."""
    import polars as pl

    place = pl.col("verdict").replace_strict(
        dict(zip(FIRST, range(len(FIRST)), strict=True)), default=len(FIRST), return_dtype=pl.Int64
    )
    seen = pl.when(pl.col("verdict") == "stiction").then(1.0).otherwise(-1.0)  # the stem or slips were seen: no guess
    by = [place, pl.col("probability").fill_null(seen), pl.col("order")]
    table = _by_file(table)
    table = table.with_columns(pl.Series("group", grouped(table), dtype=pl.String)).drop("phasors", "source")
    table = table.sort(by, descending=[False, True, False])
    return table.select(pl.int_range(1, pl.len() + 1, dtype=pl.Int64).alias("rank"), pl.all())


def _by_file(table: pl.DataFrame) -> pl.DataFrame:
    """The table in which a loop that several files hold is called by its file, too."""
    import polars as pl

    places = table.group_by("loop").agg(pl.col("source").drop_nulls().n_unique().alias("n"))
    several = set(places.filter(pl.col("n") > 1)["loop"])
    names = [
        f"{row['loop']} ({Path(row['source']).name})" if row["loop"] in several and row["source"] else row["loop"]
        for row in table.select("loop", "source").iter_rows(named=True)
    ]
    return table.with_columns(pl.Series("loop", names, dtype=pl.String))


def csv_bytes(table: pl.DataFrame) -> bytes:
    """The table as CSV; an apostrophe stands before text that a spreadsheet would run as a formula."""
    import polars as pl

    text = [name for name, kind in table.schema.items() if kind == pl.String]
    content = io.BytesIO()
    safe = [pl.col(name).map_elements(harmless, return_dtype=pl.String) for name in text]
    table.with_columns(safe).write_csv(content)
    return content.getvalue()

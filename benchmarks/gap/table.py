"""Every row of the gap's benchmark as a line of a table, for people and for other programs."""

import csv
import io
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from stickslip.commands.targets import write_whole

COLUMNS = (
    "record", "visible [noises]", "gap", "named", "places", "probability", "cause right", "place right", "both right",
    "unknown", "processor time [s]",
)  # fmt: skip


def write_table(rows: Sequence[Mapping[str, Any]], file: Path) -> None:
    """Write rows of loops and of the plant as CSV, in the order of their records' names.

    What is not known of a row is left empty: whether both effects of a single one are right.
    """
    text = io.StringIO()
    out = csv.writer(text, lineterminator="\n")
    out.writerow(COLUMNS)
    out.writerows(_line(row) for row in sorted(rows, key=lambda row: row["key"]))
    write_whole(file, text.getvalue().encode())


def _line(row: Mapping[str, Any]) -> list[str]:
    """Return the cells of one row.

    >>> row = {"key": "report/ideal/none/typical/1000/no_mv", "visible": 0.0, "gap": False, "names": [], "places": []}
    >>> _line({**row, "probability": None, "unknown": False, "cpu": 0.61})[:4]
    ['report/ideal/none/typical/1000/no_mv', '0.0', 'False', '']
    """
    marks = [row.get(key) for key in ("cause", "place", "both", "unknown")]
    return [
        row["key"],
        str(round(row.get("visible", 0.0), 3)),
        str(row["gap"]),
        " ".join(row["names"]),
        " ".join(row["places"]),
        "" if row["probability"] is None else str(round(row["probability"], 3)),
        *("" if value is None else str(bool(value)) for value in marks),
        str(round(row["cpu"], 1)),
    ]

"""Rows of a long measurement, one a line of a file, so that it can go on where it was stopped."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

__all__ = ["appended", "kept"]

Row = dict[str, Any]


def kept(file: Path | None) -> list[Row]:
    """The rows that a file has; none where there is no file."""
    return [json.loads(line) for line in file.read_text().splitlines()] if file and file.exists() else []


def appended(file: Path | None, rows: Sequence[Row]) -> Sequence[Row]:
    """The rows, which a file has now too."""
    if file:
        with file.open("a") as lines:
            lines.writelines(json.dumps(row) + "\n" for row in rows)
    return rows

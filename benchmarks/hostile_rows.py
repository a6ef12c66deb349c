"""Rows of a plain record as text, to be spoilt."""

__all__ = ["ROWS", "good_rows", "table"]

ROWS = 40  # of a file that is good but for one thing: enough to be read, too few to be judged


def good_rows(count: int = ROWS) -> list[tuple[str, str, str]]:
    """Time [s], PV and OP of a plain record as text."""
    return [(str(i), f"{4 + 0.1 * (i % 7):.1f}", str(50 + i % 5)) for i in range(count)]


def table(
    header: tuple[str, ...] = ("time", "PV", "OP"), rows: list[tuple[str, str, str]] | None = None, cut: str = ",",
    end: str = "\n",
) -> str:  # fmt: skip
    """A table of text."""
    lines = [cut.join(header), *(cut.join(row) for row in (good_rows() if rows is None else rows))]
    return end.join(lines) + end

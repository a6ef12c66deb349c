"""``stickslip table --cards``: the methods themselves, thesis tables 2.1 and 2.2 again, with what was measured."""

from pathlib import Path
from typing import TYPE_CHECKING

from stickslip.commands.console import Speaker
from stickslip.commands.targets import write_whole

if TYPE_CHECKING:
    from stickslip.detect import Method

SCHEMA = "stickslip.cards/1"


def show_cards(say: Speaker, methods: "list[Method]", csv_file: Path | None, html: Path | None) -> None:
    """Print the tables, and write them as asked: CSV has one row a method with all columns."""
    from stickslip.detect.cards import (
        CARD_COLUMNS,
        OUTLINE_COLUMNS,
        PUBLISHED_COLUMNS,
        RATE_COLUMNS,
        card_rows,
        outline_rows,
        published_rows,
        rate_rows,
    )  # fmt: skip
    from stickslip.detect.comparison import csv_text
    from stickslip.detect.rates import described

    rows = card_rows(methods)
    measured = rate_rows(methods)
    say("Outline of methods (thesis table 2.1)", bold=True)
    say.table(list(OUTLINE_COLUMNS), outline_rows())
    say("Comparison (thesis table 2.2), measured", bold=True)
    say.table(list(RATE_COLUMNS), measured)
    say.paragraph(described() or "Nothing is measured yet: python -m benchmarks.rates --write")
    say("Published shares", bold=True)
    for what, share, interval, loops, source, kind, ours in published_rows():
        say.paragraph(f"{what}: {share} ({interval}) of {loops}; {source}; {kind}. Ours: {ours}.", "  - ")
    for row in rows:
        say(f"{row[0]}: {row[1]}", bold=True)
        for column, cell in zip(CARD_COLUMNS[2:], row[2:], strict=True):
            say.paragraph(cell, f"  {column}: ")
    by_method = {row[1]: row for row in measured}
    columns = (*CARD_COLUMNS, *RATE_COLUMNS[3:])
    whole = [[*row, *by_method[row[0]][3:]] for row in rows]
    if csv_file is not None:
        write_whole(csv_file, csv_text(columns, whole).encode())
        say(f"table: {csv_file}")
    if html is not None:
        from stickslip.commands.report.page import Section, page, table_to_html

        sections = [
            Section("Outline of methods", "thesis table 2.1", "open", "",
                    figures=[table_to_html(OUTLINE_COLUMNS, outline_rows())]),
            Section("Measured", "thesis table 2.2", "open", described(),
                    figures=[table_to_html(RATE_COLUMNS, measured)]),
            Section("Published shares", "printed or second hand", "open", "",
                    figures=[table_to_html(PUBLISHED_COLUMNS, published_rows())]),
            Section("Cards", "what each reads, assumes, finds", "open", "",
                    figures=[table_to_html(CARD_COLUMNS, rows)]),
        ]  # fmt: skip
        write_whole(html, page("Detection methods", "", sections).encode())
        say(f"page: {html}")
    say.document({"schema": SCHEMA, "methods": [dict(zip(columns, row, strict=True)) for row in whole]})

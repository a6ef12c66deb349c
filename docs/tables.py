"""Write the tables of the methods' pages again, from the cards and what was measured: ``python docs/tables.py``."""

import re
from collections.abc import Sequence
from pathlib import Path

from stickslip.detect import cards
from stickslip.detect.rates import described

PAGES = [Path(__file__).parent / "methods.md", Path(__file__).parent / "evidence" / "methods_measured.md"]


def markdown(columns: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A table in Markdown.

    >>> print(markdown(["a"], [["b|c"]]))
    | a |
    |---|
    | b\\\\|c |
    """
    lines = [columns, *rows]
    shown = [f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in line)} |" for line in lines]
    return "\n".join([shown[0], "|" + "---|" * len(columns), *shown[1:]])


def tables() -> dict[str, str]:
    """Every table of the page by its name."""
    return {
        "outline": markdown(cards.OUTLINE_COLUMNS, cards.outline_rows()),
        "rates": f"{markdown(cards.RATE_COLUMNS, cards.rate_rows())}\n\n{described()}",
        "published": markdown(cards.PUBLISHED_COLUMNS, cards.published_rows()),
    }


def rewritten(page: str) -> str:
    """The page with every table between ``<!-- NAME -->`` and ``<!-- end -->`` as it is now.

    Raises KeyError for a table of another name.
    """
    now = tables()

    def put(found: re.Match[str]) -> str:
        return f"<!-- {found[1]} -->\n{now[found[1]]}\n<!-- end -->"

    return re.sub(r"<!-- (\w+) -->\n.*?<!-- end -->", put, page, flags=re.S)


if __name__ == "__main__":
    for page in PAGES:
        page.write_text(rewritten(page.read_text()))

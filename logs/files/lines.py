"""Lines of a text file: comments, titles above the header, blank rows, and what stands below the data."""

from __future__ import annotations

import csv
import re
from collections import Counter

from stickslip.logs.errors import ReadError

__all__ = ["LINE_END", "LOOK_LINES", "cells_of", "numbered_lines", "width_of", "without_frame"]

Numbered = list[tuple[int, str]]

LOOK_LINES = 200  # lines looked at to find the separator and the header
_HEADER_LINES = 40  # lines among which a header may have cells of several lines
_CELL_LINES = 4  # lines of a cell
LINE_END = "\u2028"  # stands for a line end inside a cell
_FOOTER = 10  # lines below the data
_FIGURES = re.compile(r"^[-+]?[\d.,:/ -]+$")


def numbered_lines(text: str) -> tuple[Numbered, list[str], str | None]:
    """The lines with their numbers, the comments, and the separator that the file names itself ("sep=;").

    >>> numbered_lines("# plant 3\\nsep=;\\n\\ntime;PV\\n0;1\\n")
    ([(4, 'time;PV'), (5, '0;1')], ['plant 3'], ';')
    """
    comments: list[str] = []
    numbered: Numbered = []
    hint = None
    lines = text.split("\n")
    i = 0
    while i < len(lines):
        number, line = i + 1, lines[i]
        i += 1
        if number <= _HEADER_LINES and not line.startswith("#") and line.count('"') % 2:
            line, i = _closed(lines, i - 1)
        if line.startswith("#"):
            comments.append(line[1:].strip())
        elif not numbered and re.match(r"sep=.$", line):
            hint = hint or line[4]
        elif line.strip():
            numbered.append((number, line))
    return numbered, comments, hint


def _closed(lines: list[str], first: int) -> tuple[str, int]:
    """The line with the next ones to which a cell in quotation marks runs on, and the index behind it.

    Such is "FIC101.PV" with the unit below it in a spreadsheet's header. A mark that stays open, as in 5" valve, is
    left alone.
    """
    for stop in range(first + 2, min(first + _CELL_LINES, len(lines)) + 1):
        whole = LINE_END.join(lines[first:stop])
        if whole.count('"') % 2 == 0:
            return whole, stop
    return lines[first], first + 1


def width_of(line: str, separator: str) -> int:
    """The number of cells in a line."""
    if '"' not in line:
        return line.count(separator) + 1
    return len(next(csv.reader([line], delimiter=separator)))


def cells_of(number: int, line: str, separator: str) -> list[str]:
    """The cells of a line. Raises ReadError for a quotation mark that is not closed."""
    try:
        return next(csv.reader([line], delimiter=separator, strict=True))
    except (csv.Error, StopIteration):
        raise ReadError(f"line {number} has a quotation mark that is not closed; mend the line") from None


def without_frame(numbered: Numbered, separator: str, notes: list[str]) -> Numbered:
    """The header and the rows: without titles above, rows of blank cells, and a footer or a row that breaks off."""
    filled = [(number, line) for number, line in numbered if line.strip(f'{separator} \t"')]
    if len(filled) < len(numbered):
        count = len(numbered) - len(filled)
        notes.append(f"{count} row{'s' * (count > 1)} of blank cells passed over.")
    return _without_footer(_without_titles(filled, separator, notes), separator, notes)


def _without_titles(numbered: Numbered, separator: str, notes: list[str]) -> Numbered:
    """Drop title lines above the header: lines of one cell, narrower by two and more, or filled up with blank cells."""
    widths = [width_of(line, separator) for _, line in numbered[:LOOK_LINES]]
    if not widths:
        return numbered
    usual = Counter(widths).most_common(1)[0][0]
    # One cell short is a header without the separator that ends every row.
    narrow = [width < usual - 1 or (width == 1 < usual) for width in widths]
    first = narrow.index(False) if False in narrow else 0
    first += _padded_titles([line for _, line in numbered[first:LOOK_LINES]], separator)
    if first:
        notes.append(f"{first} line{'s' * (first > 1)} above the header passed over.")
    return numbered[first:]


def _padded_titles(lines: list[str], separator: str) -> int:
    """How many lines a spreadsheet has filled up with blank cells stand above a full line of words."""
    reach = [width_of(line.rstrip(f"{separator} \t"), separator) for line in lines]
    if not reach:
        return 0
    usual = Counter(reach).most_common(1)[0][0]
    first = next((i for i, width in enumerate(reach) if width >= usual), 0)
    header = [cell.strip(' "') for cell in lines[first].split(separator)]
    if not first or any(_FIGURES.match(cell) for cell in header):
        return 0
    named = [cell for cell in header if cell]
    # "PV, OP, PV, OP" cannot do without the row of tags above it; a title stands in the first cell, a tag above its PV.
    above = [cell.strip(' "') for cell in lines[first - 1].split(separator)]
    return first - 1 if len(set(named)) < len(named) or not above[0] else first


def _without_footer(numbered: Numbered, separator: str, notes: list[str]) -> Numbered:
    """Drop lines below the data that are narrower than all above: the end of a report, or a row that breaks off."""
    if len(numbered) < 4:
        return numbered
    usual = Counter(width_of(line, separator) for _, line in numbered[1:]).most_common(1)[0][0]
    stop = len(numbered)
    while stop > 3 and len(numbered) - stop <= _FOOTER and width_of(numbered[stop - 1][1], separator) < usual:
        stop -= 1
    dropped = numbered[stop:]
    if not dropped or len(dropped) > _FOOTER:
        return numbered
    several = len(dropped) > 1
    which = f"The last {len(dropped)} lines have" if several else "The last line has"
    passed = "are passed over" if several else "is passed over"
    notes.append(f"{which} fewer cells than the rows and {passed}: {dropped[0][1][:40]!r}.")
    return numbered[:stop]

"""From text to a table of text cells: comments, separator, header, units row, ragged rows."""

from __future__ import annotations

import io
import re
from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING

from stickslip.logs.errors import ReadError
from stickslip.logs.files.headers import with_tag_row, without_repeats, without_twins
from stickslip.logs.files.lines import LOOK_LINES, cells_of, numbered_lines, width_of, without_frame
from stickslip.logs.files.pairs import is_paired, long_from_pairs, numbered_pairs, with_times_named
from stickslip.logs.files.size import check_columns
from stickslip.logs.files.states import is_blank, is_state
from stickslip.logs.files.time_names import is_date_name, is_time_name

if TYPE_CHECKING:
    import polars as pl

__all__ = ["PLAIN_UNIT", "Table", "names_and_units", "parse_table", "split_unit"]

_SEPARATORS = (";", "\t", "|", ",", " ")
_SEPARATOR_NAMES = {";": "semicolon", "\t": "tab", "|": "bar", ",": "comma", " ": "space"}
_WORD_ROWS, _LONGEST_UNIT = 4, 20  # rows of words under a header; a longer word is a description
_NUMBER = re.compile(r"^[-+]?(\d+([.,]\d*)?|[.,]\d+)([eE][-+]?\d+)?$")
_STAMP = re.compile(
    r"\d{1,4}[-/. ](\d{1,2}|[A-Za-z]{3,9})[-/. ,]+\d{1,4}|\d{1,2}:\d{2}|^\d{8}[T ]?\d{4}|^\d{4}\s?[年년]"
)
_UNIT = re.compile(r"^(?P<name>.*\S)\s*(?:[\[(](?P<unit>[^\[\]()]{0,20})[\])]|\u2028(?P<below>.{0,20}))$")
# Behind a space and without brackets only what can be nothing else.
PLAIN_UNIT = r"%|°[CF]|m?barg?|[kM]?Pa|psig?|mA|(?:m3|m³|Nm3|k?g|t|l)/(?:h|min|s|d)"
_BARE_UNIT = re.compile(rf"^(?P<name>.*\S)\s+(?P<unit>{PLAIN_UNIT})$")


@dataclass(frozen=True)
class Table:
    """Columns as they stand in the file.

    Attributes: ``frame`` (polars.DataFrame) One column a name; text cells (or typed ones from Parquet), missing cells
    null; ``lines`` (sequence of int) Line of the file each row comes from, counted from 1; ``units`` (dict) Unit of a
    column, where the header says so; ``comments`` (tuple of str) Comment lines without their '#'; ``notes`` (tuple of
    str) What was assumed.
    """

    frame: pl.DataFrame
    lines: list[int]
    units: dict[str, str]
    comments: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()


def split_unit(header: str) -> tuple[str, str]:
    """A header cell as name and unit.

    >>> split_unit("FIC211.PV [m3/h]"), split_unit("OP (%)"), split_unit("PV")
    (('FIC211.PV', 'm3/h'), ('OP', '%'), ('PV', ''))
    """
    found = _UNIT.match(header.strip()) or _BARE_UNIT.match(header.strip())
    return (found["name"], next(filter(None, found.groups()[1:]), "").strip("[]() ")) if found else (header.strip(), "")


def parse_table(text: str, separator: str | None = None, *, split_units: bool = True) -> Table:
    """The table in ``text``.

    Parameters: ``text`` (str) Lines ended by "\\n"; lines that start with '#' are comments, empty lines are passed
    over; ``separator`` (str, optional) One character between cells; found from the first lines when not given;
    ``split_units`` (bool) Take "[unit]" and "(unit)" off the header cells.

    Raises ReadError if there is no header, no row, one column only, a name repeated over other values, or a ragged row.

    >>> table = parse_table("time;OP\\ns;%\\n0;50,5\\n1;51\\n")
    >>> table.units, table.frame["OP"].to_list(), table.lines
    ({'time': 's', 'OP': '%'}, ['50,5', '51'], [3, 4])
    """
    if separator is not None and len(separator) != 1:
        raise ReadError(f"separator = {separator!r} is not one character; give for example ';'")
    numbered, comments, hint = numbered_lines(text)
    separator = separator or hint
    notes: list[str] = []
    chosen = separator or _find_separator([line for _, line in numbered[:LOOK_LINES]] or [""])
    if chosen == " ":
        numbered = [(number, "\t".join(line.split())) for number, line in numbered]
        chosen = "\t"
    numbered = without_frame(numbered, chosen, notes)
    if not numbered:
        raise ReadError("the file has no header and no rows, only blank or comment lines; export it again")
    header = [cell.strip() for cell in cells_of(*numbered[0], chosen)]
    check_columns(len(header))
    rows = numbered[1:]
    if not rows:
        raise ReadError(f"the file has a header ({', '.join(header)}) and no rows; export a range that holds data")
    header, rows = _without_trailing_separator(header, rows, chosen)
    if split_units and not all(header):
        header = with_times_named(header, [cell.strip() for cell in cells_of(*rows[0], chosen)])
    paired = split_units and is_paired(header)
    if paired:
        header = numbered_pairs(header)
    if split_units:
        header, rows = with_tag_row(header, rows, chosen, notes)
    _check_header(header, numbered[0][0], "" if separator else chosen)
    _check_widths(rows, len(header), chosen)
    header, twins = without_repeats(header)
    names, units = names_and_units(header) if split_units else (header, {})
    if split_units:
        rows = _without_word_rows(rows, names, units, chosen, notes)
    body, lines = "\n".join(line for _, line in rows).encode("utf-8"), [n for n, _ in rows]
    del text, numbered, rows  # a third of the memory that a long file takes
    frame = _frame(names, body, len(lines), chosen)
    frame = without_twins(frame, dict(zip(header, names, strict=True)), twins, notes)
    if paired:
        frame, lines = long_from_pairs(frame, lines)
        notes.append("Every signal has a time of its own.")
    return Table(frame, lines, units, tuple(comments), tuple(notes))


def _find_separator(lines: list[str]) -> str:
    """The separator that cuts most lines into the same number (> 1) of cells; the earlier one on a tie.

    A semicolon goes before a comma since with ';' the comma is usually the decimal mark.
    """
    best, best_share = "", 0.0
    for candidate in _SEPARATORS:
        widths = Counter(len(line.split()) if candidate == " " else width_of(line, candidate) for line in lines)
        width, count = widths.most_common(1)[0]
        share = count / len(lines)
        # Spaces stand in time stamps and titles: they count only when nothing else cuts the lines.
        fits = share > best_share if candidate != " " else share == 1.0 and not best
        if width > 1 and fits:
            best, best_share = candidate, share
    return best or ","


def _without_trailing_separator(
    header: list[str], rows: list[tuple[int, str]], separator: str
) -> tuple[list[str], list[tuple[int, str]]]:
    """Undo a separator at the end of every row, which some exports write, with or without it in the header."""
    if not all(line.rstrip(" ").endswith(separator) for _, line in rows):
        return header, rows
    width = width_of(rows[0][1], separator)
    if header[-1] == "" and len(header) == width:
        header = header[:-1]
    elif len(header) != width - 1:
        return header, rows
    return header, [(number, line.rstrip(" ")[:-1]) for number, line in rows]


def _check_header(header: list[str], number: int, guessed: str) -> None:
    """``guessed`` is the separator, "" where it is stated: then it needs no word."""
    if len(header) == 1:
        raise ReadError(
            f"the file has only one column ({header[0][:60]!r}); a record needs a time and a signal, "
            "give the separator (--separator) if it is not found"
        )
    if all(_NUMBER.match(cell) or _STAMP.search(cell) or is_blank(cell) for cell in header):
        raise ReadError(
            f"line {number} is numbers ({', '.join(header)[:60]}) where a header with names is expected; "
            "add a line of column names at the top"
        )
    empty = [str(i + 1) for i, cell in enumerate(header) if not cell and i > 0]
    if empty:
        cut = f" (separator: {_SEPARATOR_NAMES.get(guessed, guessed)})" if guessed else ""
        raise ReadError(
            f"column {', '.join(empty)} has no name in the header on line {number}{cut}; name it or delete it"
        )


def _check_widths(rows: list[tuple[int, str]], width: int, separator: str) -> None:
    for number, line in rows:
        cells = len(cells_of(number, line, separator)) if '"' in line else line.count(separator) + 1
        if cells != width:
            hint = ""
            if separator == "," and cells > width:
                hint = "; if ',' is the decimal mark, separate the cells with ';'"
            raise ReadError(
                f"line {number} has {cells} cells where the header has {width}{hint}; mend the line: {line[:60]!r}"
            )


def names_and_units(header: list[str]) -> tuple[list[str], dict[str, str]]:
    """The names of a header without their units, and the unit of a name that has one.

    >>> names_and_units(["time [s]", "PV (m3/h)", "OP"])
    (['time', 'PV', 'OP'], {'time': 's', 'PV': 'm3/h'})
    """
    pairs = [split_unit(cell) for cell in header]
    bare = [name for name, _ in pairs]
    if len(set(bare)) < len(bare):
        return header, {}  # "PV (raw)" and "PV (filtered)" are names, not units
    # A spreadsheet's index column has no name: it is the time, or the number of the row where there is a time.
    nameless = "row" if any(is_time_name(name) or is_date_name(name) for name in bare) else "time"
    names = [name or nameless for name in bare]
    if len(set(names)) < len(names):
        names = bare
    return names, {name: unit for name, (_, unit) in zip(names, pairs, strict=True) if unit}


def _without_word_rows(
    rows: list[tuple[int, str]], names: list[str], units: dict[str, str], separator: str, notes: list[str]
) -> list[tuple[int, str]]:
    """The rows without descriptions and units under the header; units, the last such row of short words, are kept."""
    first = 0
    while first < len(rows) and first < _WORD_ROWS:
        row = [cell.strip() for cell in cells_of(*rows[first], separator)]
        if not _is_words_row(row):
            break
        if max(map(len, row)) <= _LONGEST_UNIT:
            units |= {name: cell.strip("[]() ") for name, cell in zip(names, row, strict=True) if cell}
        else:
            notes.append(f"Line {rows[first][0]} holds words, not data, and is passed over.")
        first += 1
    if first == len(rows):
        raise ReadError("the file has a header and a row of units and no rows of data; export it again")
    return rows[first:]


def _is_words_row(row: list[str]) -> bool:
    """Whether a row under the header holds words only: no number, no stamp, no state."""
    filled = [cell for cell in row if cell]
    if not filled or any(_NUMBER.match(cell) or _STAMP.search(cell) for cell in filled):
        return False
    return not any(is_state(cell) or (is_blank(cell) and cell != "-") for cell in filled)


def _frame(names: list[str], body: bytes, rows: int, separator: str) -> pl.DataFrame:
    import polars as pl

    plain = [str(i) for i in range(len(names))]  # polars takes a name such as "^a.*$" for a pattern
    try:
        frame = pl.read_csv(
            io.BytesIO(body),
            has_header=False,
            new_columns=plain,
            schema_overrides=[pl.String] * len(names),
            infer_schema=False,
            separator=separator,
            truncate_ragged_lines=False,
        )
    except pl.exceptions.PolarsError as fault:
        raise ReadError(f"the rows cannot be cut into cells ({fault}); mend the file") from None
    if frame.shape != (rows, len(names)):
        raise ReadError(
            f"{rows} lines give {frame.height} rows of {frame.width} cells; look for quotation marks inside cells"
        )
    frame = frame.with_columns(pl.all().str.strip_chars())
    frame.columns = names
    return frame

"""Text cells to numbers: decimal marks, digital states, blanks."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt
from stickslip.logs.errors import ReadError
from stickslip.logs.files.placeholders import placeholders
from stickslip.logs.files.states import is_blank, is_state
from stickslip.logs.modes import MANUAL, mode_number, says_manual

if TYPE_CHECKING:
    import polars as pl

__all__ = ["Numbers", "decimal_mark", "modes", "numbers"]

# Between the thousands stand a comma or point, whichever is not the decimal mark, an apostrophe or a space of any kind.
_OTHER = {".": ",", ",": r"\."}
_GAP = r"'’\s\u00a0\u202f"
LARGEST = 1e100  # no measurement is larger, and the squares of larger numbers are infinite; 1 / LARGEST is 0
_HEAD_COLUMNS = 500  # looked at for the decimal mark


@dataclass(frozen=True)
class Numbers:
    """Values of a column, NaN where missing, True in ``good`` unless a state said why there is no number."""

    values: npt.NDArray[np.float64]
    good: npt.NDArray[np.bool_] | None
    notes: tuple[str, ...] = ()


def decimal_mark(frame: pl.DataFrame) -> str:
    """ "," if the number cells of the frame are written with decimal commas, else ".".

    >>> import polars as pl
    >>> decimal_mark(pl.DataFrame({"PV": ["1,5", "2,25"]}))
    ','
    """
    import polars as pl

    head = frame.head(1000)
    if head.width > _HEAD_COLUMNS:
        head = head[:, :: head.width // _HEAD_COLUMNS]
    text = head.select(pl.col(pl.String))  # all at once: one by one each takes a tenth of a millisecond

    def cells(form: str) -> int:
        return sum(text.select(pl.all().str.contains(form).sum()).row(0)) if text.width else 0

    commas = cells(r"^[-+]?(\d*|\d{1,3}(\.\d{3})+),\d+([eE][-+]?\d+)?$")
    points = cells(r"^[-+]?(\d*|\d{1,3}(,\d{3})+)\.\d+([eE][-+]?\d+)?$")
    return "," if commas > points else "."


def numbers(
    column: pl.Series, name: str, lines: list[int], decimal: str = ".", *, keep_infinite: bool = False
) -> Numbers:
    """The numbers of ``column``.

    Blank cells are missing; known digital states ("Bad Input") are missing and of bad quality, and so is
    "inf" unless ``keep_infinite`` says that it was meant.
    Raises ReadError naming line, column and text for any other text.

    >>> import polars as pl
    >>> numbers(pl.Series(["1.5", "Bad Input", ""]), "PV", [2, 3, 4]).notes
    ("PV: 1 cell says 'Bad Input': missing, of bad quality.", 'PV: 1 cell is blank: missing.')
    """
    import polars as pl

    if column.dtype == pl.Boolean or column.dtype.is_numeric():
        values = column.cast(pl.Float64).to_numpy().astype(np.float64)
        return Numbers(values, None) if keep_infinite else _within_reach(values, name)
    if column.dtype.is_temporal():
        raise ReadError(f"column {name!r} holds times, not numbers; name another column")
    if column.dtype != pl.String:
        raise ReadError(f"column {name!r} holds {column.dtype}, not numbers; name another column")
    text = column.alias("")
    text = text.fill_null("") if text.null_count() else text
    if decimal == ".":  # marks between thousands are then no numbers, so that one look is enough
        plainly = text.cast(pl.Float64, strict=False)
        values = plainly.to_numpy().astype(np.float64)
        if np.isfinite(values).all():
            if keep_infinite:
                return Numbers(values, None)
            near = _within_reach(values, name)
            return Numbers(near.values, near.good, (*_doubtful_mark(text, decimal, name), *near.notes))
    notes = [] if keep_infinite else _doubtful_mark(text, decimal, name)
    grouped = _grouped(text, decimal)
    if grouped.any():
        notes.append(f"{name}: '{text.filter(grouped)[0]}' and the like are read with a mark between the thousands.")
        text = text.str.replace_all(rf"[{_OTHER[decimal]}{_GAP}]", "").zip_with(grouped, text)
    plain = text.str.replace(",", ".", literal=True) if decimal == "," else text
    parsed = plain.cast(pl.Float64, strict=False)
    values = parsed.fill_null(float("nan")).to_numpy().astype(np.float64)
    good = np.ones(len(values), dtype=bool)
    # Only the distinct words are looked at one by one: there are few, however long the file.
    is_value = ~parsed.is_nan() if keep_infinite else parsed.is_finite()
    words = text.filter(~is_value.fill_null(False)).value_counts(sort=True, name="rows")
    blanks = 0
    for word, count in words.iter_rows():
        if is_blank(word):
            blanks += count
            continue
        where = (text == word).to_numpy()
        if not is_state(word):
            row = int(np.argmax(where))
            raise ReadError(
                f"line {lines[row]}, column {name!r}: {word[:40]!r} is not a number; mend the cell or give the "
                f"decimal mark (now {decimal!r})"
            )
        values[where] = np.nan
        good &= ~where
        notes.append(f"{name}: {count} {_says(count)} {word!r}: missing, of bad quality.")
    if blanks:
        notes.append(f"{name}: {blanks} {'cell is' if blanks == 1 else 'cells are'} blank: missing.")
    near = Numbers(values, None) if keep_infinite else _within_reach(values, name)
    good &= True if near.good is None else near.good
    return Numbers(near.values, None if good.all() else good, (*notes, *near.notes))


def _within_reach(values: npt.NDArray[np.float64], name: str) -> Numbers:
    """The values without those that are not finite, larger than any measurement or a word in numbers, and notes."""
    size = np.abs(values)
    huge = np.isfinite(values) & (size > LARGEST)
    kept = np.where(np.isfinite(values) & ~huge, values, np.nan)
    kept = np.where(size < 1.0 / LARGEST, 0.0, kept)
    notes = []
    if huge.any():
        count = int(huge.sum())
        which = "1 value is" if count == 1 else f"{count} values are"
        notes.append(f"{name}: {which} beyond {LARGEST:g}: missing, for no measurement is as large.")
    good = np.ones(len(kept), dtype=bool)
    for number, count, sure in placeholders(kept):
        said = f"{name}: {count} value{'s are' if count > 1 else ' is'} {number:.10g}, far outside the others"
        if not sure:
            notes.append(f"{said}: kept, for it may be measured; if the system writes this where nothing is, blank it.")
            continue
        good &= kept != number
        notes.append(f"{said}: missing, of bad quality, for systems write this where they have no number.")
    return Numbers(np.where(good, kept, np.nan), None if good.all() else good, tuple(notes))


def _grouped(text: pl.Series, decimal: str) -> pl.Series:
    """Which cells have a mark between the thousands: never "0.125", nor where that mark stands elsewhere too."""
    mark = "," if decimal == "," else r"\."
    other = _OTHER[decimal]
    elsewhere = text.str.contains(rf"^[-+]?\d*{other}(\d{{0,2}}|\d{{4,}})$").any()
    marks = _GAP if elsewhere else other + _GAP
    return text.str.contains(rf"^[-+]?[1-9]\d{{0,2}}([{marks}]\d{{3}})+({mark}\d*)?$")


def _doubtful_mark(text: pl.Series, decimal: str, name: str) -> list[str]:
    """A sentence on cells such as 1.500 beside whole numbers: their mark may as well stand between thousands."""
    mark = "," if decimal == "," else r"\."
    head = text.head(1000)
    if head.str.contains(rf"{mark}(\d{{0,2}}|\d{{4,}})$").any():  # nearly every column
        return []
    doubtful = text.str.contains(rf"^[-+]?[1-9]\d{{0,2}}{mark}\d{{3}}$")
    if not doubtful.any() or not text.str.contains(r"^[-+]?\d+$").any():
        return []
    if (text.str.contains(rf"\d{mark}|{mark}\d") & ~doubtful).any():
        return []
    cell = text.filter(doubtful)[0]
    other = "." if decimal == "," else ","
    return [
        f"{name}: {cell!r} beside whole numbers is read as {float(cell.replace(',', '.')):g}; if the mark stands "
        f"between thousands, give decimal={other!r} (--decimal {other})."
    ]


def _says(count: int) -> str:
    return "cell says" if count == 1 else "cells say"


def modes(column: pl.Series, name: str) -> Numbers:
    """Controller modes as numbers (see ``stickslip.logs.modes``); a blank holds the mode before it.

    Numbers are taken as they are if they are 0, 1 or 2; other numbers differ from system to system and
    give NaN, unknown, throughout.

    >>> import polars as pl
    >>> modes(pl.Series(["MAN", "", "AUTO", "Bad Input"]), "MODE").values
    array([ 0.,  0.,  1., nan])
    """
    import polars as pl

    text = column.alias("").cast(pl.String).fill_null("")
    words = [word for word in text.unique().sort().to_list() if not is_blank(word)]
    figures = pl.Series(words, dtype=pl.String).cast(pl.Float64, strict=False)
    notes = []
    if figures.null_count() < len(words):  # at least one number among the words
        if figures.null_count() or not set(figures.to_list()) <= {0.0, 1.0, 2.0}:
            shown = ", ".join(sorted(words)[:6])
            note = f"{name}: the numbers {shown} are not known as modes: the mode is left out."
            return Numbers(np.full(len(text), np.nan), None, (note,))
        known = dict(zip(words, figures.to_list(), strict=True))
        notes.append(f"{name}: numbers are read as 0 manual, 1 automatic, 2 cascade.")
    else:
        # A state ends what was held before it: infinite here, unknown in the end.
        known = {word: np.inf if is_state(word) else mode_number(word) for word in words}
        odd = [w for w, mode in known.items() if mode == MANUAL and not says_manual(w)]
        if odd:
            notes.append(f"{name}: {', '.join(map(repr, odd[:5]))} counted as manual.")
    held = text.replace_strict(known, default=None, return_dtype=pl.Float64).forward_fill()
    values = held.fill_null(float("nan")).to_numpy()
    return Numbers(np.where(np.isinf(values), np.nan, values), None, tuple(notes))

"""Quality columns: whose quality they hold, and which of their codes mean good."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt
from stickslip.logs.files.names import plain, role_of
from stickslip.logs.files.states import is_blank, quality_is_good

if TYPE_CHECKING:
    import polars as pl

__all__ = ["CONFIDENT_PERCENT", "bad_values", "qualities", "quality_columns"]

CONFIDENT_PERCENT = 50.0  # % of confidence from which a value counts as good; PHD gives 100 to good and 0 to bad

_MOST_CODES = 40  # more different ones are measurements

_WORDS = ("statuscode", "qualitycode", "confidence", "opcquality", "qualitydetail", "quality", "qual", "status", "good")
_SHORT = ("conf", "stat", "sts", "st", "qc", "q", "validity", "valid", "ok")
_VALUES = ("", "cv", "value", "val")


def quality_columns(columns: Iterable[str]) -> dict[str, tuple[str, ...]]:
    """The columns that hold quality, each with the columns whose quality it is.

    "PV.ST" belongs to "PV" (or "PV.CV"), "FIC1.Quality" to all of FIC1, a bare "Quality" to every signal.

    >>> quality_columns(["FIC1.PV", "FIC1.PV.ST", "FIC1.OP"])
    {'FIC1.PV.ST': ('FIC1.PV',)}
    >>> quality_columns(["PV", "OP", "Quality"])
    {'Quality': ('PV', 'OP')}
    """
    names = list(columns)
    by_plain = {plain(name): name for name in names}
    by_loop: dict[str, list[str]] = {}
    for name in names:
        by_loop.setdefault(_loop_of(name), []).append(name)
    found: dict[str, tuple[str, ...]] = {}
    for name in names:
        targets = _targets(name, names, by_plain, by_loop)
        if targets:
            found[name] = targets
    return {
        name: kept
        for name, targets in found.items()
        if (kept := tuple(target for target in targets if target not in found))
    }


def _targets(name: str, names: list[str], by_plain: dict[str, str], by_loop: dict[str, list[str]]) -> tuple[str, ...]:
    folded = plain(name)
    if folded in _WORDS:
        return tuple(other for other in names if other != name)
    for word in (*_WORDS, *_SHORT):
        for rest in (folded.removesuffix(word), folded.removeprefix(word)):
            if rest == folded or not rest:
                continue
            for value in _VALUES:
                if rest + value in by_plain and by_plain[rest + value] != name:
                    return (by_plain[rest + value],)
            own = tuple(other for other in by_loop.get(rest, ()) if other != name)
            if own and word in _WORDS:  # a bare FIC1.Q may be a total
                return own
    return ()


def _loop_of(name: str) -> str:
    known = role_of(name)
    return plain(known[0]) if known else ""


def qualities(column: pl.Series, name: str = "", *, flags: bool = False) -> npt.NDArray[np.bool_] | None:
    """True for good, shape (n,); None if the codes cannot be recognised.

    Understood are words, 1 and 0, confidence in % (PHD: 100 good, 0 bad), OPC DA and Foundation Fieldbus codes (128
    and above good) and OPC UA status codes (below 2^30 good). A 0 is good in some systems and bad in others: with 1
    beside it, it is read as bad only if it is the rarer of the two, or if the column's name says what is good.
    With ``flags``, numbers are 1 and 0 and nothing else: zeros alone will do.

    >>> import polars as pl
    >>> qualities(pl.Series(["192", "0", "64"])).tolist(), qualities(pl.Series(["100", "100", "0"])).tolist()
    ([True, False, False], [True, True, False])
    >>> qualities(pl.Series(["0", "0", "1"]), "PV_status") is None
    True
    """
    import polars as pl

    text = column.alias("").cast(pl.String).fill_null("")
    blank = text.is_in(["", "nan", "NaN"])
    codes = _codes(text)
    if not blank.all() and (codes.is_not_null() | blank).all():
        good = _good_codes(codes.filter(~blank).to_numpy(), plain(name), flags=flags)
        if good is None:
            return None
        numbers = codes.fill_null(float("nan")).to_numpy()
        return np.asarray((numbers >= good[0]) & (numbers < good[1]))  # no code, NaN: not good
    verdicts = {word: quality_is_good(word) for word in text.unique().to_list()}
    if any(v is None and not is_blank(w) for w, v in verdicts.items()):
        return None
    return np.array([bool(verdicts[word]) for word in text.to_list()])


def _codes(text: pl.Series) -> pl.Series:
    """Codes as numbers, decimal or as 0xC0 and 16#80; null for words."""
    import polars as pl

    digits = text.str.extract(r"^(?:0[xX]|16#)([0-9A-Fa-f]{1,8})$")
    hexadecimal = digits.str.to_integer(base=16, strict=False).cast(pl.Float64)
    return text.cast(pl.Float64, strict=False).fill_null(hexadecimal)


def _good_codes(codes: npt.NDArray[np.float64], name: str, *, flags: bool) -> tuple[float, float] | None:
    """Good codes as a range low <= code < high; None if it cannot be recognised."""
    top = codes.max()
    if flags:
        return 1.0, 1.5
    if not np.isfinite(codes).all() or codes.min() < 0:
        return None
    if "conf" in name:
        return (CONFIDENT_PERCENT if top > 1 else CONFIDENT_PERCENT / 100.0), np.inf
    if (codes != np.floor(codes)).any() or len(np.unique(codes)) > _MOST_CODES:
        return None
    if top >= 2**30 or (name.endswith("statuscode") and top == 0):
        return 0.0, 2.0**30
    if top == 100:
        return CONFIDENT_PERCENT, np.inf
    if 64 <= top < 256 and not ((codes > 31) & (codes < 64)).any():
        return 128.0, np.inf
    if top == 1 and np.isin(codes, (0, 1)).all():
        says_good = name.endswith(("good", "ok", "valid"))
        # A bare "Status" of 0 and 1 may be that of a pump.
        if says_good or (name != "status" and np.mean(codes) >= 0.5):
            return 1.0, 1.5
    return None


def bad_values(name: str, column: str, good: npt.NDArray[np.bool_], values: npt.NDArray[np.float64]) -> list[str]:
    """The sentence on values that are there and of bad quality, none if all are good."""
    bad = int((~good & ~np.isnan(values)).sum())
    if not bad:
        return []
    limit = f" (below {CONFIDENT_PERCENT:g} %)" if "conf" in plain(column) else ""
    return [f"{name}: {bad} value{'s' * (bad > 1)} of bad quality by {column!r}{limit}."]

"""How a file is written: what a caller may state about it, in one place for all readers."""

from __future__ import annotations

from typing import TypedDict

from stickslip.logs.hint import nearest

__all__ = ["Form", "checked"]


class Form(TypedDict, total=False):
    """What a caller states about a table of signals over time; a reader finds out the rest.

    Parameters: ``time`` (str) Column of the time; ``decimal``, ``separator`` (str) Decimal mark and the character
    between cells; ``time_format`` (str) strptime format of the time stamps; ``interval`` (float) Seconds between rows
    [s], for files without a usable time; ``time_unit`` (str) Unit of a time of numbers, see ``read_log``.
    """

    time: str | None
    decimal: str | None
    separator: str | None
    time_format: str | None
    interval: float | None
    time_unit: str | None


def checked(form: Form) -> Form:
    """Return the form; raise TypeError for an argument that is none of it.

    >>> checked({"time_units": "s"})
    Traceback (most recent call last):
    ...
    TypeError: 'time_units' is no argument of a reader; did you mean 'time_unit'? known: time, decimal, separator, ...
    """
    for key in form:
        if key not in Form.__annotations__:
            raise TypeError(f"'{key}' is no argument of a reader; {nearest(key, Form.__annotations__)}")
    return form

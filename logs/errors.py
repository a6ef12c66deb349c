"""Errors of the package: each message gives the value, the rule it breaks and a remedy."""

from __future__ import annotations

__all__ = ["LogError", "ReadError"]


class LogError(ValueError):
    """A log or a loop record was built from, or asked for, something that does not fit.

    >>> from stickslip.logs import Log
    >>> Log(t=[0.0, 1.0, 1.0], signals={})
    Traceback (most recent call last):
    ...
    stickslip.logs.errors.LogError: time must increase strictly: t[2] = 1.0 s follows t[1] = 1.0 s; ...
    """


class ReadError(ValueError):
    """A file could not be read as a record of signals.

    >>> from stickslip.logs import read_log
    >>> read_log("no_such_file.csv")
    Traceback (most recent call last):
    ...
    stickslip.logs.errors.ReadError: no_such_file.csv: no such file; check the path and the name
    """

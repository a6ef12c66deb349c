"""The meaning of an instrument tag (ISA-5.1: the first letter is the measured variable)."""

from __future__ import annotations

import re
from typing import Literal

__all__ = ["Process", "measurement_in", "measurement_of", "process_of", "tag_in", "valve_in"]

Process = Literal["self_regulating", "integrating", "unknown"]

_MEASURED = {
    "F": "flow",
    "L": "level",
    "P": "pressure",
    "T": "temperature",
    "A": "analyser",
    "Q": "analyser",
}

_BY_UNIT = {
    "flow": ("m3/s", "m3/h", "kg/s", "kg/h", "t/h", "mol/s", "l/s", "l/min", "l/h", "nm3/h", "sm3/h", "gpm"),
    "level": ("m", "mm", "cm", "m3", "l"),
    "pressure": ("pa", "kpa", "mpa", "bar", "mbar", "barg", "bara", "bar(g)", "psi", "psig"),
    "temperature": ("k", "degc", "°c", "degf", "°f"),
    "speed": ("rad/s", "rpm", "1/min"),
}

# First letter, an optional modifier (difference, ratio, total), then the functions, then the number.
# AI and QI are left out: in most control systems they are analogue inputs, not analysers.
_TAG = re.compile(
    r"(?<![A-Za-z])(?P<tag>(?P<first>[FLPT])[DFQK]?[ICRTYV]{1,3}[-_ ]?\d+[A-Za-z]?(?![A-Za-z])"
    r"|(?P<quality>[AQ])(?:IC|RC|C|T|IT)[-_ ]?\d+[A-Za-z]?(?![A-Za-z]))",
    re.IGNORECASE,
)


def tag_in(text: str) -> str:
    """The first instrument tag found in ``text``, "" when there is none.

    >>> tag_in("12-FIC-211.PV"), tag_in("LIC31102B_20240823_2155"), tag_in("CHEM1")
    ('FIC-211', 'LIC31102B', '')
    """
    found = _TAG.search(text)
    return found["tag"] if found else ""


# What names of one loop's records end in: a date with or without a time of day, or the number of a day or part.
_RECORD = re.compile(
    r"[-_. ](?:(?:19|20)\d{2}[-_.]?\d{2}[-_.]?\d{2}(?:[-_ T.]?\d{2}[-_:.]?\d{2}(?:[-_:.]?\d{2})?)?"
    r"|(?:day|week|part|window|run)[-_ ]?\d+)$",
    re.IGNORECASE,
)


def valve_in(name: str) -> str:
    """The name of a record without the date or number at its end: what the records of one valve share.

    >>> [valve_in(name) for name in ("FIC46005_20240613_2155", "LOOP_day2", "FIC101", "CHEM10", "TIC-5 2024-01-31")]
    ['FIC46005', 'LOOP', 'FIC101', 'CHEM10', 'TIC-5']
    """
    return _RECORD.sub("", name)


def measurement_of(tag: str) -> str:
    """The measured variable by the first letter of the tag in ``tag``, "" when the letter says nothing.

    >>> [measurement_of(tag) for tag in ("FC145", "LIC106", "12-PIC-7", "TIC_1203A", "AC1", "PAP2")]
    ['flow', 'level', 'pressure', 'temperature', 'analyser', '']
    """
    found = _TAG.search(tag)
    if not found:
        return ""
    return _MEASURED[(found["first"] or found["quality"]).upper()]


def measurement_in(unit: str) -> str:
    """The measured variable by the unit of PV, "" when the unit says nothing; a content in m3 counts as a level.

    >>> [measurement_in(unit) for unit in ("Pa", "m3", "m3/h", "%", "")]
    ['pressure', 'level', 'flow', '', '']
    """
    plain = unit.strip().casefold()
    return next((name for name, units in _BY_UNIT.items() if plain in units), "")


def process_of(measurement: str) -> Process:
    """The usual kind of process behind a measurement: levels integrate, the others settle.

    >>> process_of("level"), process_of("flow"), process_of("")
    ('integrating', 'self_regulating', 'unknown')
    """
    if measurement == "level":
        return "integrating"
    return "self_regulating" if measurement else "unknown"

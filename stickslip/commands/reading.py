"""How the file of a command is written: options for its reader, and which column is which signal of a model."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import click

if TYPE_CHECKING:
    from stickslip.logs import Log

OPTIONS = (
    click.option("--time", metavar="COLUMN", help="Name of the time column."),
    click.option("--time-format", metavar="FORMAT", help="Format of the time stamps, e.g. '%d/%m/%y %H:%M:%S'."),
    click.option(
        "--time-unit", metavar="UNIT", help="Unit of a time of numbers: s, ms, us, ns, min, h, d, filetime, ..."
    ),
    click.option("--interval", type=float, metavar="SECONDS", help="Time between rows, for a file without time."),
    click.option("--separator", metavar="CHAR", help="Character between the cells, if the guess is wrong."),
    click.option("--decimal", metavar="CHAR", help="Decimal mark, '.' or ',', if the guess is wrong."),
)  # arguments of the readers in ``logs``, under the same names


KINDS = ["self_regulating", "integrating"]
COLUMNS = ("pv", "op", "sp", "loop", "process")  # what ``loop_options`` says of a loop


def form_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add the options that say how a file is written to a command."""
    for option in reversed(OPTIONS):
        command = option(command)
    return command


def loop_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add the options that say which columns are the loop's."""
    for option in reversed((
        click.option("--pv", metavar="COLUMN", help="Name of the measurement column."),
        click.option("--op", metavar="COLUMN", help="Name of the controller output column."),
        click.option("--sp", metavar="COLUMN", help="Name of the set point column."),
        click.option("--loop", metavar="TAG", help="Name of the loop, where a file holds several."),
        click.option("--process", type=click.Choice(KINDS), help="Kind of process, if known."),
        form_options,
    )):  # fmt: skip
        command = option(command)
    return command


def as_named(log: "Log", given: Sequence[str]) -> "Log":
    """Return a log whose columns are called as ``--signal NAME=COLUMN`` or ``NAME=FACTOR*COLUMN`` says.

    Raises ``ValueError`` for a text of another form, a column that the log does not have, and a name that is taken.

    >>> from stickslip.logs import Log
    >>> log = as_named(Log(t=[0, 1], signals={"FC101.OP": [50, 60]}), ["OP=0.01*FC101.OP"])
    >>> log.names, log["OP"].tolist()
    (('OP',), [0.5, 0.6])
    """
    names: dict[str, str] = {}
    factors: dict[str, float] = {}
    for text in given:
        name, _, column = (part.strip() for part in text.partition("="))
        factor, column = _parted(column)
        if not name or not column:
            raise ValueError(f"--signal {text}: give NAME=COLUMN or NAME=FACTOR*COLUMN, e.g. OP=0.01*FC101.OP")
        if column in names:
            raise ValueError(f"--signal {text}: {column} is {names[column]} already; give each column once")
        names[column], factors[name] = name, factor
    log = log.renamed(names)
    scaled = {name: factor for name, factor in factors.items() if factor != 1.0}
    return replace(
        log,
        signals={name: scaled.get(name, 1.0) * values for name, values in log.signals.items()},
        units={name: unit for name, unit in log.units.items() if name not in scaled},
        spans={name: span for name, span in log.spans.items() if name not in scaled},
    )


def _parted(column: str) -> tuple[float, str]:
    """Return the factor and the name of a column; a name may hold a star of its own."""
    before, star, after = column.partition("*")
    try:
        return (float(before), after.strip()) if star else (1.0, column)
    except ValueError:
        return 1.0, column

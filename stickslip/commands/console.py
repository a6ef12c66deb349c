"""Output of every command: words to the right stream, one JSON document, errors without tracebacks."""

import json
import os
import shutil
import sys
import textwrap
import traceback
import unicodedata
from collections.abc import Callable
from functools import wraps
from pathlib import Path
from typing import Any

import click

from stickslip.commands.targets import write_whole

COLOUR_OF = {"bad": "red", "good": "green", "open": "yellow"}  # in a terminal, by the kind of what is said
PIPED, WORD = 120, 14  # columns of a table that no terminal shows; letters of a word that a table does not cut
LONGEST_MESSAGE = 1500  # a header of a million columns must not flood the terminal

json_option = click.option(
    "--json", "json_file", metavar="FILE", help="Also write one JSON document to FILE ('-': standard output, alone)."
)


class Speaker:
    """Prints for people; steps aside to standard error when standard output carries the JSON document.

    A reader that has seen enough (``| head -1``) is no fault: the rest is not printed, and the command goes on to
    its files and to the exit code that its result has.
    """

    def __init__(self, json_file: str | None) -> None:
        self.json_file = json_file
        self.to_error = json_file == "-"

    def __call__(self, text: str = "", *, nl: bool = True, **style: Any) -> None:
        text = plain(text)
        self._out((click.style(text, **style) if style else text) + "\n" * nl, self.to_error)

    def paragraph(self, text: str, bullet: str = "") -> None:
        """Print a text wrapped at words, under a bullet if one is given."""
        width = min(100, shutil.get_terminal_size().columns)
        self(textwrap.fill(text, width, initial_indent=bullet, subsequent_indent="    " if bullet else ""))

    def table(self, columns: list[str], rows: list[list[str]]) -> None:
        """Print a table, cells as they stand."""
        from rich.console import Console
        from rich.table import Table

        table = Table(header_style="bold")
        for k, column in enumerate(columns):  # words are not cut, but for very long ones
            words = [word for row in (columns, *rows) for word in row[k].split()]
            table.add_column(column, overflow="fold", min_width=min(max(map(len, words), default=1), WORD))
        for row in rows:
            table.add_row(*map(plain, row))
        # Markup off: "[s]" is a unit here, and names come from the user's file.
        stream = sys.stderr if self.to_error else sys.stdout
        width = None if stream.isatty() else PIPED
        console = Console(file=stream, markup=False, emoji=False, highlight=False, width=width)
        with console.capture() as drawn:  # printed by us: rich would end the process when the reader has gone
            console.print(table)
        self._out(drawn.get(), self.to_error)

    def document(self, content: dict[str, Any]) -> None:
        """Write the JSON document where it was asked for, if it was."""
        if self.json_file is None:
            return
        text = json.dumps(content, indent=2, allow_nan=False, ensure_ascii=False) + "\n"
        if self.to_error:
            self._out(text.encode(), False)  # bytes: JSON is UTF-8 whatever the terminal's encoding
        else:
            write_whole(Path(self.json_file), text.encode())

    def _out(self, text: str | bytes, to_error: bool) -> None:
        try:
            click.echo(text, nl=False, err=to_error, color=coloured())
        except BrokenPipeError:
            _leave_unread(sys.stderr if to_error else sys.stdout)


def coloured() -> bool | None:
    """Whether to colour: never when ``NO_COLOR`` is set and not empty (no-color.org), else on terminals only."""
    return False if os.environ.get("NO_COLOR") else None


def plain(text: str) -> str:
    """Return a text without control characters of a terminal: names come from files that nobody has checked.

    >>> plain("tag\\x1b[2J"), plain("two\\nlines")
    ('tag?[2J', 'two\\nlines')
    """
    return "".join("?" if unicodedata.category(sign) == "Cc" and sign not in "\n\t" else sign for sign in text)


def _leave_unread(stream: Any) -> None:
    """Send what is still to be written to nowhere, or Python would complain of the closed pipe at its end."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, stream.fileno())
    os.close(nowhere)


def user_errors(command: Callable[..., Any]) -> Callable[..., Any]:
    """Turn mistakes of the caller (``ValueError``, ``OSError``) into one message and exit code 2.

    Our own defects become one message, too, because Python's exit code for them, 1, would say "stiction found".
    """

    @wraps(command)
    def wrapped(*args: Any, **kwargs: Any) -> Any:
        try:
            return command(*args, **kwargs)
        except click.ClickException:
            raise  # click says it well itself, with exit code 2
        except BrokenPipeError:  # the reader, e.g. ``head``, has seen enough
            _leave_unread(sys.stdout)
            raise SystemExit(0) from None
        except KeyboardInterrupt:
            complain("stopped by the keyboard")
            raise SystemExit(130) from None
        except OSError as error:
            complain(f"{error.filename}: {error.strerror}" if error.filename else str(error))
        except ValueError as error:
            complain(str(error))
        except MemoryError as error:
            complain(f"not enough memory ({error}); ask for less at a time")
        except Exception as error:
            where = traceback.extract_tb(error.__traceback__)[-1]
            fault = f"{type(error).__name__}: {error} ({Path(where.filename).name}, line {where.lineno})"
            blame = "this is a defect of stickslip, not of your input; please report it with the command you gave"
            complain(f"{blame}: {fault}")
        raise SystemExit(2)

    return wrapped


def complain(message: str) -> None:
    """Print one error message, shortened in the middle if it is huge."""
    if len(message) > LONGEST_MESSAGE:
        message = f"{message[: LONGEST_MESSAGE - 300]} ... {message[-250:]}"
    message = plain(message)
    try:
        click.secho(f"Error: {message}", fg="red", err=True, color=coloured())
    except BrokenPipeError:
        _leave_unread(sys.stderr)

"""What every command shares: words to the right stream, one JSON document, errors without tracebacks."""

import json
import os
import shutil
import sys
import textwrap
import traceback
from collections.abc import Callable
from functools import wraps
from pathlib import Path
from typing import Any

import click

from stickslip.standard import hidden
from stickslip.targets import write_whole

LONGEST_MESSAGE = 1500  # a header of a million columns must not flood the terminal

json_option = click.option(
    "--json", "json_file", metavar="FILE", help="Also write one JSON document to FILE ('-': standard output, alone)."
)


class Speaker:
    """Prints for people; steps aside to standard error when standard output carries the JSON document."""

    def __init__(self, json_file: str | None) -> None:
        self.json_file = json_file
        self.to_error = json_file == "-"

    def __call__(self, text: str = "", **style: Any) -> None:
        click.secho(text, err=self.to_error, **style)

    def paragraph(self, text: str, bullet: str = "") -> None:
        """Print a text wrapped at words, under a bullet if one is given."""
        width = min(100, shutil.get_terminal_size().columns)
        self(textwrap.fill(text, width, initial_indent=bullet, subsequent_indent="    " if bullet else ""))

    def table(self, columns: list[str], rows: list[list[str]]) -> None:
        """Print a table, cells as they stand."""
        from rich.console import Console
        from rich.table import Table

        table = Table(header_style="bold")
        for column in columns:
            table.add_column(column, overflow="fold")
        for row in rows:
            table.add_row(*row)
        # Markup off: "[s]" is a unit here, and names come from the user's file.
        stream = sys.stderr if self.to_error else sys.stdout
        Console(file=stream, markup=False, emoji=False, highlight=False).print(table)

    def document(self, content: dict[str, Any]) -> None:
        """Write the JSON document where it was asked for, if it was."""
        if self.json_file is None:
            return
        text = json.dumps(content, indent=2, allow_nan=False, ensure_ascii=False) + "\n"
        if self.to_error:
            click.echo(text.encode(), nl=False)  # bytes: JSON is UTF-8 whatever the terminal's encoding
        else:
            write_whole(Path(self.json_file), text.encode())


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
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
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
            complain(f"{hidden() or blame}: {fault}")
        raise SystemExit(2)

    return wrapped


def complain(message: str) -> None:
    """Print one error message, shortened in the middle if it is huge."""
    if len(message) > LONGEST_MESSAGE:
        message = f"{message[: LONGEST_MESSAGE - 300]} ... {message[-250:]}"
    click.secho(f"Error: {message}", fg="red", err=True)

"""What every command shares: words to the right stream, one JSON document, errors without tracebacks."""

import json
import os
import sys
import tempfile
from collections.abc import Callable
from functools import wraps
from pathlib import Path
from typing import Any

import click

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

    def table(self, title: str, columns: list[str], rows: list[list[str]]) -> None:
        """Print a table."""
        from rich.console import Console
        from rich.table import Table

        table = Table(title=title or None, title_justify="left", header_style="bold")
        for column in columns:
            table.add_column(column, overflow="fold")
        for row in rows:
            table.add_row(*row)
        Console(file=sys.stderr if self.to_error else sys.stdout).print(table)

    def document(self, content: dict[str, Any]) -> None:
        """Write the JSON document where it was asked for, if it was."""
        if self.json_file is None:
            return
        text = json.dumps(content, indent=2, allow_nan=False, ensure_ascii=False) + "\n"
        if self.to_error:
            sys.stdout.write(text)
        else:
            write_whole(Path(self.json_file), text.encode())


def write_whole(path: Path, content: bytes) -> None:
    """Write a file completely or not at all: to a temporary neighbour first, then renamed."""
    handle, temporary = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(content)
        os.chmod(temporary, 0o644)
        os.replace(temporary, path)
    except BaseException:
        Path(temporary).unlink(missing_ok=True)
        raise


def user_errors(command: Callable[..., Any]) -> Callable[..., Any]:
    """Turn mistakes of the caller (``ValueError``, ``OSError``) into one message and exit code 2."""

    @wraps(command)
    def wrapped(*args: Any, **kwargs: Any) -> Any:
        try:
            return command(*args, **kwargs)
        except BrokenPipeError:  # the reader, e.g. ``head``, has seen enough
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
            raise SystemExit(0) from None
        except (ValueError, OSError) as error:
            click.secho(f"Error: {error}", fg="red", err=True)
            raise SystemExit(2) from None

    return wrapped

"""``stickslip table``: all detection methods side by side, on one record, a folder of records or a case."""

from pathlib import Path
from typing import TYPE_CHECKING

import click

from stickslip.console import COLOUR_OF, Speaker, json_option, user_errors
from stickslip.targets import check_targets, write_figure, write_whole

if TYPE_CHECKING:
    from detect import Comparison, Method

PICTURES = (".png", ".svg", ".pdf")


@click.command("table")
@click.argument("source", required=False)
@click.option("--method", "chosen", multiple=True, metavar="NAME", help="Only this method; repeatable.")
@click.option("--cards", is_flag=True, help="Show what each method reads, assumes, finds and costs, and stop.")
@click.option("--csv", "csv_file", type=click.Path(path_type=Path), help="Write the table as CSV.")
@click.option("--html", type=click.Path(path_type=Path), help="Write a one-file page with the table and a picture.")
@click.option("--plot", "picture", type=click.Path(path_type=Path), help="Draw verdicts and times (.png, .svg, .pdf).")
@json_option
@user_errors
def command(
    source: str | None, chosen: tuple[str, ...], cards: bool, csv_file: Path | None, html: Path | None,
    picture: Path | None, json_file: str | None,
) -> None:  # fmt: skip
    """Put every detection method to SOURCE and show what each says, with its number, reason and time.

    SOURCE is a file with one loop or several, a folder of such files, or a case of 'stickslip simulate --list'.

    \b
    Examples:
      stickslip table --cards
      stickslip table ideal_high
      stickslip table FIC101.csv --method area_ratio --method play_fit
      stickslip table exports --csv table.csv --html table.html

    \b
    Exit codes:
      0  done: stiction in no loop, as far as the records tell
      1  done, and the combined verdict of a loop is stiction
      2  SOURCE cannot be read, or the request makes no sense
    """
    given = Path(source) if source is not None else None
    check_targets(
        {"--csv": csv_file, "--html": html, "--plot": picture, "--json": json_file},
        {"--plot": PICTURES},
        source=given if given is not None and given.is_file() else None,
    )
    methods, say = _methods(chosen), Speaker(json_file)
    if cards:
        if source is not None or html is not None or picture is not None:
            raise ValueError("--cards needs no SOURCE, --html or --plot; leave them out")
        _cards(say, methods, csv_file)
        return
    if source is None:
        raise ValueError("name a file, a folder or a case; 'stickslip table --cards' shows the methods alone")
    from detect import compare

    found = compare(_opened(source), methods)
    _tell(say, found)
    if csv_file is not None:
        write_whole(csv_file, found.csv().encode())
        say(f"table: {csv_file}")
    if html is not None:
        write_whole(html, _page(source, found).encode())
        say(f"page: {html}")
    if picture is not None:
        write_figure(found.plot(), picture)
        say(f"picture: {picture}")
    say.document(found.to_dict())
    raise SystemExit(1 if any(judged.combined == "stiction" for judged in found.loops) else 0)


def _methods(chosen: tuple[str, ...]) -> "list[Method]":
    """Return the methods that are named, or all."""
    from detect import METHODS

    known = {method.CARD.name: method for method in METHODS}
    for name in chosen:
        if name not in known:
            raise ValueError(f"--method {name}: there is no method '{name}'; known: {', '.join(known)}")
    return [known[name] for name in dict.fromkeys(chosen)] if chosen else list(METHODS)


def _opened(source: str):  # type: ignore[no-untyped-def]
    """Return the path of a file or folder, or the case of that name."""
    if Path(source).exists():
        return Path(source)
    from cases import names

    if source not in names():
        raise ValueError(f"'{source}' is no file, no folder and no case; the cases are {', '.join(names())}")
    from cases import find

    return find(source)


def _tell(say: Speaker, found: "Comparison") -> None:
    """Print one table a loop, then each reason, then the files without a loop."""
    from detect.words import WORDS

    for judged in found.loops:
        word = WORDS[judged.combined]
        say(f"{judged.loop}: {word.spoken}", fg=COLOUR_OF[word.kind], bold=True)
        rows = judged.rows()
        shown = [[method + " *" * (votes == "yes"), *more] for _, method, votes, *more, _ in rows]
        say.table(["method", "verdict", "index", "limit", "% OP", "ms"], shown)
        total = sum(judged.milliseconds)
        say(f"{judged.samples} samples: {judged.preparation:.0f} ms to prepare, {total:.0f} ms for all methods")
        voting = sum(row[2] == "yes" for row in rows)
        say(f"* votes ({voting} of {len(rows)}); the others are on trial and shown only")
        for row in rows:
            say.paragraph(row[-1], f"  {row[1]}: ")
        say()
    for file, reason in found.skipped:
        say.paragraph(reason, f"not read: {file}: ")


def _page(source: str, found: "Comparison") -> str:
    from detect.comparison import COLUMNS
    from detect.words import WORDS
    from stickslip.report.page import Section, figure_to_svg, page, table_to_html

    sections = [
        Section(
            judged.loop,
            WORDS[judged.combined].spoken.upper(),
            WORDS[judged.combined].kind,
            f"{judged.samples} samples; {judged.preparation:.0f} ms to prepare, {sum(judged.milliseconds):.0f} ms for "
            "all methods.",
            figures=[table_to_html(COLUMNS[1:], [row[1:] for row in judged.rows()])],
        )
        for judged in found.loops
    ]
    sections[0].figures.insert(0, figure_to_svg(found.plot()))
    if found.skipped:
        sections[-1].notes += [f"{file} is not read: {reason}" for file, reason in found.skipped]
    return page(f"All methods on {source}", "", sections)


def _cards(say: Speaker, methods: "list[Method]", csv_file: Path | None) -> None:
    from detect.cards import CARD_COLUMNS, card_rows

    rows = card_rows(methods)
    say.table(["method", "signals", "process", "streams"], [[row[0], row[3], row[4], row[7]] for row in rows])
    for row in rows:
        say(f"{row[0]}: {row[1]}", bold=True)
        for column, cell in zip(CARD_COLUMNS[2:], row[2:], strict=True):
            say.paragraph(cell, f"  {column}: ")
    if csv_file is not None:
        from detect.comparison import csv_text

        write_whole(csv_file, csv_text(CARD_COLUMNS, rows).encode())
        say(f"table: {csv_file}")
    say.document(
        {
            "schema": "stickslip.cards/1",
            "methods": [dict(zip(CARD_COLUMNS, row, strict=True)) for row in rows],
        }
    )

"""``stickslip valve``: deadband, resolution and step response from a step test or from routine moves."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from stickslip.console import Speaker, json_option, user_errors
from stickslip.targets import check_targets, write_whole

if TYPE_CHECKING:
    from detect.valve_test import ValveTest


@click.command("valve")
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--pv", help="Name of the measurement column.")
@click.option("--op", help="Name of the controller output column.")
@click.option("--mv", help="Name of the stem position column.")
@click.option("--time", help="Name of the time column.")
@click.option("--interval", type=float, metavar="SECONDS", help="Time between rows, for a file without time.")
@click.option("--loop", help="Which loop, when the file holds several.")
@click.option("--op-span", nargs=2, type=float, metavar="LOW HIGH", help="Span of OP in its own unit.")
@click.option("--html", type=click.Path(path_type=Path), help="Write a one-file report with the picture.")
@json_option
@user_errors
def command(file: Path, html: Path | None, json_file: str | None, **told: Any) -> None:
    """Read deadband, resolution and step response of the valve in FILE.

    FILE is the record of a step test (ANSI/ISA-75.25.01): OP stepped up and down in several sizes, each held until the
    valve rests; with the stem position, or with PV alone. A record of routine moves does where the stem is logged.

    \b
    Examples:
      stickslip valve test.csv
      stickslip valve trend.csv --op FCV101.OUT --mv FCV101.POS --html test.html

    \b
    Exit codes:
      0  done
      2  FILE cannot be read, or holds no test
    """
    check_targets({"--html": html, "--json": json_file}, source=file)
    from detect.valve_test import analyse
    from logs import read_loop

    test = analyse(read_loop(file, **{name: value for name, value in told.items() if value is not None}))
    say = Speaker(json_file)
    say(f"{test.name}: {len(test.steps)} steps of OP, answer read from {test.answer}", bold=True)
    for sentence in test.words:
        say.paragraph(sentence)
    for note in test.notes:
        say.paragraph(note, "  - ")
    if html is not None:
        write_whole(html, _report(test).encode())
        say(f"report: {html}")
    say.document(test.to_dict())


def _report(test: "ValveTest") -> str:
    from stickslip.report.page import Section, figure_to_svg, page

    section = Section(test.name, f"{len(test.steps)} steps", "open", " ".join(test.words))
    section.notes.extend((*test.notes, "ANSI/ISA-75.25.01 defines these figures and sets no limits for them."))
    section.figures.append(figure_to_svg(test.plot()))
    return page(f"{test.name}: valve test", "", [section])

"""``stickslip fit``: a loop fitted to its own log, with honest intervals."""

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from stickslip.commands.console import COLOUR_OF, Speaker, json_option, user_errors
from stickslip.commands.reading import loop_options
from stickslip.commands.targets import check_targets, write_whole

if TYPE_CHECKING:
    from collections.abc import Sequence

    from stickslip.commands.report.page import Section
    from stickslip.logs import LoopRecord
    from stickslip.remedy import LoopFit

SCHEMA = "stickslip.fit/1"


@click.command("fit")
@click.argument("files", metavar="LOOP [DAY2 ...]", nargs=-1, required=True, type=click.Path(path_type=Path))
@loop_options
@click.option("--python", type=click.Path(path_type=Path), help="Write the likeliest loop as a Python file to edit.")
@click.option("--html", type=click.Path(path_type=Path), help="Write a one-file report with pictures.")
@json_option
@user_errors
def command(
    files: tuple[Path, ...], python: Path | None, html: Path | None, json_file: str | None, **stated: Any
) -> None:
    """Fit a loop to its own log: controller, valve, process, load and noise, each with a 90 % interval.

    LOOP is CSV or Parquet with a time column, OP, PV and, if logged, SP, in automatic; an hour or ten periods at the
    controller's scan is a good start. More files of the same loop are pooled. What the record does not tell is said.

    \b
    Examples:
      stickslip fit FIC101.csv
      stickslip fit monday.csv tuesday.csv --python fic101.py
      stickslip fit FIC101.csv --json - | jq .valve.S
      stickslip fit trend.csv --pv FT101 --op FCV101 --sp FSP101 --html fit.html

    \b
    Exit codes:
      0  done: no stick is believed
      1  done, and the valve sticks
      2  the files cannot be read, or no loop can be fitted to them
    """
    check_targets({"--python": python, "--html": html, "--json": json_file}, {"--python": (".py",)}, files[0])
    say = Speaker(json_file)
    found = fitted(files, stated)
    tell(say, found)
    if python is not None:
        from stickslip.remedy import python_of

        write_whole(python, python_of(found).encode())
        say(f"loop: {python}")
    if html is not None:
        from stickslip.commands.report.page import page

        write_whole(html, page(f"{found.name or 'loop'}: fitted", "", [fit_section(found)]).encode())
        say(f"report: {html}")
    say.document({"schema": SCHEMA} | found.to_dict())
    raise SystemExit(1 if found.sticks else 0)


def records_of(files: "Sequence[Path]", stated: "dict[str, Any]") -> "list[LoopRecord]":
    """Return the loop's record in each file; raises ``ValueError`` where a file holds several loops."""
    from stickslip.logs import read_loop

    options = {name: value for name, value in stated.items() if value is not None}
    return [read_loop(file, **options) for file in files]


def fitted(files: "Sequence[Path]", stated: "dict[str, Any]") -> "LoopFit":
    """Return the fit of the loop in these files; what is done is said on a terminal."""
    working("reading the log")
    records = records_of(files, stated)
    refuse_unfit(records)
    working("loading what fits a loop")
    from stickslip.engine.notice import noticed
    from stickslip.remedy import fit

    with noticed("fit of a loop"):
        return fit(records, progress=working)


def refuse_unfit(records: "Sequence[LoopRecord]") -> None:
    """Raise ``FitError`` for a record that the fit would refuse at once; to load the fit takes seconds."""
    from stickslip.logs.trend import rests
    from stickslip.remedy.refusal import STANDS, FitError, refuse_short

    for record in records:
        op, pv = record.op[record.good], record.pv[record.good]
        most = round(record.log.duration / record.dt) + 1 if len(record) > 1 else len(record)
        refuse_short(most)
        if not len(op) or rests(op) or rests(pv):
            raise FitError(STANDS)


def working(what: str) -> None:
    """Say on a terminal what is done."""
    if sys.stderr.isatty():
        click.echo(f"{what} ...", err=True)


def tell(say: Speaker, found: "LoopFit") -> None:
    """Print a fit."""
    from stickslip.detect.words import WORDS

    word = WORDS[found.verdict]
    say(f"{found.name or 'loop'}: {word.spoken.upper()}", fg=COLOUR_OF[word.kind], bold=True)
    for sentence in filter(None, (found.doubt, *sentences(found))):
        say.paragraph(sentence)
    say.table(["what", "value (90 % interval)", "unit"], found.rows())


def sentences(found: "LoopFit") -> list[str]:
    """Return the sentences that stand below the table of a fit."""
    law = found.controller
    share = f"{100 * law.explained:.1f} %"
    law_line = (
        f"The controller is {law.form}, read from rows every {law.dt:g} s; its law explains {share} of how OP moves."
    )
    kind = "integrates" if found.best.integrating else "settles by itself"
    kind = "does not show" if found.closed else kind
    fits = (
        f"The process {kind}. One row ahead {100 * found.one_step_error:.0f} % of PV's spread is not predicted; the "
        f"stem alone, without the load, leaves {100 * found.free_error:.0f} %."
    )
    gain = [f"A stick predicts PV better than none by {found.gain:.0f} nats."] if found.sticks else []
    return [law_line, fits, *gain, *found.notes]


def fit_section(found: "LoopFit") -> "Section":
    """Return the article on a fit."""
    from stickslip.commands.report.page import Section, captioned, figure_to_svg, table_to_html
    from stickslip.detect.words import WORDS

    word = WORDS[found.verdict]
    section = Section(
        "The fitted loop", word.spoken.upper(), word.kind, " ".join(filter(None, (found.doubt, *sentences(found))))
    )
    section.figures.append(table_to_html(["what", "value (90 % interval)", "unit"], found.rows()))
    section.figures.append(captioned(figure_to_svg(found.plot()), "The end of the log and the likeliest loop."))
    return section

"""``stickslip remedy``: what to do about a sticky valve until the shutdown, each remedy tried on the fitted loop."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from stickslip.commands.console import COLOUR_OF, Speaker, json_option, user_errors
from stickslip.commands.fit import fit_section, fitted, sentences, working
from stickslip.commands.reading import loop_options
from stickslip.commands.targets import check_targets, write_whole

if TYPE_CHECKING:
    from stickslip.detect.words import Kind
    from stickslip.remedy import Advice

SCHEMA = "stickslip.remedy/1"
TRIAL = "This advice is new and was tested in simulation only: watch the loop for some hours before you keep a setting."
STEPS = (
    "SP step and load step: how long the tuning alone, without stick and noise, takes until PV is within 5 % of a "
    "step. Mean off SP: how far PV stays from SP on average."
)


@click.command("remedy")
@click.argument("files", metavar="LOOP [DAY2 ...]", nargs=-1, required=True, type=click.Path(path_type=Path))
@loop_options
@click.option("--html", type=click.Path(path_type=Path), help="Write a one-file report with pictures.")
@click.option("--plot", type=click.Path(path_type=Path), help="Draw PV now and then, and the travel of each remedy.")
@json_option
@user_errors
def command(
    files: tuple[Path, ...], html: Path | None, plot: Path | None, json_file: str | None, **stated: Any
) -> None:
    """Say what to do about the valve of a loop until the shutdown and at it, from its log alone.

    The loop is fitted to its log (stickslip fit), each remedy is simulated on loops about equally likely, under the
    load that the record had, and compared with doing nothing. Settings are in the controller's own terms. Nothing is
    recommended that does not swing less in its own simulation.

    \b
    Examples:
      stickslip remedy FIC101.csv
      stickslip remedy FIC101.csv --plot now_and_then.png
      stickslip remedy monday.csv tuesday.csv --html remedy.html
      stickslip remedy FIC101.csv --json - | jq .until_shutdown

    \b
    Exit codes:
      0  done: nothing is recommended
      1  done, and a remedy is recommended
      2  the files cannot be read, or no loop can be fitted to them
    """
    check_targets(
        {"--html": html, "--plot": plot, "--json": json_file}, {"--plot": (".png", ".svg", ".pdf")}, source=files[0]
    )
    say = Speaker(json_file)
    found = fitted(files, stated)
    from stickslip.remedy import remedies

    advice = remedies(found, progress=working)
    tell(say, advice)
    if plot is not None:
        from stickslip.commands.targets import write_figure

        write_figure(advice.plot(), plot)
        say(f"picture: {plot}")
    if html is not None:
        write_whole(html, _page(advice).encode())
        say(f"report: {html}")
    say.document({"schema": SCHEMA} | advice.to_dict())
    raise SystemExit(1 if advice.until_shutdown or advice.at_shutdown else 0)


def tell(say: Speaker, advice: "Advice") -> None:
    """Print the recommendation, the fit it rests on, and the table of all remedies."""
    found = advice.fit
    words, kind = headline(advice)
    say(f"{found.name or 'loop'}: {words}", fg=COLOUR_OF[kind], bold=True)
    for sentence in (*advice.words(), *sentences(found)):
        say.paragraph(sentence)
    if found.sticks:
        say.paragraph(advice.cost.words(found.op_unit))
    if advice.until_shutdown or advice.at_shutdown:
        say.paragraph(TRIAL)
    if advice.tried:
        say.table(advice.columns(), advice.rows())
        say.paragraph(STEPS)
        say("Settings tried, the best of each:")
    for one in advice.tried:
        say.paragraph(f"{one.name}: {one.settings}", "  - ")


def headline(advice: "Advice") -> tuple[str, "Kind"]:
    """Return the answer in a few words, and its kind."""
    from stickslip.detect.words import WORDS

    word, name = WORDS[advice.fit.verdict], advice.until_shutdown
    if advice.fit.doubt:
        return "NOTHING IS RECOMMENDED", word.kind
    if not advice.fit.sticks:
        return word.spoken.upper(), word.kind
    return (name or "nothing helps for sure until the shutdown").upper(), "bad" if name else "open"


def _page(advice: "Advice") -> str:
    from stickslip.commands.report.page import Section, captioned, figure_to_svg, page, table_to_html

    first = Section("What to do", *headline(advice), " ".join(advice.words()))
    if advice.tried:
        picture = captioned(figure_to_svg(advice.plot()), f"Under the load that the record had; bars are 90 %. {STEPS}")
        first.figures += [picture, table_to_html(advice.columns(), advice.rows())]
    return page(f"{advice.fit.name or 'loop'}: what to do", "", [first, fit_section(advice.fit)])

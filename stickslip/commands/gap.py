"""``stickslip gap``: where a model and a record part, which effect explains it, how far the gap shrinks."""

from pathlib import Path
from typing import TYPE_CHECKING

import click

from stickslip.console import Speaker, json_option, user_errors
from stickslip.targets import check_targets, write_whole

if TYPE_CHECKING:
    from gap import GapReport

SCHEMA = "stickslip.gap/1"


@click.command("gap")
@click.argument("run", type=click.Path(path_type=Path))
@click.option("--model", required=True, metavar="MODEL", help="Name of a case, or FILE.py:FUNCTION.")
@click.option("--html", type=click.Path(path_type=Path), help="Write a one-file report with pictures.")
@click.option("--seed", type=int, default=0, show_default=True, help="Seed of the runs without a gap.")
@json_option
@user_errors
def command(run: Path, model: str, html: Path | None, seed: int, json_file: str | None) -> None:
    """Say where MODEL and the record RUN part, which effect explains it, and how far the gap shrinks then.

    RUN is CSV or Parquet with a column 'time' in seconds and any signals of the model, by name. MODEL is the name of a
    case ('stickslip simulate --list'), or FILE.py:FUNCTION: that file IS EXECUTED, and the function, called without
    arguments, returns a wired diagram with nominal parameters, its noise and unmeasured loads as blocks.

    \b
    Examples:
      stickslip gap run.csv --model ideal_flow
      stickslip gap run.csv --model my_loop.py:loop --json gap.json --html gap.html

    \b
    Exit codes:
      0  no gap of relevance
      1  a gap
      2  RUN or MODEL cannot be read, or they have no signal in common
    """
    check_targets({"--html": html, "--json": json_file}, source=run)
    from gap import diagnose
    from logs import read_log
    from stickslip.own import diagram_named

    log = read_log(run)  # first: a model is executed only where there is a record
    report = diagnose(diagram_named(model, "--model"), log, seed=seed)
    say = Speaker(json_file)
    say("GAP" if report.gap else "NO GAP", fg="red" if report.gap else "green", bold=True)
    for sentence in report.words:
        say.paragraph(sentence)
    if report.ranking:
        say.table(
            ["effect", "place", "probability"],
            [[rank.effect, rank.place, f"{rank.probability:.3f}"] for rank in report.ranking[:6]],
        )
    say("Read and assumed:")
    for sentence in report.notes:
        say.paragraph(sentence, "  - ")
    if html is not None:
        write_whole(html, _page(report, run.name).encode())
        say(f"report: {html}")
    say.document({"schema": SCHEMA, **report.to_dict()})
    raise SystemExit(1 if report.gap else 0)


def _page(report: "GapReport", name: str) -> str:
    from stickslip.report.page import Section, figure_to_svg, page

    section = Section(name, "GAP" if report.gap else "NO GAP", "bad" if report.gap else "good", " ".join(report.words))
    section.notes.extend(report.notes)
    section.figures.append(figure_to_svg(report.plot_diagram()))
    section.figures.append(figure_to_svg(report.plot()))
    return page(f"{name}: {'gap' if report.gap else 'no gap'}", "", [section])

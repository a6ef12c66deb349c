"""``stickslip gap``: where a model and a record part, which effect explains it, how far the gap shrinks."""

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

import click

from stickslip.commands.console import Speaker, json_option, user_errors
from stickslip.commands.reading import COLUMNS, as_named, loop_options
from stickslip.commands.targets import check_targets, write_whole

if TYPE_CHECKING:
    from stickslip.gap import GapReport, LatentInput
    from stickslip.logs import Log
    from stickslip.remedy.change import Changes
    from stickslip.remedy.loop_fit import LoopFit

SCHEMA = "stickslip.gap/1"
SHOWN = 6  # effects that are listed
HEADS = ["what", "unit", "earlier (90 % interval)", "later (90 % interval)", "later / earlier", "changed"]


@click.command("gap")
@click.argument("run", type=click.Path(path_type=Path))
@click.option("--model", metavar="MODEL", help="Name of a case, or FILE.py:FUNCTION.")
@click.option(
    "--fit",
    "earlier",
    type=click.Path(path_type=Path),
    metavar="EARLIER",
    help="In place of a model: an earlier record of the same loop, to say what has changed since.",
)
@click.option(
    "--signal",
    "signals",
    multiple=True,
    metavar="NAME=COLUMN",
    help="Column of RUN that is the signal NAME of MODEL, as in OP=0.01*FC101.OP; repeatable.",
)
@loop_options
@click.option("--html", type=click.Path(path_type=Path), help="Write a one-file report with pictures.")
@click.option("--seed", type=int, metavar="N", default=0, show_default=True, help="Seed of the runs without a gap.")
@click.option("--calibrate", is_flag=True, help="Count how often names are right on runs of MODEL with known effects.")
@click.option(
    "--minutes",
    type=click.FloatRange(min=0.0, min_open=True),
    metavar="MINUTES",
    help="With --calibrate: stop after this time; the next call goes on. Without it, all runs are made.",
)
@json_option
@user_errors
def command(
    run: Path,
    model: str | None,
    earlier: Path | None,
    signals: tuple[str, ...],
    html: Path | None,
    seed: int,
    calibrate: bool,
    minutes: float | None,
    json_file: str | None,
    **form: Any,
) -> None:
    """Say where MODEL and the record RUN part, which effect explains it, and how far the gap shrinks then.

    RUN is CSV or Parquet with a time and any signals of the model, by name; what is called otherwise, or is in other
    units, --signal tells: where the model's OP goes from 0 to 1, percent have to be multiplied by 0.01. MODEL is the
    name of a case ('stickslip simulate --list'), or FILE.py:FUNCTION: that file IS EXECUTED, and the function, called
    without arguments, returns a wired diagram with nominal parameters, its noise and unmeasured loads as blocks.

    --calibrate puts every effect into MODEL at the set points, rows, rounding and signals of RUN, diagnoses these runs,
    prints what came out, and keeps it: probabilities are stated by it from then on.

    Without --model, RUN is the log of one loop (OP, PV, SP): the loop is fitted to it, and the answer is whether it
    lacks a stick. With --fit EARLIER, loops are fitted to both records, and what has changed is named; --loop, --pv,
    --op and --sp say what is called so in both files.

    \b
    Examples:
      stickslip gap run.csv --model ideal_flow
      stickslip gap november.csv --fit march.csv --loop FIC101
      stickslip gap FIC101.csv
      stickslip gap run.csv --model my_loop.py:loop --json gap.json --html gap.html
      stickslip gap export.csv --model ideal_flow --signal PV=FT101 --signal OP=0.01*FC101.OP --signal SP=FC101.SP
      stickslip gap run.csv --model my_loop.py:loop --calibrate --minutes 10

    \b
    Exit codes:
      0  no gap of relevance
      1  a gap
      2  RUN or MODEL cannot be read, or they have no signal in common
    """
    check_targets({"--html": html, "--json": json_file}, source=run)
    if model is None:
        without_model(run, earlier, signals, calibrate, html, json_file, form)
    if earlier is not None:
        raise ValueError("--fit is given beside --model; a record is held against one of them: leave out the other")
    from stickslip.commands.own import diagram_named
    from stickslip.gap import calibrated, diagnose
    from stickslip.logs import read_log
    from stickslip.logs.chances import chance

    said = [f"--{name}" for name in COLUMNS if form.pop(name) is not None]
    if said:
        raise ValueError(f"{', '.join(said)}: with a --model, --signal PV=COLUMN says which column is which signal")
    log = as_named(read_log(run, **form), signals)  # first: a model is executed only where there is a record
    diagram = diagram_named(model, "--model")
    say = Speaker(json_file)
    if calibrate:
        seconds = math.inf if minutes is None else 60.0 * minutes
        for line in str(calibrated(diagram, log, seed=seed, seconds=seconds)).splitlines():
            say(line)
    report = diagnose(diagram, log, seed=seed)
    say("GAP" if report.gap else "NO GAP", fg="red" if report.gap else "green", bold=True)
    for sentence in report.sentences:
        say.paragraph(sentence)
    shape = _shape(report, log)
    if not isinstance(shape, str):
        say.paragraph(str(shape))
    if report.ranking:
        say.table(
            ["effect", "place", "probability"],
            [[rank.effect, rank.place, chance(rank.probability)] for rank in report.ranking[:SHOWN]],
        )
    say("Read and assumed:")
    for sentence in report.notes:
        say.paragraph(sentence, "  - ")
    if html is not None:
        write_whole(html, _page(report, log, shape, run.name).encode())
        say(f"report: {html}")
    say.document({"schema": SCHEMA, **report.to_dict()})
    raise SystemExit(1 if report.gap else 0)


def without_model(
    run: Path,
    earlier: Path | None,
    signals: tuple[str, ...],
    calibrate: bool,
    html: Path | None,
    json_file: str | None,
    form: dict[str, Any],
) -> NoReturn:
    """Say what a loop fitted to RUN lacks, or what has changed since EARLIER, and leave."""
    from stickslip.commands.fit import fitted
    from stickslip.remedy import FitError, changes, lacks

    if calibrate or signals:
        raise ValueError("--calibrate and --signal need a --model; give one, or leave them out")
    fits = []
    for record in filter(None, (earlier, run)):
        try:
            fits.append(fitted([record], form))
        except FitError as fault:
            raise FitError(f"{record}: {fault}") from fault
    answer = changes(*fits) if earlier else lacks(*fits)
    say = Speaker(json_file)
    say("GAP" if answer.gap else "NO GAP", fg="red" if answer.gap else "green", bold=True)
    for sentence in answer.words:
        say.paragraph(sentence)
    table = [HEADS, *(one.row() for one in answer.compared)] if earlier is not None else []
    if table:
        say.table(table[0], table[1:])
    if answer.notes:
        say("Read and assumed:")
    for sentence in answer.notes:
        say.paragraph(sentence, "  - ")
    if html is not None:
        write_whole(html, _page_of_fits(answer, fits, table, run.name).encode())
        say(f"report: {html}")
    say.document({"schema": SCHEMA, **answer.to_dict()})
    raise SystemExit(1 if answer.gap else 0)


def _page_of_fits(answer: "Changes", fits: "list[LoopFit]", table: list[list[str]], name: str) -> str:
    from stickslip.commands.fit import fit_section
    from stickslip.commands.report.page import Section, page, table_to_html

    badge, kind = ("GAP", "bad") if answer.gap else ("NO GAP", "good")
    notes = list(answer.notes)
    first = Section("The answer", badge, kind, " ".join(answer.words), notes=notes, notes_label="Read and assumed")
    if table:
        first.figures.append(table_to_html(table[0], table[1:]))
    sections = [fit_section(one) for one in fits]
    for section, time in zip(sections, ("Earlier", "Later") if len(fits) > 1 else ("",), strict=True):
        section.title = f"{time}: the fitted loop" if time else section.title
    return page(f"{name}: {'gap' if answer.gap else 'no gap'}", "", [first, *sections])


def _shape(report: "GapReport", log: "Log") -> "LatentInput | str":
    """Return the latent input of a gap, or why there is none to show."""
    from stickslip.gap import GapError, latent_input

    try:
        return latent_input(report, log)
    except GapError as reason:
        return str(reason)


def _page(report: "GapReport", log: "Log", shape: "LatentInput | str", name: str) -> str:
    from stickslip.commands.report.page import Section, bullets, captioned, figure_to_svg, page, table_to_html
    from stickslip.logs.chances import chance

    badge, kind = ("GAP", "bad") if report.gap else ("NO GAP", "good")
    first, *more = report.sentences
    answer = Section("The answer", badge, kind, first)
    answer.figures += _first_pictures(report, log)
    reasons = Section("Why", "", "open", "", notes=list(report.notes), notes_label="Read and assumed")
    if more:
        reasons.figures.append(bullets("What was found", more))
    if report.ranking:
        rows = [
            [rank.effect.replace("_", " "), rank.place, chance(rank.probability)] for rank in report.ranking[:SHOWN]
        ]
        reasons.figures.append(table_to_html(["effect", "place", "probability"], rows))
    form = Section("What shape it has", "", "open", str(shape))
    if not isinstance(shape, str):
        said = "Grey: rows; lines: means of equally many. A play or a stick parts the lines over what drives it."
        form.figures.append(captioned(figure_to_svg(shape.plot()), said))
    left = Section("What the model does not explain", "", "open", "")
    said = "One-step errors of the model; grey: three standard deviations, which a model without a gap keeps to."
    left.figures.append(captioned(figure_to_svg(report.plot()), said))
    return page(
        f"{name}: {'gap' if report.gap else 'no gap'}", "", [answer, reasons, *([form] if report.gap else []), left]
    )


def _first_pictures(report: "GapReport", log: "Log") -> list[str]:
    """Return the log against the model before and after, with how far the gap shrinks, and the place in the diagram."""
    from stickslip.commands.report.page import captioned, figure_to_svg
    from stickslip.gap import GapError, replayed

    pictures = []
    try:
        found = replayed(report, log)
    except GapError:  # a gap without a place, or no gap: residuals and diagram say what there is to see
        pass
    else:
        said = (
            "Drawn: the stretch where the model errs most, driven by the log alone; a slip that is missed there stays "
            "missed until the next. The bar counts errors from row to row, on rows that the fit has not seen."
        )
        pictures.append(captioned(figure_to_svg(found.plot()), said, str(found)))
    said = "The redder and thicker a frame, the likelier the gap is there." if report.where else "The model."
    return [*pictures, captioned(figure_to_svg(report.plot_diagram()), said)]

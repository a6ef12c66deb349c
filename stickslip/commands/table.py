"""``stickslip table``: all detection methods side by side, on files, folders, cases or simulated loops."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from stickslip.commands.console import COLOUR_OF, Speaker, json_option, user_errors
from stickslip.commands.short import refuse_short
from stickslip.commands.targets import check_targets, write_figure, write_whole

if TYPE_CHECKING:
    from stickslip.detect import Comparison, Method
    from stickslip.detect.scoring import Label
    from stickslip.logs.tags import Process

PICTURES = (".png", ".svg", ".pdf")


@click.command("table")
@click.argument("sources", metavar="[SOURCE]...", nargs=-1)
@click.option(
    "--method",
    "chosen",
    multiple=True,
    metavar="NAME",
    help="Only this method, or your own FILE.py:FUNCTION; repeatable.",
)
@click.option("--loop", "loops", multiple=True, metavar="TAG", help="Only this loop; repeatable.")
@click.option("--duration", type=float, metavar="SECONDS", help="Time to simulate a case, instead of the case's own.")
@click.option("--process", type=click.Choice(["self_regulating", "integrating"]), help="Kind of process, if known.")
@click.option("--labels", type=click.Path(path_type=Path), help="CSV with loop, label, tag: score each method by tag.")
@click.option("--cards", is_flag=True, help="Show what each method is, with its measured rates, and stop.")
@click.option("--simulated", type=click.IntRange(1, 500), metavar="N", help="Judge N simulated loops of known cause.")
@click.option(
    "--seed", type=click.IntRange(0), metavar="N", default=1, show_default=True, help="Seed of the simulated loops."
)
@click.option("--csv", "csv_file", type=click.Path(path_type=Path), help="Write the table as CSV.")
@click.option("--html", type=click.Path(path_type=Path), help="Write a one-file page with the table and a picture.")
@click.option("--plot", "picture", type=click.Path(path_type=Path), help="Draw verdicts and times (.png, .svg, .pdf).")
@json_option
@user_errors
def command(
    sources: tuple[str, ...], chosen: tuple[str, ...], loops: tuple[str, ...], duration: float | None,
    process: "Process | None",
    labels: Path | None, cards: bool,
    simulated: int | None, seed: int, csv_file: Path | None, html: Path | None, picture: Path | None,
    json_file: str | None,
) -> None:  # fmt: skip
    """Put every detection method to each SOURCE and show what each says, with its number, reason and time.

    A SOURCE is a file with one loop or several, a folder of such files, or a case of 'stickslip simulate --list'.
    A case or a method of your own is FILE.py:FUNCTION: that file IS EXECUTED.

    \b
    Examples:
      stickslip table --cards
      stickslip table ideal_high ideal_integrating
      stickslip table plant_1_high --loop PCS11 --loop LCS11
      stickslip table --simulated 20
      stickslip table my_loop.py:loop --duration 7200 --method my_detector.py:detect --method area_ratio
      stickslip table FIC101.csv --method area_ratio --method play_fit
      stickslip table records --labels labels.csv
      stickslip table exports --csv table.csv --html table.html

    \b
    Exit codes:
      0  done: stiction in no loop, as far as the records tell
      1  done, and the verdict on a loop is stiction
      2  SOURCE cannot be read or is too short for any verdict, or the request makes no sense
    """
    targets = {"--csv": csv_file, "--html": html, "--plot": picture, "--json": json_file}
    for source in sources or ("",):
        check_targets(targets, {"--plot": PICTURES}, source=Path(source) if Path(source).is_file() else None)
    methods, say = _methods(chosen), Speaker(json_file)
    if cards:
        if sources or loops or process or labels or simulated or picture is not None:
            raise ValueError(
                "--cards needs no SOURCE, --loop, --process, --labels, --simulated or --plot; leave them out"
            )
        from stickslip.commands.cards import show_cards

        show_cards(say, methods, csv_file, html)
        return
    if simulated is not None and (sources or loops or process or labels):
        raise ValueError("--simulated draws its own loops; leave out SOURCE, --loop, --process and --labels")
    if not sources and simulated is None:
        raise ValueError("name a file, a folder or a case; 'stickslip table --cards' shows the methods alone")
    from stickslip.detect import compare
    from stickslip.detect.scoring import read_labels

    known = read_labels(labels) if labels is not None else None
    if simulated is not None:
        from stickslip.calibration import draw, simulate

        made = simulate(draw(simulated, seed))
        found = compare(
            [replace(record, name=f"{i}: {truth.group}") for i, (record, truth) in enumerate(made)], methods
        )
    else:
        found = compare(
            [_opened(source, duration) for source in sources], methods, process=process, loops=loops or None
        )
    refuse_short((one.loop, one.samples, any(v.applicable for v in one.verdicts)) for one in found.loops)
    _tell(say, found)
    scored = _scored(say, found, known) if known is not None else []
    if csv_file is not None:
        write_whole(csv_file, found.csv().encode())
        say(f"table: {csv_file}")
    if html is not None:
        write_whole(html, _page(", ".join(sources) or f"{simulated} simulated loops", found).encode())
        say(f"page: {html}")
    if picture is not None:
        write_figure(found.plot(), picture)
        say(f"picture: {picture}")
    say.document(found.to_dict() | ({"scores": scored} if scored else {}))
    raise SystemExit(1 if any(judged.combined == "stiction" for judged in found.loops) else 0)


def _scored(say: Speaker, found: "Comparison", labels: "Mapping[str, Label]") -> "list[dict[str, Any]]":
    """Print what each method is worth on the labelled records, and return it as plain values."""
    from stickslip.detect.scoring import SCORE_COLUMNS, score_rows, scores

    counted = scores(found, labels)
    say("By tag, the majority of its decided records; labels are opinions, and a dozen tags an anecdote", bold=True)
    rows = score_rows(counted)
    say.table(list(SCORE_COLUMNS), [row for row in rows if not row[0].startswith("published")])
    for name, _, _, right, interval, _ in rows:
        if name.startswith("published"):
            say.paragraph(f"{name}: {right} right ({interval})", "  - ")
    return [dict(one.__dict__) for one in counted]


def _methods(chosen: tuple[str, ...]) -> "list[Method]":
    """Return the methods that are named, or all."""
    from stickslip.commands.own import method_named
    from stickslip.detect import METHODS

    return [method_named(name) for name in dict.fromkeys(chosen)] if chosen else list(METHODS)


def _opened(source: str, duration: float | None):  # type: ignore[no-untyped-def]
    """Return the path of a file or folder, or the case of that name, of that ``duration`` [s] if one is given."""
    if Path(source).exists():
        if duration is not None:
            raise ValueError(f"--duration {duration:g}: '{source}' is a record and is not simulated; leave it out")
        return Path(source)
    from stickslip.cases import names
    from stickslip.commands.own import case_named, is_own
    from stickslip.commands.simulate import times_of

    if source not in names() and not is_own(source):
        raise ValueError(f"'{source}' is no file, no folder and no case; the cases are {', '.join(names())}")
    case = case_named(source, "SOURCE")
    return replace(case, duration=times_of(case, duration, None)[0])


def _tell(say: Speaker, found: "Comparison") -> None:
    """Print one table a loop, then each reason, then the files without a loop."""
    from stickslip.detect.words import WORDS

    for judged in found.loops:
        word = WORDS[judged.combined]
        say(f"{judged.loop}: {word.spoken}", fg=COLOUR_OF[word.kind], bold=True)
        rows = judged.rows()
        shown = [[method + " *" * (trial == "yes"), *more] for _, method, trial, *more, _ in rows]
        say.table(["method", "verdict", "index", "limit", "% OP", "ms"], shown)
        total = sum(judged.milliseconds)
        say(f"{judged.samples} samples: {judged.preparation:.0f} ms to prepare, {total:.0f} ms for all methods")
        say("The verdict is the calibrated one, as in check; the methods are for comparison (* on trial).")
        for row in rows:
            say.paragraph(row[-1], f"  {row[1]}: ")
        say()
    for file, reason in found.skipped:
        say.paragraph(reason, f"not read: {file}: ")


def _page(source: str, found: "Comparison") -> str:
    from stickslip.commands.report.page import Section, figure_to_svg, page, table_to_html
    from stickslip.detect.comparison import COLUMNS
    from stickslip.detect.words import WORDS

    counts = [f"{n} {WORDS[word].spoken}" for word in WORDS if (n := sum(one.combined == word for one in found.loops))]
    loops = f"{len(found.loops)} loop{'s' * (len(found.loops) != 1)}"
    seen = Section("What the methods say", loops, "open", f"The calibrated verdict: {', '.join(counts)}.")
    seen.figures.append(figure_to_svg(found.plot()))
    seen.notes += [f"{file} is not read: {reason}" for file, reason in found.skipped]
    sections = [seen]
    for judged in found.loops:
        word = WORDS[judged.combined]
        spent = f"{judged.preparation:.0f} ms to prepare, {sum(judged.milliseconds):.0f} ms for all methods"
        section = Section(judged.loop, word.spoken.upper(), word.kind, f"{judged.samples} samples; {spent}.")
        rows = [[row[1].replace("_", " "), *row[2:]] for row in judged.rows()]
        kinds = [WORDS[verdict.verdict].kind for verdict in judged.verdicts]
        section.figures.append(table_to_html(COLUMNS[1:], rows, badges={2: kinds}))
        sections.append(section)
    return page("All methods side by side", source, sections, contents=len(found.loops) > 1)

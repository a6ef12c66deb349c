"""``stickslip reproduce``: what the thesis computes, again: its tables of results and their pictures, side by side."""

import math
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from stickslip.commands.captions import BANDS, CAPTIONS, FIGURES, GUIDE, LEAD, TITLES
from stickslip.commands.console import Speaker, json_option, user_errors
from stickslip.commands.targets import check_folder, check_targets, write_whole

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from stickslip.cases.choice import Point
    from stickslip.cases.starts import Fresh
    from stickslip.cases.tables import Row
    from stickslip.commands.report.page import Section

QUICK = 24  # starts
Tell = Callable[[str], None]


@click.command("reproduce")
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    default=Path("stickslip-reproduce"),
    show_default=True,
    help="Folder for the page.",
)
@click.option(
    "--quick", is_flag=True, help=f"Use {QUICK} starts instead of 1000, and set E only: seconds instead of minutes."
)
@click.option("--scan", is_flag=True, help="Also scan the drop over VPCS1 and the gain of PCS11 (some minutes more).")
@json_option
@user_errors
def command(out: Path, quick: bool, scan: bool, json_file: str | None) -> None:
    """Regenerate tables 5.4, 6.1, 6.2, the ideal loops and figures 4.1 to 7.3 and B.1 to B.4, as one HTML page.

    \b
    Examples:
      stickslip reproduce
      stickslip reproduce --quick --out pages --json -

    \b
    Exit codes: 0 done (whether met or not), 2 the page cannot be written.
    """
    check_targets({"--json": json_file})
    check_folder(out)
    say = Speaker(json_file)
    with _progress() as tell:
        found, own_starts = _rows(quick, tell)
        points = _scan(tell) if scan else []
        if points:
            from stickslip.cases import choice

            found += choice.rows(points)
        headline = _headline(found, own_starts)
        page = _page(found, points, headline, tell).encode()
    for table in dict.fromkeys(row.table for row in found):
        say(title(table), bold=True)
        say.table(_columns(table), [_cells(row) for row in found if row.table == table])
    for row in _own(found):
        if row.within is False:
            say.paragraph(f"{row.table}, {row.row}: {row.note}", "  not met: ")
    for sentence in headline:
        say(sentence)
    out.mkdir(parents=True, exist_ok=True)
    target = out / "index.html"
    write_whole(target, page)
    say(f"open {target} in a browser: all tables with notes, and the pictures")
    say.document(
        {
            "schema": "stickslip.reproduce/1",
            "page": str(target),
            "quick": quick,
            "headline": headline,
            "rows": [row.to_dict() for row in found],
        }
    )


@contextmanager
def _progress() -> Iterator[Tell]:
    """Show on a terminal what is being done, and for how long."""
    from rich.console import Console
    from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

    columns = (SpinnerColumn(), TextColumn("{task.description}"), TimeElapsedColumn())
    console = Console(file=sys.stderr)
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as bar:
        task = bar.add_task("starting", total=None)
        yield lambda words: bar.update(task, description=words)


def _rows(quick: bool, tell: Tell) -> tuple[list["Row"], "Fresh"]:
    """Return all rows, for comparison also those judged with the sets A, B and C; and set E by sets of starts."""
    from stickslip.cases.kicks import FRESH, KICKS, Studies
    from stickslip.cases.production import SET
    from stickslip.cases.starts import fresh, plant_rows
    from stickslip.cases.tables import table_ideal

    seeds = FRESH[:1] if quick else FRESH

    def doing(number: int, F_s: str, case: int, done: int, total: int) -> None:
        tell(f"set {SET}, starts {number + 1} of {len(seeds)}, case {case}, {F_s} stiction: {done} of {total}")

    main = fresh(SET, seeds, QUICK if quick else KICKS, doing)
    tell("ideal loops")
    found = [*main.rows, *table_ideal()]
    for name in () if quick else ("A", "B", "C"):

        def other(F_s: str, case: int, done: int, total: int, name: str = name) -> None:
            tell(f"set {name}, case {case}, {F_s} stiction: {done} of {total} starts")

        rows = [row for row in plant_rows(Studies(name, KICKS, progress=other)) if row.within is not None]
        found += [replace(row, table=f"{row.table}, set {name}") for row in rows]
    return found, main


def _headline(found: Sequence["Row"], main: "Fresh") -> list[str]:
    """Return what holds on starts that no search has seen, and among the rows that tell parameters apart."""
    from stickslip.cases.production import SET
    from stickslip.cases.starts import grouped

    middle, low, high = main.met()
    over = f"on one set of {main.starts}; ten sets of 100 take a run without --quick"
    if len(main.sets) > 1:
        over = f"the median of {len(main.sets)} sets of {main.starts} ({low} to {high})"
    said = [
        f"set {SET} on starts that were not used to find it: {middle:g} of the plant's {len(main.sets[0])} rows with a "
        f"tolerance are met, {over}"
    ]
    sets = {name: {key: bool(row.within) for key, row in rows.items()} for name, rows in _by_set(found).items()}
    if len(sets) > 1:
        everyone, nobody, rest = grouped(list(sets.values()))
        middle, low, high = main.met(rest)
        others = ", ".join(f"{name} {sum(of[key] for key in rest)}" for name, of in sets.items() if name != SET)
        said.append(
            f"{len(everyone)} of these rows every set of parameters meets and {len(nobody)} none; of the {len(rest)} "
            f"that tell them apart {SET} meets {middle:g} ({low} to {high}), {others}"
        )
    ideal = [row for row in found if row.table == "ideal" and row.within is not None]
    said.append(f"ideal loops: {_met(ideal)} of {len(ideal)} rows with a tolerance are met")
    return said


def _scan(tell: Tell) -> list["Point"]:
    from stickslip.cases.choice import scan

    return scan(progress=lambda done, total: tell(f"scan: {done} of {total} settings"))


def _figures(points: Sequence["Point"]) -> dict[str, Callable[[], "Figure"]]:
    """Return what draws each picture, by its number in the thesis."""
    from stickslip.cases import choice, curves, ideas, valve_pictures

    return {
        "5.1": lambda: curves.key_variables(1), "5.2": lambda: curves.mv_op(1), "5.3": lambda: curves.pv_op(1),
        "5.4": lambda: curves.key_variables(2), "5.5": lambda: curves.mv_op(2), "5.6": lambda: curves.pv_op(2),
        "4.1": valve_pictures.figure_4_1, "4.2": valve_pictures.figure_4_2,
        "6.1": ideas.figure_6_1, "7.1": ideas.figure_7_1, "7.2": ideas.figure_7_2, "7.3": ideas.figure_7_3,
        "B.1": lambda: curves.valve_trends(1), "B.2": lambda: curves.valve_trends(2),
        "B.3": ideas.figure_B_3, "B.4": ideas.figure_B_4,
        "choice": lambda: choice.figure(points),
    }  # fmt: skip


def _page(found: Sequence["Row"], points: Sequence["Point"], headline: Sequence[str], tell: Tell) -> str:
    from stickslip.commands.report.page import Section, captioned, figure_to_svg, page, table_to_html

    drawing = _figures(points)
    own = _own(found)
    sections = [_missed(own)]
    for table in dict.fromkeys(row.table for row in own):
        rows = [row for row in own if row.table == table]
        section = Section(title(table), *_badge(rows), "")
        section.figures.append(
            table_to_html(
                [*_columns(table)[:-1], "tolerance", *(["sets"] if _several(rows) else []), "verdict"],
                [_with_tolerance(row, _several(rows)) for row in rows],
                [_plain(row.note) for row in rows],
                [row.within is False for row in rows],
            )
        )
        for number in FIGURES.get(table, ()):
            tell(f"figure {number}")
            section.figures.append(captioned(figure_to_svg(drawing[number]()), CAPTIONS[number]))
        sections.append(section)
    if len(own) < len(found):
        sections.append(_sets(found))
    contents = [["", "rows"], *([s.title, s.badge] for s in sections)]
    return page("The thesis again", f"{LEAD} {'. '.join(map(_sentence, headline))}.", sections, contents, GUIDE)


def _sentence(text: str) -> str:
    return text[0].upper() + text[1:]


def _badge(rows: Sequence["Row"]) -> tuple[str, str]:
    """Return how many rows are met, and the kind of the badge that says so."""
    judged = [row for row in rows if row.within is not None]
    met = _met(judged)
    others = f", {len(rows) - len(judged)} without tolerance" if len(judged) < len(rows) else ""
    words = f"{met} of {len(judged)} met{others}" if judged else "for comparison"
    return words, "good" if met == len(judged) else "open"


def _met(rows: Sequence["Row"]) -> int:
    return sum(bool(row.within) for row in rows)


def _missed(own: Sequence["Row"]) -> "Section":
    """Return what set E and the ideal loops do not meet, with the reasons: what a reader asks first."""
    from stickslip.commands.report.page import Section, table_to_html

    missed = [row for row in own if row.within is False]
    judged = sum(row.within is not None for row in own)
    section = Section("What is not met, and why", f"{len(missed)} of {judged} rows", "open", "")
    cells = []
    for row in missed:
        name, *others, _verdict = _cells(row)
        cells.append([f"{name} ({title(row.table).partition(':')[0].partition(' (')[0].lower()})", *others])
    section.figures.append(table_to_html(_columns("all")[:-1], cells, [_plain(row.note) for row in missed]))
    return section


def _own(found: Sequence["Row"]) -> list["Row"]:
    """Return the rows of the set behind the cases, and of what has no set."""
    return [row for row in found if ", set " not in row.table]


def _by_set(found: Sequence["Row"]) -> dict[str, dict[tuple[str, str], "Row"]]:
    """Return what is judged of the plant by set of parameters, then by table and row."""
    from stickslip.cases.production import SET

    sets: dict[str, dict[tuple[str, str], Row]] = {SET: {}}
    for row in found:
        table, _, name = row.table.partition(", set ")
        if row.within is not None and table not in ("ideal", "choice"):
            sets.setdefault(name or SET, {})[table, row.row] = row
    return sets


def _sets(found: Sequence["Row"]) -> "Section":
    """Return the plant's rows, one column a set of parameters."""
    from stickslip.commands.report.page import Section, table_to_html

    sets = _by_set(found)
    first = next(iter(sets))
    cells = []
    for key, row in sets[first].items():
        reproduced = [f"{show(r.reproduced)}{'' if r.within else ' ✗'}" for r in (of[key] for of in sets.values())]
        cells.append(
            (f"{_named(row)} ({row.table})", show(row.published), row.tolerance.removeprefix("median "), *reproduced)
        )
    met = ", ".join(f"{name} {_met(list(rows.values()))}" for name, rows in sets.items())
    reason = (
        f"Set {first} is behind everything above; its five numbers were searched for on other starts than these. A "
        "and B were fitted to one case each, C by one number to both. ✗: outside the tolerance. Medians."
    )
    section = Section(
        "The plant's rows with other sets of parameters", f"{met} of {len(sets[first])} met", "open", reason
    )
    section.figures.append(table_to_html(("row", "published", "tolerance", *(f"set {s}" for s in sets)), cells))
    return section


def title(table: str) -> str:
    """Return the heading of a table."""
    own, _, other = table.partition(", ")
    return TITLES[own] + (f", {other}" if other else "")


def _named(row: "Row") -> str:
    return row.row + (f" [{row.unit}]" if row.unit != "-" else "")


def _columns(table: str) -> list[str]:
    return ["row", "published", "reproduced", BANDS.get(table, BANDS[""]), "deviation", "verdict"]


def _cells(row: "Row") -> list[str]:
    deviation = "" if row.deviation is None else f"{100.0 * row.deviation:+.0f} %"
    verdict = {True: "met", False: "NOT met", None: ""}[row.within]
    band = f"{show(row.low)} to {show(row.high)}" if row.low < row.high else "-"  # "-": one number, no band
    return [_named(row), show(row.published), show(row.reproduced), band, deviation, verdict]


def _plain(note: str) -> str:
    return note.replace("+-", "±")


def _several(rows: Sequence["Row"]) -> bool:
    """Return whether these rows were judged on sets of starts."""
    return any(row.held is not None for row in rows)


def _with_tolerance(row: "Row", several: bool) -> list[str]:
    cells = _cells(row)
    held = "" if row.held is None else f"{100.0 * row.held:.0f} %"
    return [*cells[:-1], row.tolerance.removeprefix("median "), *([held] if several else []), cells[-1]]


def show(value: float | None) -> str:
    """Return a number in three digits, '-' where there is none."""
    if value is None or not math.isfinite(value):
        return "-"
    return "0" if abs(value) < 1e-9 else f"{value:.3g}" if abs(value) < 1000.0 else f"{value:.0f}"

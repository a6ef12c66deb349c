"""``stickslip scan``: every loop of a plant judged and ranked."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from stickslip.console import Speaker, json_option, user_errors
from stickslip.targets import check_targets, write_whole

if TYPE_CHECKING:
    from scan import ScanResult
    from scan.changes import Change

SHOWN = 20  # rows on the terminal
PAGE_ROWS = 500  # rows on the page


@click.command("scan")
@click.argument("source")
@click.option(
    "--out", type=click.Path(path_type=Path), default=Path("stickslip-scan"), show_default=True, help="Folder."
)
@click.option("--map", "loop_map", type=click.Path(path_type=Path), help="CSV file that names the tags of each loop.")
@click.option("--workers", type=int, metavar="N", help="Processes (default: one a core).")
@click.option("--cluster", metavar="ADDRESS", help="Dask scheduler to send the work to, e.g. tcp://10.0.0.5:8786.")
@click.option(
    "--simulate", type=click.IntRange(1, 500), metavar="N", help="Simulate the first N under their own conditions."
)
@click.option("--fresh", is_flag=True, help="Throw away what another scan left in the folder.")
@click.option("--html", type=click.Path(path_type=Path), help="Write the ranked list as one page.")
@click.option("--csv", "csv_file", type=click.Path(path_type=Path), help="Write the ranked list as CSV.")
@json_option
@user_errors
def command(
    source: str,
    out: Path,
    html: Path | None,
    csv_file: Path | None,
    json_file: str | None,
    simulate: int | None,
    **told: Any,
) -> None:
    """Judge every loop of SOURCE and rank the valves to look at first.

    SOURCE is a folder of CSV or Parquet files, one wide or long file of a historian, or a query
    'duckdb:SELECT ...'. Loops are told by their tags (FIC101.PV, FIC101.OP, ...), or by --map loops.csv.
    An interrupted scan goes on where it stopped: call it again. --simulate N takes some ten seconds a loop.

    \b
    Examples:
      stickslip scan exports/
      stickslip scan historian.parquet --out monday --html monday.html
      stickslip scan "duckdb:SELECT * FROM 'trends/*.parquet'" --map loops.csv --csv ranked.csv

    \b
    Exit codes:
      0  done, and no loop with stiction found
      1  done, and stiction found in at least one loop
      2  SOURCE cannot be read, or the request makes no sense
    """
    check_targets({"--html": html, "--csv": csv_file, "--json": json_file}, source=Path(source))
    from diagram.progress import reporting
    from scan import scan

    say = Speaker(json_file)
    with reporting(None, 0, "loops") as tell:
        result = scan(source, out, tell=tell, **{name: value for name, value in told.items() if value is not None})
    _tell(say, result)
    beside: dict[str, Any] = {}
    if simulate is not None:
        from stickslip.commands.scan_simulate import simulated

        beside["simulations"] = simulated(result, source, out, simulate, told.get("loop_map"), told.get("workers"))
        for one in beside["simulations"]:
            say.paragraph(f"{one['rank']} {one['loop']}: {' '.join(one['sentences'])}", "  - ")
    say(f"all loops: {out / 'scan.parquet'}")
    if csv_file is not None:
        result.to_csv(csv_file)
        say(f"list: {csv_file}")
    if html is not None:
        write_whole(html, _page(result).encode())
        say(f"page: {html}")
    say.document(result.to_dict() | beside)
    raise SystemExit(1 if result.counts.get("stiction") else 0)


def _tell(say: Speaker, result: "ScanResult") -> None:
    say(_headline(result), bold=True)
    for note in result.notes:
        say.paragraph(note, "  - ")
    head, rows = _rows(result, SHOWN)
    say.table(head[:-3], [row[:-3] for row in rows])
    if len(result.table) > SHOWN:
        say(f"and {len(result.table) - SHOWN} more")
    for change in result.changes[:SHOWN]:
        say(f"  changed: {_changed(change)}")


def _changed(change: "Change") -> str:
    return f"{change.loop}: {_spoken(change.before) or 'new'} -> {_spoken(change.now) or 'gone'}"


def _headline(result: "ScanResult") -> str:
    counts = result.counts
    parts = [f"{number} {_spoken(word)}" for word, number in counts.items()]
    return f"{len(result.table)} loops: {', '.join(parts)}."


def _spoken(word: str) -> str:
    from detect.words import WORDS

    if word == "error":
        return "could not be judged"
    return WORDS[word].spoken if word else ""  # type: ignore[index]  # words of the table are words of a verdict


def _rows(result: "ScanResult", most: int) -> tuple[list[str], list[list[str]]]:
    from detect.judge.actions import CAUSES

    head = ["rank", "loop", "verdict", "probability", "likely cause", "S [% of OP]", "period [s]", "shared with",
            "data", "what to do"]  # fmt: skip
    rows = []
    for row in result.table.head(most).iter_rows(named=True):
        cause = CAUSES[row["cause"]].spoken if row["cause"] else ""
        size = _number(row["S"], ".2g") + ("" if row["size_unit"] in (None, "% of OP") else " (unit of OP)")
        rows.append([
            str(row["rank"]), row["loop"], _spoken(row["verdict"] or "error"), _number(row["probability"], ".2f"),
            cause, size, _number(row["period_s"], ".3g"), row["group"] or "", (row["health"] or "").replace("_", " "),
            (row["error"] or row["action"] or row["reason"] or "")[:300],
        ])  # fmt: skip
    return head, rows


def _number(value: float | None, form: str) -> str:
    return "-" if value is None else format(value, form)


def _page(result: "ScanResult") -> str:
    from stickslip.report.page import Section, figure_to_svg, page, table_to_html

    section = Section("All loops", "", "open", _headline(result))
    section.notes.extend(result.notes)
    section.notes.extend(
        f"{change.loop}: {_spoken(change.before) or 'new'} -> {_spoken(change.now) or 'gone'}"
        for change in result.changes
    )
    head, rows = _rows(result, PAGE_ROWS)
    section.figures += [figure_to_svg(result.plot()), table_to_html(head, rows)]
    return page(f"Scan of {result.source}", "", [section])

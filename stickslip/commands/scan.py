"""``stickslip scan``: every loop of a plant judged and ranked."""

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from stickslip.commands.console import Speaker, complain, json_option, user_errors
from stickslip.commands.short import refuse_short
from stickslip.commands.targets import check_folder, check_targets, write_whole

if TYPE_CHECKING:
    from stickslip.scan import ScanResult
    from stickslip.scan.changes import Change

SHOWN = 20  # rows on the terminal


@click.command("scan")
@click.argument("source")
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    default=Path("stickslip-scan"),
    show_default=True,
    help="Folder for the results.",
)
@click.option("--map", "loop_map", type=click.Path(path_type=Path), help="CSV file that names the tags of each loop.")
@click.option("--workers", type=int, metavar="N", help="Number of processes (default: one per core).")
@click.option("--cluster", metavar="ADDRESS", help="Dask scheduler to send the work to, e.g. tcp://10.0.0.5:8786.")
@click.option(
    "--simulate",
    type=click.IntRange(1, 500),
    metavar="N",
    help="For each of the first N, simulate loops under its own conditions.",
)
@click.option(
    "--cost",
    type=click.IntRange(1, 500),
    metavar="N",
    help="Fit each of the first N loops with stiction, and rank them by what the stick costs; some 15 s a loop.",
)
@click.option("--fresh", is_flag=True, help="Throw away what another scan left in the folder.")
@click.option("--html", type=click.Path(path_type=Path), help="Write the ranked list as one page.")
@click.option(
    "--reports", type=click.IntRange(1, 500), metavar="N", help="With --html: write a page for each of the first N too."
)
@click.option("--csv", "csv_file", type=click.Path(path_type=Path), help="Write the ranked list as CSV.")
@json_option
@user_errors
def command(
    source: str, out: Path, html: Path | None, csv_file: Path | None, json_file: str | None, reports: int | None,
    simulate: int | None, cost: int | None, **stated: Any,
) -> None:  # fmt: skip
    """Judge every loop of SOURCE and rank the valves to look at first.

    SOURCE is a folder of CSV or Parquet files, one wide or long file of a historian, or a query
    'duckdb:SELECT ...'. Loops are recognised by their tags (FIC101.PV, FIC101.OP, ...), or by --map loops.csv.
    An interrupted scan goes on where it stopped: call it again. --simulate N takes about ten seconds per loop.

    \b
    Examples:
      stickslip scan exports/
      stickslip scan exports/ --cost 10
      stickslip scan historian.parquet --out monday --html monday.html --reports 20
      stickslip scan "duckdb:SELECT * FROM 'trends/*.parquet'" --map loops.csv --csv ranked.csv

    \b
    Exit codes:
      0  done, and no loop with stiction found
      1  done, and stiction found in at least one loop
      2  SOURCE cannot be read or is too short for any verdict, or the request makes no sense
    130  stopped by Ctrl-C; the same command goes on
    """
    check_targets({"--html": html, "--csv": csv_file, "--json": json_file}, source=Path(source))
    check_folder(out)
    if reports is not None and html is None:
        raise ValueError("--reports writes beside --html, which is missing; add --html FILE")
    if sys.stderr.isatty():
        click.echo("reading; a first scan on this machine also compiles the detection methods ...", err=True)
    from stickslip.diagram.progress import reporting
    from stickslip.scan import scan

    say = Speaker(json_file)
    try:
        with reporting(None, 0, "loops") as tell:
            result = scan(
                source, out, tell=tell, **{name: value for name, value in stated.items() if value is not None}
            )
    except KeyboardInterrupt:
        complain(f"stopped by the keyboard; what is done is kept in {out}: the same command goes on from there")
        raise SystemExit(130) from None
    judged = result.table.select("loop", "samples", "verdict").drop_nulls("verdict").iter_rows()
    refuse_short((loop, rows, verdict != "not_applicable") for loop, rows, verdict in judged)
    _tell(say, result)
    beside: dict[str, Any] = {}
    if simulate is not None:
        from stickslip.commands.scan_simulate import simulated

        beside["simulations"] = simulated(result, source, out, simulate, stated.get("loop_map"), stated.get("workers"))
        for one in beside["simulations"]:
            say.paragraph(f"{one['rank']} {one['loop']}: {' '.join(one['sentences'])}", "  - ")
    if cost is not None:
        from stickslip.commands.scan_cost import costs

        beside["costs"] = costs(result, source, out, cost, stated.get("loop_map"))
        say("What the stick costs, the dearest first:")
        for one in beside["costs"]:
            say.paragraph(f"{one['loop']}: {one['sentence']}", "  - ")
    say(f"all loops: {out / 'scan.parquet'}")
    if csv_file is not None:
        result.to_csv(csv_file)
        say(f"list: {csv_file}")
    if html is not None:
        from stickslip.commands.scan_page import scan_page

        pages = _reports(result, source, out, html, reports, stated.get("loop_map")) if reports else {}
        write_whole(html, scan_page(result, _headline(result), pages, beside.get("simulations", ())).encode())
        say(f"page: {html}")
    say.document(result.to_dict() | beside)
    raise SystemExit(1 if result.counts.get("stiction") else 0)


def _tell(say: Speaker, result: "ScanResult") -> None:
    say(_headline(result), bold=True)
    for note in result.notes:
        say.paragraph(note, "  - ")
    head, rows = _rows(result, SHOWN)
    say.table(head, rows)
    if len(result.table) > SHOWN:
        say(f"and {len(result.table) - SHOWN} more")
    for change in result.changes[:SHOWN]:
        say(f"  changed: {_changed(change)}")


def _changed(change: "Change") -> str:
    from stickslip.commands.scan_page import spoken

    return f"{change.loop}: {spoken(change.before) or 'new'} -> {spoken(change.now) or 'gone'}"


def _headline(result: "ScanResult") -> str:
    from stickslip.commands.scan_page import spoken

    counts = result.counts
    parts = [f"{number} {spoken(word)}" for word, number in counts.items()]
    return f"{len(result.table)} loops: {', '.join(parts)}."


def _rows(result: "ScanResult", most: int) -> tuple[list[str], list[list[str]]]:
    from stickslip.commands.scan_page import cause, number, size, spoken
    from stickslip.logs.chances import chance

    head = ["rank", "loop", "verdict", "probability", "likely cause", "S [% of OP]", "period [s]"]
    rows = [
        [
            str(row["rank"]), row["loop"], spoken(row["verdict"] or "error"), chance(row["probability"]),
            cause(row), size(row), number(row["period_s"], ".3g"),
        ]
        for row in result.table.head(most).iter_rows(named=True)
    ]  # fmt: skip
    return head, rows


def _reports(
    result: "ScanResult", source: str, out: Path, html: Path, most: int, loop_map: Path | None
) -> dict[int, str]:
    """Write a page for each of the first loops into a folder beside the page of the scan; return where each is."""
    from stickslip.commands.loop_page import loop_page
    from stickslip.commands.scan_page import file_names
    from stickslip.commands.tag_page import tag_page
    from stickslip.detect import diagnose
    from stickslip.diagram.progress import reporting
    from stickslip.scan.again import read_again

    rows = [row for row in result.table.head(most).iter_rows(named=True) if row["verdict"]]
    names = file_names(rows)
    folder = html.with_name(f"{html.stem}-loops")
    folder.mkdir(exist_ok=True)
    valves = {
        row["order"]: (row["loop"], [int(one) for one in row["records"].split()]) for row in rows if row["records"]
    }
    written: dict[int, str] = {}
    with reporting(None, 0, "reports") as tell:

        def keep(order: int, text: str) -> None:
            write_whole(folder / names[order], text.encode())
            written[order] = f"{folder.name}/{names[order]}"
            tell(len(written), len(names))

        for order, record in read_again(source, out, [o for o in names if o not in valves], loop_map=loop_map):
            if not isinstance(record, str):
                keep(order, loop_page(diagnose(record)))
        for order, (name, parts) in valves.items():
            again = read_again(source, out, parts, loop_map=loop_map)
            found = [record for _, record in again if not isinstance(record, str)]
            if found:
                keep(order, tag_page(name, found))
    return written

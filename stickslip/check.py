"""``stickslip check``: one loop from a file, a verdict in words first."""

from pathlib import Path
from typing import Any

import click

from stickslip.console import Speaker, json_option, user_errors, write_whole

STYLE = {"stiction": "red", "no_stiction": "green", "inconclusive": "yellow", "not_applicable": "yellow"}
WORDS = {
    "stiction": "STICTION",
    "no_stiction": "NO STICTION",
    "inconclusive": "INCONCLUSIVE",
    "not_applicable": "NOT APPLICABLE",
}


@click.command("check")
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--pv", help="Name of the measurement column.")
@click.option("--op", help="Name of the controller output column.")
@click.option("--sp", help="Name of the set point column.")
@click.option("--mv", help="Name of the stem position column.")
@click.option("--mode", help="Name of the controller mode column.")
@click.option("--time", help="Name of the time column.")
@click.option("--loop", help="Which loop, when the file holds several.")
@click.option("--process", type=click.Choice(["self_regulating", "integrating"]), help="Kind of process, if known.")
@click.option("--op-span", nargs=2, type=float, metavar="LOW HIGH", help="Span of OP in its own unit.")
@click.option("--html", type=click.Path(path_type=Path), help="Write a one-file report with pictures.")
@json_option
@user_errors
def command(file: Path, html: Path | None, json_file: str | None, **columns: Any) -> None:
    """Say whether the valve of the loop in FILE sticks, and why.

    \b
    Exit codes: 0 done, 1 stiction found, 2 FILE cannot be read.
    """
    from detect import diagnose
    from records import read_loop

    record = read_loop(file, **{name: value for name, value in columns.items() if value is not None})
    diagnosis = diagnose(record)
    say = Speaker(json_file)
    say(f"{diagnosis.loop}: {WORDS[diagnosis.verdict]}", fg=STYLE[diagnosis.verdict], bold=True)
    say(diagnosis.reason)
    say()
    for sentence in diagnosis.assumptions:
        say(f"  assumed: {sentence}")
    rows = [
        [
            verdict.method,
            WORDS[verdict.verdict].lower(),
            "" if verdict.index is None else f"{verdict.index:.3g}",
            "" if verdict.threshold is None else f"{verdict.threshold:.3g}",
            verdict.reason,
        ]
        for verdict in diagnosis.methods
    ]
    say.table("", ["method", "verdict", "index", "threshold", "why"], rows)
    if html is not None:
        from stickslip.page import Section, figure_to_svg, page

        section = Section(diagnosis.loop, WORDS[diagnosis.verdict], diagnosis.verdict, diagnosis.reason)
        section.notes.extend(diagnosis.assumptions)
        section.figures.append(figure_to_svg(diagnosis.plot()))
        write_whole(html, page(f"{diagnosis.loop}: {WORDS[diagnosis.verdict].lower()}", "", [section]).encode())
        say(f"report: {html}")
    say.document(diagnosis.to_dict())
    raise SystemExit(1 if diagnosis.verdict == "stiction" else 0)

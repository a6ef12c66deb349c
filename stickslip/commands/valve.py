"""``stickslip valve``: deadband, resolution and step response from a step test or from routine moves."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from stickslip.commands.console import Speaker, json_option, user_errors
from stickslip.commands.reading import form_options
from stickslip.commands.targets import check_targets, write_whole

if TYPE_CHECKING:
    from stickslip.detect.valve_test import ValveTest


@click.command("valve")
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--pv", metavar="COLUMN", help="Name of the measurement column.")
@click.option("--op", metavar="COLUMN", help="Name of the controller output column.")
@click.option("--mv", metavar="COLUMN", help="Name of the stem position column.")
@form_options
@click.option("--loop", metavar="TAG", help="Name of the loop, where the file holds several.")
@click.option("--op-span", nargs=2, type=float, metavar="LOW HIGH", help="Span of OP in its own unit.")
@click.option("--html", type=click.Path(path_type=Path), help="Write a one-file report with the picture.")
@json_option
@user_errors
def command(file: Path, html: Path | None, json_file: str | None, **stated: Any) -> None:
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
    from stickslip.detect.valve_test import analyse
    from stickslip.logs import read_loop

    test = analyse(read_loop(file, **{name: value for name, value in stated.items() if value is not None}))
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
    from stickslip.commands.report.page import (
        Section,
        captioned,
        figure_to_svg,
        page,
        pairs,
        side_by_side,
        table_to_html,
    )

    found = Section("What the valve does", f"{len(test.steps)} steps" if test.steps else test.source, "open", "")
    found.reason = " ".join(test.words)
    sizes = {"Deadband": test.deadband, "Resolution": test.resolution, "Slip jump": test.slip_jump}
    found.figures.append(
        pairs(
            {
                name: "the record does not show it" if size is None else
                f"{size.value:.2g} % of OP, between {size.low:.2g} and {size.high:.2g} (read at {size.count} places)"
                for name, size in sizes.items()
            }
            | ({} if test.gain is None else {"Gain": f"{test.gain:.3g} of {test.answer} for each % of OP"})
        )
    )  # fmt: skip
    found.figures.append(captioned(figure_to_svg(test.plot()), "Triangles: steps that were timed."))
    found.notes.extend((*test.notes, "ANSI/ISA-75.25.01 defines these figures and sets no limits for them."))
    sections = [found]
    drawn = test.plot_responses()
    if drawn is not None:
        timed = Section("Step responses", f"{len(test.responses)} timed", "open", "")
        timed.reason = "Td: first move beyond the noise. T63, T86: 63.2 and 86.5 % of the final change are reached."
        timed.figures.append(side_by_side([figure_to_svg(drawn)]))
        head = ["at [s]", "step [% of OP]", "Td [s]", "T63 [s]", "T86 [s]", "overshoot [%]"]
        rows = [
            [f"{r.time:g}", f"{r.size:+.3g}", *("-" if x is None else f"{x:.3g}" for x in (r.dead_time, r.T63, r.T86)),
             f"{100.0 * r.overshoot:.0f}"]
            for r in test.responses
        ]  # fmt: skip
        timed.figures.append(table_to_html(head, rows))
        sections.append(timed)
    return page(f"{test.name}: valve test", "", sections)

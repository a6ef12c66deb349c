"""``stickslip study``: many runs over parameters and starts, kept as Parquet, and how oscillation spreads."""

import json
import math
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from stickslip.commands.console import Speaker, complain, json_option, user_errors
from stickslip.commands.simulate import METHODS
from stickslip.commands.targets import check_folder, check_targets, write_figure, write_whole

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from stickslip.cases import Case
    from stickslip.study import StudyResult, Subject

PLANT_EVERY = 0.5  # s: ten to a hundred rows a cycle
SHOWN_REASONS = 5
AT_TIME = r" \(at t = [^)]*\)"  # in the reason of a run
STILL = 1e-6  # % of the operating point: below it nothing moves
LEAD = (
    "Every run is measured from {since:g} to {until:g} s: amplitude is half of peak to peak, in % of the mean of the "
    "run; the period is the mean time between turns from low to high, counted with a hysteresis of 0.3 amplitudes."
)
BARS = "Lines are medians, bars 5 to 95 % of the runs that oscillate."
TITLES = {
    "spread": ("Along the chain", f"Left to right: what falls is damped on the way. {BARS}"),
    "growth": ("Over the first parameter", f"How amplitude and period change with it. {BARS}"),
    "map": ("Over two parameters", "Amplitude; each map has a scale of its own."),
}


@click.command("study")
@click.argument("case")
@click.option("--vary", multiple=True, metavar="BLOCK.PARAM=VALUES", help="Vary a parameter of a block; repeatable.")
@click.option(
    "--plant",
    multiple=True,
    metavar="NAME=VALUES",
    help="Vary a quantity of the plant, which is built at its new steady state; repeatable.",
)
@click.option("--start", multiple=True, metavar="BLOCK.STATE=VALUES", help="Vary a start value; repeatable.")
@click.option("--random", type=int, metavar="N", help="Draw N points (Latin hypercube) from the distributions.")
@click.option("--kicks", type=int, metavar="N", help="Run every point from N disturbed starts; 0: from rest.")
@click.option(
    "--kick-size",
    type=float,
    metavar="SHARE",
    default=0.03,
    show_default=True,
    help="Largest disturbance, as a share of the start value.",
)
@click.option(
    "--seed", type=int, metavar="N", default=2009, show_default=True, help="Seed of starts and random points."
)
@click.option("--duration", type=float, metavar="SECONDS", help="Time to simulate, instead of the case's own.")
@click.option(
    "--every", type=float, metavar="SECONDS", help="Log interval (default: 0.5 for the plant, else the case's own)."
)
@click.option(
    "--from",
    "measure_from",
    type=float,
    metavar="SECONDS",
    help="Measure from this time on (default: half the duration).",
)
@click.option(
    "--signals", metavar="A,B,...", help="Signals to measure, in the order to draw (default: valve to shaft)."
)
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    default=Path("stickslip-study"),
    show_default=True,
    help="Folder for the results.",
)
@click.option(
    "--workers", type=int, metavar="N", help="Number of threads (default: one per core; on a cluster one per worker)."
)
@click.option("--cluster", metavar="ADDRESS", help="Dask scheduler to send the runs to, e.g. tcp://10.0.0.5:8786.")
@click.option(
    "--method", type=click.Choice(METHODS), help="How to integrate (default: as the case is best integrated)."
)
@click.option(
    "--rtol", type=float, metavar="NUMBER", default=1e-6, show_default=True, help="Relative error allowed per step."
)
@click.option("--fresh", is_flag=True, help="Throw away what another study left in the folder.")
@click.option(
    "--longest", type=float, metavar="HOURS", default=24.0, show_default=True, help="Time that the study may take."
)
@json_option
@user_errors
def command(
    case: str, vary: tuple[str, ...], plant: tuple[str, ...], start: tuple[str, ...], random: int | None,
    kicks: int | None, kick_size: float, seed: int, duration: float | None, every: float | None,
    measure_from: float | None, signals: str | None, out: Path, workers: int | None, cluster: str | None,
    fresh: bool, longest: float, method: str | None, rtol: float, json_file: str | None,
) -> None:  # fmt: skip
    """Sweep parameters of a CASE in parallel and draw how oscillation spreads from valve to shaft.

    \b
    VALUES are a,b,c or low:high:count (':log' added: even ratios) or uniform(low,high), loguniform(low,high),
    normal(mean,sd). Lists form a grid; distributions share the points of --random. A call with the same request goes on
    where the last one stopped. A case of your own is FILE.py:FUNCTION: that file IS EXECUTED.

    \b
    Examples:
      stickslip study plant_1_high --vary VPCS1.F_s=1250:2250:5 --vary PCS11.K_p=5e-7,8.8e-7 --kicks 20
      stickslip study plant_1_high --plant F_in=6500:8500:5 --plant F_s=none,normal,high --kicks 10
      stickslip study plant_2_high --plant 'slug.flow=uniform(0,800)' --plant 'D=uniform(3e5,8e5)' --random 200
      stickslip study ideal_integrating --vary valve.F_s=1750:3000:11 --vary controller.K_p=0.1:0.4:4:log

    \b
    Exit codes: 0 done, 2 the request makes no sense, 130 stopped by the keyboard (what is finished is kept).
    """
    from stickslip.commands.own import case_named

    chosen = case_named(case)
    check_targets({"--json": json_file})
    check_folder(out)
    if not (math.isfinite(longest) and longest > 0.0):
        raise ValueError(f"--longest {longest:g}: give a positive number of hours")
    subject = subject_of(chosen)
    method = method or subject.settings.method
    from stickslip.study import study

    say = Speaker(json_file)
    result = study(
        subject, _axes("--vary", vary), plant=_axes("--plant", plant), start=_axes("--start", start), random=random,
        kicks=kicks, kick_size=kick_size, seed=seed, duration=chosen.duration if duration is None else duration,
        every=_interval(chosen, every), measure_from=measure_from,
        signals=None if signals is None else [s.strip() for s in signals.split(",") if s.strip()],
        method=method, rtol=rtol, atol=1e-3 * rtol, workers=workers, cluster=cluster, out=out,
        fresh=fresh, longest=3600.0 * longest,
    )  # fmt: skip
    if not result.complete:
        complain(f"stopped by the keyboard; {len(result)} finished runs are kept in '{out}', the same command goes on")
        raise SystemExit(130)
    say(f"{chosen.name}: {chosen.title}", bold=True)
    counts = result.counts()
    counted = [f"{count} {name}" for name, count in counts.items() if count]
    say(f"{len(result)} runs in {result.seconds:.3g} s: {', '.join(counted)}")
    figures = result.figures() if counts["ok"] else {}
    for name in TITLES:
        if name in figures:
            write_figure(figures[name], out / f"{name}.png")
        else:  # of another study that was here
            (out / f"{name}.png").unlink(missing_ok=True)
    write_whole(out / "index.html", _page(result, figures).encode())
    columns, rows = _summary(result)
    say("amplitude in % of the operating point, median over the runs that oscillate:")
    say.table(columns, rows)
    for reason, count in _reasons(result)[:SHOWN_REASONS]:
        say.paragraph(f"{count} x {reason}", "  without a result: ")
    if counts["ok"] and _still(result):
        say("nothing oscillates: a plant at rest stays there; start it from kicks with --kicks N")
    say(f"open {out / 'index.html'} in a browser; all numbers are in {out / 'study.parquet'}")
    say.document(
        {
            "schema": "stickslip.study/1",
            "case": chosen.name,
            "folder": str(out),
            "request": dict(result.request),
            "runs": len(result),
            **counts,
            "seconds": result.seconds,
            "pictures": [f"{name}.png" for name in figures],
            "columns": columns,
            "rows": rows,
        }
    )


def subject_of(case: "Case") -> "Subject":
    """Return a case as the subject of a study; the plant's cases can be rebuilt at another rest.

    >>> from stickslip.cases import find
    >>> subject_of(find("plant_1_high")).quantities["D"], subject_of(find("ideal_high")).signals
    (410000.0, ('OP', 'MV', 'PV'))
    """
    from stickslip.cases import production
    from stickslip.study import production_subject
    from stickslip.study.production import like_the_plant
    from stickslip.study.subject import as_subject

    if case.name not in production.CASES_BY_NAME:
        diagram = case.build()
        return like_the_plant(diagram) or as_subject(diagram)
    _, number, F_s, *other = case.name.split("_")
    subject = production_subject(production.SET, F_s, int(number), name=case.name)
    kick = production.TWO_JUMPS if other else production.KICK
    kicked = partial(production.started, kick=kick)
    return subject if number == "2" or F_s == "none" else replace(subject, start=kicked)


def _axes(option: str, given: Sequence[str]) -> dict[str, object]:
    from stickslip.study import StudyError, parse

    found: dict[str, object] = {}
    for text in given:
        name, values = parse(text)
        if name in found:
            raise StudyError(f"{option} {name} is given twice; give all its values at once")
        found[name] = values
    return found


def _interval(case: "Case", every: float | None) -> float:
    if every is not None:
        return every
    return PLANT_EVERY if case.name.startswith("plant") else case.every


def _summary(result: "StudyResult") -> tuple[list[str], list[list[str]]]:
    """Return the median amplitudes of some signals, one row a value of the first varied axis."""
    from stickslip.study.groups import Group, groups
    from stickslip.study.growth import chosen

    varied = result.varied()
    signals = chosen(result.signals)
    rows, swings = [], result.swings()
    for group in groups(result, varied[0] if varied else None):
        moving = Group(group.label, group.at, group.runs & swings)
        medians = (moving.band(result.percent(signal)).median for signal in signals)
        counts = (str(int(runs.sum())) for runs in (group.runs, group.runs & ~swings))
        rows.append([group.label, *counts, *(_short(m) for m in medians)])
    return [varied[0].name if varied else "", "runs", "at rest", *signals], rows


def _short(value: float) -> str:
    return "-" if not math.isfinite(value) else "0" if value < STILL else f"{value:.3g}"


def _still(result: "StudyResult") -> bool:
    import numpy as np

    moved = np.concatenate([result.percent(signal) for signal in result.signals])
    return not (moved[np.isfinite(moved)] > STILL).any()


def _reasons(result: "StudyResult") -> list[tuple[str, int]]:
    """Return why runs have no result, the most frequent first; when each ended is left out, so that alike is alike."""
    import re
    from collections import Counter

    failed = result.table.filter(result.table["status"] != "OK")
    reasons = (
        f"{status.lower().replace('_', ' ')}: {re.sub(AT_TIME, '', reason)}"
        for status, reason in failed.select("status", "reason").iter_rows()
    )
    return Counter(reasons).most_common()


def _page(result: "StudyResult", figures: "dict[str, Figure]") -> str:
    from stickslip.commands.report.page import Section, figure_to_svg, page, table_to_html
    from stickslip.study.summary import summary

    request = result.request
    sections = []
    said = summary(result) if result.counts()["ok"] else {"": "No run reached its end."}
    for name, figure in figures.items():
        title, how = TITLES[name]
        section = Section(title, f"{result.counts()['ok']} runs", "good", said.get(name, ""), after=how)
        section.figures.append(figure_to_svg(figure))
        sections.append(section)
    columns, rows = _summary(result)
    numbers = Section("Amplitudes", "median of the runs that oscillate, % of the operating point", "good", "")
    numbers.figures.append(table_to_html(columns, rows))
    sections.append(numbers)
    reasons = _reasons(result)
    if reasons:
        count = sum(n for _, n in reasons)
        missing = Section("Runs without a result", f"{count} of {len(result)}", "open", "Most frequent first.")
        missing.figures.append(table_to_html(["runs", "reason"], [[str(n), text] for text, n in reasons[:50]]))
        sections.append(missing)
    asked = Section("The request", "request", "good", "The same request on the same folder changes nothing.")
    asked.figures.append(table_to_html(["", ""], [[key, _spelt(value)] for key, value in request.items()]))
    sections.append(asked)
    lead = LEAD.format(since=request["measure_from"], until=request["duration"])
    return page(f"Study of {request['subject']}", f"{said['']} {lead}", sections)


def _spelt(value: Any) -> str:
    return value if isinstance(value, str) else json.dumps(value)

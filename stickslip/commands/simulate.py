"""``stickslip simulate``: run a named case, save its log, and compare published with reproduced numbers on request."""

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from stickslip.commands.console import Speaker, complain, json_option, user_errors
from stickslip.commands.kept import kept
from stickslip.commands.targets import check_targets, write_figure

if TYPE_CHECKING:
    from stickslip.cases import Case
    from stickslip.logs import Log

METHODS = ("auto", "explicit", "stiff")  # of stickslip.diagram.simulate, named here so that help stays quick
LOGS, PICTURES = (".csv", ".parquet"), (".png", ".svg", ".pdf")
MOST_ROWS = 10_000_000  # some 500 MB of log


@click.command("simulate")
@click.argument("case", required=False)
@click.option("--list", "listed", is_flag=True, help="List all cases and stop.")
@click.option("--out", type=click.Path(path_type=Path), help="Write the log (.csv or .parquet).")
@click.option("--plot", "picture", type=click.Path(path_type=Path), help="Draw the trends (.png, .svg or .pdf).")
@click.option("--diagram", type=click.Path(path_type=Path), help="Draw the block diagram (.png, .svg or .pdf).")
@click.option("--set", "settings", multiple=True, metavar="BLOCK.PARAM=VALUE", help="Change a parameter; repeatable.")
@click.option("--duration", type=float, metavar="SECONDS", help="Time to simulate, instead of the case's own.")
@click.option("--every", type=float, metavar="SECONDS", help="Log interval, instead of the case's own.")
@click.option("--method", type=click.Choice(METHODS), default="auto", show_default=True, help="How to integrate.")
@click.option(
    "--rtol", type=float, metavar="NUMBER", default=1e-6, show_default=True, help="Relative error allowed per step."
)
@click.option("--max-step", type=float, metavar="SECONDS", help="Largest step, e.g. for functions of time that jump.")
@click.option("--numbers/--no-numbers", default=False, help="Also reproduce the case's published numbers.")
@json_option
@user_errors
def command(
    case: str | None, listed: bool, out: Path | None, picture: Path | None, diagram: Path | None,
    settings: tuple[str, ...], duration: float | None, every: float | None, method: str, rtol: float,
    max_step: float | None, numbers: bool, json_file: str | None,
) -> None:  # fmt: skip
    """Run a named CASE; 'stickslip simulate --list' shows them all.

    A case of your own is FILE.py:FUNCTION: that file IS EXECUTED, and the function, called without arguments, returns
    a wired diagram or a stickslip.cases.Case.

    \b
    Examples:
      stickslip simulate --list
      stickslip simulate ideal_high --numbers
      stickslip simulate my_loop.py:loop --duration 3600 --plot trend.png
      stickslip simulate cascade_flow --plot trends.png --diagram blocks.png
      stickslip simulate ideal_high --set valve.F_s=1750 --out log.csv --plot trend.png

    \b
    Exit codes: 0 done, 2 the request makes no sense or the run stopped early, 130 stopped by the keyboard.
    """
    from stickslip.commands.own import case_named

    say = Speaker(json_file)
    if listed:
        _list(say)
        return
    if case is None:
        raise ValueError("name a CASE; 'stickslip simulate --list' shows them all")
    chosen = case_named(case)
    check_targets(
        {"--out": out, "--plot": picture, "--diagram": diagram, "--json": json_file},
        {"--out": LOGS, "--plot": PICTURES, "--diagram": PICTURES},
    )
    params = parameters(settings)
    span, step = times_of(chosen, duration, every)
    from stickslip.diagram import simulate

    built = chosen.build()
    run = simulate(
        built, span, every=step, params=params or None, method=method, rtol=rtol, atol=1e-3 * rtol, max_step=max_step
    )
    say(f"{chosen.name}: {chosen.title}", bold=True)
    say(chosen.about)
    cost = run.statistics
    reached = span if run.ok else _reached(run.log)
    say(f"{reached:g} s simulated, {len(run.log)} rows, {cost.steps} steps, {len(run.events)} mode changes")
    for note in run.notes:
        say.paragraph(note, "note: ")
    if out is not None:
        _write(run.log, out)
        say(f"log: {out}")
    if picture is not None:
        write_figure(run.plot(chosen.signals or None), picture)
        say(f"trends: {picture}")
    if diagram is not None:
        write_figure(built.plot(), diagram)
        say(f"diagram: {diagram}")
    found = [number.to_dict() for number in chosen.numbers()] if numbers else []
    if found:
        say("the case's own numbers, from runs of their own" + (" (without --set)" if params else "") + ":")
        say.table(["quantity", "published", "analytic", "reproduced"], [_row(n) for n in found])
        for number in found:
            say.paragraph(number["note"], f"  {number['quantity']}: ")
    say.document(
        {
            "schema": "stickslip.simulate/1",
            "case": chosen.name,
            "title": chosen.title,
            "status": run.status.name.lower(),
            "hint": run.hint,
            "notes": list(run.notes),
            "duration_s": reached,
            "rows": len(run.log),
            "mode_changes": len(run.events),
            "steps": cost.steps,
            "final": _finite({name: float(run.log[name][-1]) for name in run.log.names}),
            "numbers": [_finite(number) for number in found],
        }
    )
    if not run.ok:
        complain(f"the run stopped early, rows after that are empty: {run.hint}")
        raise SystemExit(130 if run.status.name == "INTERRUPTED" else 2)


def _list(say: Speaker) -> None:
    """Show all cases."""
    cases = kept("cases", _cases)
    say.table(["case", "what it is"], [[case["name"], case["title"]] for case in cases])
    say.document({"schema": "stickslip.cases/1", "cases": cases})


def _cases() -> list[dict[str, str]]:
    from stickslip.cases import find, names

    return [{"name": case.name, "title": case.title, "about": case.about} for case in map(find, names())]


def times_of(case: "Case", duration: float | None, every: float | None) -> tuple[float, float]:
    """Return duration and log interval [s]; refuse what would fill the memory before the run."""
    span = case.duration if duration is None else duration
    step = every if every is not None else min(case.every, span) if span > 0.0 else case.every
    if span > 0.0 and step > 0.0 and math.isfinite(span) and span / step > MOST_ROWS:
        raise ValueError(
            f"{span:g} s logged every {step:g} s are {span / step:.3g} rows, but a log holds at most {MOST_ROWS:,}; "
            "give a longer --every"
        )
    return span, step


def parameters(settings: tuple[str, ...]) -> dict[str, float]:
    """Return ``NAME=VALUE`` settings by name; raise ``ValueError`` for one that is none, or given twice."""
    values = {}
    for setting in settings:
        name, _, value = setting.partition("=")
        if name.strip() in values:
            raise ValueError(f"--set {name.strip()} is given twice; give it once")
        try:
            values[name.strip()] = float(value)
        except ValueError:
            raise ValueError(f"--set {setting}: write BLOCK.PARAM=NUMBER, e.g. --set valve.F_s=1750") from None
    return values


def _write(log: "Log", path: Path) -> None:
    real = path.resolve()  # a link keeps pointing where it did
    try:
        log.to_parquet(real) if path.suffix.lower() == ".parquet" else log.to_csv(real)
    except OSError as fault:
        raise ValueError(f"{path} cannot be written ({fault.strerror or fault}); choose another place") from None


def _reached(log: "Log") -> float:
    """Return the time of the last row of a run that stopped early [s]; rows after it are empty."""
    rows = zip(log.t.tolist(), log[log.names[0]].tolist(), strict=True)
    return max((t for t, value in rows if math.isfinite(value)), default=0.0)


def _finite(values: dict[str, Any]) -> dict[str, Any]:
    """Return the values with null where JSON has no number."""
    return {k: None if isinstance(v, float) and not math.isfinite(v) else v for k, v in values.items()}


def _row(number: dict[str, Any]) -> list[str]:
    def show(value: float | None) -> str:
        return "-" if value is None else f"{value:.4g}"

    unit = f" [{number['unit']}]" if number["unit"] != "-" else ""
    spread = f" ± {number['spread']:.2g}" if number["spread"] is not None else ""
    where = f" ({number['source']})" if number["source"] else ""
    return [
        number["quantity"] + unit,
        show(number["published"]) + (where if number["published"] is not None else ""),
        show(number["analytic"]),
        show(number["reproduced"]) + spread,
    ]

"""``stickslip simulate``: run a named case, save what it gives, show published beside reproduced."""

from pathlib import Path
from typing import Any

import click

from stickslip.console import Speaker, json_option, user_errors


@click.command("simulate")
@click.argument("case")
@click.option("--out", type=click.Path(path_type=Path), help="Write the log (.csv or .parquet).")
@click.option("--plot", "picture", type=click.Path(path_type=Path), help="Draw the trends (.png, .svg or .pdf).")
@click.option("--diagram", type=click.Path(path_type=Path), help="Draw the block diagram (.png, .svg or .pdf).")
@click.option("--set", "settings", multiple=True, metavar="BLOCK.PARAM=VALUE", help="Change a parameter; repeatable.")
@click.option("--duration", type=float, help="Seconds to simulate instead of the case's own.")
@click.option("--every", type=float, help="Log interval in seconds instead of the case's own.")
@click.option("--numbers/--no-numbers", default=False, help="Also reproduce the case's published numbers.")
@json_option
@user_errors
def command(
    case: str, out: Path | None, picture: Path | None, diagram: Path | None, settings: tuple[str, ...],
    duration: float | None, every: float | None, numbers: bool, json_file: str | None,
) -> None:  # fmt: skip
    """Run the CASE: ideal_high, ideal_normal, ideal_half_gain, ideal_integrating or sine.

    \b
    Examples:
      stickslip simulate ideal_high --numbers
      stickslip simulate ideal_high --set valve.F_s=1750 --out log.csv --plot trend.png
    """
    from cases import find
    from plant import simulate

    chosen = find(case)
    log_to = _log_writer(out)
    built = chosen.build()
    run = simulate(
        built, duration or chosen.duration, every=every or chosen.every, params=_parameters(settings) or None
    )
    say = Speaker(json_file)
    say(f"{chosen.name}: {chosen.title}", bold=True)
    say(chosen.about)
    cost = run.statistics
    say(f"{run.log.duration:g} s simulated, {len(run.log)} rows, {cost.steps} steps, {len(run.events)} mode changes")
    if not run.ok:
        say(f"stopped early: {run.hint}", fg="yellow")
    if log_to is not None:
        log_to(run.log)
        say(f"log: {out}")
    if picture is not None:
        _save(run.plot(), picture)
        say(f"trends: {picture}")
    if diagram is not None:
        _save(built.plot(), diagram)
        say(f"diagram: {diagram}")
    found = [number.as_dict() for number in chosen.numbers()] if numbers else []
    if found:
        say.table("", ["quantity", "published", "analytic", "reproduced", "why they differ"], [_row(n) for n in found])
    say.document(
        {
            "schema": "stickslip.simulate/1",
            "case": chosen.name,
            "title": chosen.title,
            "status": run.status.name.lower(),
            "hint": run.hint,
            "duration_s": run.log.duration,
            "rows": len(run.log),
            "mode_changes": len(run.events),
            "steps": cost.steps,
            "final": {name: float(run.log[name][-1]) for name in run.log.names} if run.ok else None,
            "numbers": found,
        }
    )


def _log_writer(out: Path | None) -> Any:
    """Return how to write the log, refusing an unknown format before the run."""
    if out is None:
        return None
    if out.suffix == ".csv":
        return lambda log: log.to_csv(out)
    if out.suffix == ".parquet":
        return lambda log: log.to_parquet(out)
    raise ValueError(f"--out {out}: '{out.suffix}' is not a format of logs; use .csv or .parquet")


def _parameters(settings: tuple[str, ...]) -> dict[str, float]:
    values = {}
    for setting in settings:
        name, _, value = setting.partition("=")
        try:
            values[name.strip()] = float(value)
        except ValueError:
            raise ValueError(f"--set {setting}: write BLOCK.PARAM=NUMBER, e.g. --set valve.F_s=1750") from None
    return values


def _save(figure: Any, path: Path) -> None:
    if path.suffix not in (".png", ".svg", ".pdf"):
        raise ValueError(f"{path}: '{path.suffix}' is not a picture format; use .png, .svg or .pdf")
    figure.savefig(path, dpi=150, bbox_inches="tight")


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
        number["note"],
    ]

"""``stickslip linearise``: operating point, poles, loops and relative gains of a named case."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from stickslip.commands.console import Speaker, json_option, user_errors
from stickslip.commands.simulate import PICTURES, parameters
from stickslip.commands.targets import check_targets, write_figure

if TYPE_CHECKING:
    from stickslip.diagram.linear import Linear, Loop, Rga


@click.command("linearise")
@click.argument("case")
@click.option("--loop", "loops", multiple=True, metavar="CONTROLLER", help="Only this loop; repeatable.")
@click.option("--set", "settings", multiple=True, metavar="BLOCK.PARAM=VALUE", help="Change a parameter; repeatable.")
@click.option(
    "--at",
    "t",
    type=float,
    metavar="SECONDS",
    default=0.0,
    show_default=True,
    help="Time whose source values are held.",
)
@click.option("--plot", "bode", type=click.Path(path_type=Path), help="Draw the Bode plots (.png, .svg or .pdf).")
@click.option("--poles", "poles", type=click.Path(path_type=Path), help="Draw the poles (.png, .svg or .pdf).")
@json_option
@user_errors
def command(
    case: str, loops: tuple[str, ...], settings: tuple[str, ...], t: float, bode: Path | None, poles: Path | None,
    json_file: str | None,
) -> None:  # fmt: skip
    """Find where a CASE rests and show it as a control engineer does: poles, loops, relative gains.

    Friction in the valves is left out. 'stickslip simulate --list' shows all cases. A case of your own is
    FILE.py:FUNCTION: that file IS EXECUTED.

    \b
    Examples:
      stickslip linearise plant_1_none
      stickslip linearise plant_1_high --loop PCS11 --loop LCS11 --plot bode.png --poles poles.png

    \b
    Exit codes: 0 done, 2 the request makes no sense or the case has no steady state.
    """
    from stickslip.commands.own import case_named

    chosen = case_named(case)
    check_targets({"--plot": bode, "--poles": poles, "--json": json_file}, {"--plot": PICTURES, "--poles": PICTURES})
    from stickslip.diagram.linear import linearise, operating_point
    from stickslip.diagram.linear.poles import table

    diagram = chosen.build()
    params = parameters(settings)
    point = operating_point(diagram.with_params(params) if params else diagram, t=t)
    linear = linearise(point.diagram, t)
    names = tuple(dict.fromkeys(loops)) or linear.controllers
    shown = [linear.loop(name) for name in names]
    say = Speaker(json_file)
    say(f"{chosen.name}: {chosen.title}", bold=True)
    say(f"at rest, {len(linear.states)} states, {'stable' if linear.stable else 'NOT stable'}")
    say.table(["pole [1/s]", "time constant [s]", "damping", "made of"], [list(row) for row in table(linear.poles)])
    if shown:
        heads = ["loop", "PV", "OP", "crossover [rad/s]", "phase margin [°]", "gain margin", "delay margin [s]"]
        say.table(heads, [_words(loop) for loop in shown])
    gains = _gains(linear, names if loops else ())
    if gains is not None:
        say("relative gains, steady (rows PV, columns OP):")
        say.table(["", *gains.OPs], [
            [PV, *(f"{value:.3f}" for value in row)] for PV, row in zip(gains.PVs, gains.values.real, strict=True)
        ])  # fmt: skip
    if bode is not None:
        write_figure(linear.bode(names), bode)
        say(f"Bode plots: {bode}")
    if poles is not None:
        write_figure(linear.plot(), poles)
        say(f"poles: {poles}")
    say.document(
        {
            "schema": "stickslip.linearise/1",
            "case": chosen.name,
            "stable": linear.stable,
            "signals": dict(point.signals),
            "poles": [
                {"real": p.value.real, "imag": p.value.imag, "held": p.held, "states": dict(p.states[:4])}
                for p in linear.poles
            ],
            "loops": [_plain(loop) for loop in shown],
            "relative_gains": None if gains is None else gains.values.real.tolist(),
        }
    )


def _gains(linear: "Linear", loops: Sequence[str]) -> "Rga | None":
    """Return the relative gain array of the loops named, or of all; None where there are not two to compare."""
    try:
        found = linear.rga(loops or None)
    except ValueError:  # singular, e.g. the loops named command one another
        return None
    return found if len(found.controllers) > 1 else None


def _words(loop: "Loop") -> list[str]:
    def show(value: float | None, digits: int = 3) -> str:
        return "-" if value is None else f"{value:.{digits}g}"

    plain = _plain(loop)
    margins = (show(plain["crossover"]), show(plain["phase_margin"]), show(plain["gain_margin"]))
    return [loop.controller, loop.PV, loop.OP, *margins, show(plain["delay_margin"])]


def _plain(loop: "Loop") -> dict[str, Any]:
    """Return the loop for JSON: null where it has no such margin."""
    import math

    values = {
        "crossover": loop.crossover, "phase_margin": loop.phase_margin, "gain_margin": loop.gain_margin,
        "delay_margin": loop.delay_margin,
    }  # fmt: skip
    finite = {key: value if math.isfinite(value) else None for key, value in values.items()}
    return {"controller": loop.controller, "PV": loop.PV, "OP": loop.OP, **finite}

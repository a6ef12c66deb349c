"""The commands; each lives in a file of its own and imports what it needs only when it runs."""

import importlib
from pathlib import Path

import click

from stickslip import __version__

COMMANDS = {
    "demo": "five short stories with known truth, and two real loops, as one HTML page",
    "check": "read one loop from a file and say whether its valve sticks",
    "fit": "fit a loop to its own log: controller, valve, process, load and noise, with intervals",
    "remedy": "what to do about a sticky valve until the shutdown, each remedy tried on the fitted loop",
    "valve": "deadband, resolution and step response of a valve from a step test",
    "table": "all detection methods side by side on a file, a folder or a case; --cards describes them",
    "scan": "judge every loop of a folder, a historian file or a query, and rank the valves to look at",
    "simulate": "run a named case, save its log, draw it; --numbers shows published beside reproduced",
    "linearise": "find where a case rests; its poles, loops and relative gains",
    "reproduce": "regenerate the thesis's results, tables 5.4 to 6.2 and their figures, published beside reproduced",
    "study": "sweep parameters in parallel and draw how oscillation spreads from valve to shaft",
    "gap": "say where a model and a record part, which effect explains it, how far the gap shrinks",
    "blocks": "list all blocks with ports and units, or show the page of one",
}

HELP = """Sticky control valves: simulate them, find them in routine data.

\b
Start here:
  stickslip demo                      see what this is about (writes stickslip-demo/index.html)
  stickslip check my_loop.csv         is the valve sticking? in words first
  stickslip check my_loop.csv --op OUT.CV --pv PV.CV --process integrating
  stickslip remedy my_loop.csv        what to do about it until the shutdown
  stickslip table my_loop.csv         what every detection method says of it
  stickslip simulate ideal_high --numbers   the thesis's loop: published beside reproduced

\b
A file for 'check' is CSV or Parquet with a time column and OP (controller output),
PV (measurement) and, if logged, SP (set point), MV (stem position), MODE.
Everything that is guessed is printed; options take over where a guess is wrong.

\b
Exit codes: 0 done, 1 done and stiction found, 2 the input cannot be read or the
request makes no sense.
"""


class Lazy(click.Group):
    """A group that imports a command's file only when the command is used."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, name: str) -> click.Command | None:
        if name not in COMMANDS:
            return None
        command: click.Command = importlib.import_module(f"stickslip.commands.{name}").command
        return command

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        name = args[0]
        if name not in COMMANDS and not name.startswith("-"):
            from stickslip.logs.hint import nearest  # numpy and more, which ``stickslip --help`` need not wait for

            hint = nearest(name, COMMANDS)
            if Path(name).is_file():
                hint = f"to judge the loop in that file: stickslip check {name}; known: {', '.join(COMMANDS)}"
            ctx.fail(f"there is no command '{name}'; {hint}")
        return super().resolve_command(ctx, args)

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        with formatter.section("Commands"):
            formatter.write_dl(list(COMMANDS.items()))


@click.group(cls=Lazy, help=HELP, context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100})
@click.version_option(__version__, prog_name="stickslip")
def cli() -> None:
    """Group of all commands."""

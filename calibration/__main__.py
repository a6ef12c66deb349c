"""``python -m stickslip.calibration simulate N --seed S --out DIR``: many simulated loops with known causes, as
Parquet.
"""

from pathlib import Path
from typing import get_args

import click
from stickslip.calibration.commands import score, train
from stickslip.calibration.spec import Setting


@click.group(context_settings={"help_option_names": ["-h", "--help"]})
def calibration() -> None:
    """Simulated loops whose cause is known, to calibrate and to test the verdict on."""


@calibration.command()
@click.argument("loops", type=click.IntRange(min=1))
@click.option("--seed", type=click.IntRange(min=0), required=True, help="of all random numbers")
@click.option("--out", type=click.Path(file_okay=False, path_type=Path), required=True, help="folder to write to")
@click.option("--setting", type=click.Choice(get_args(Setting)), default="training", show_default=True)
@click.option("--workers", type=click.IntRange(min=1), default=None, help="threads; all cores if not given")
def simulate(loops: int, seed: int, out: Path, setting: Setting, workers: int | None) -> None:
    """Simulate LOOPS loops into a folder; a second call makes what is missing."""
    from stickslip.calibration.chunks import write

    try:
        made = write(out, loops, seed, setting, workers)
    except (ValueError, OSError) as error:
        raise click.UsageError(str(error)) from None
    click.echo(f"{made} loops simulated, {loops - made} were there already: {out}")


calibration.add_command(train)
calibration.add_command(score)

if __name__ == "__main__":
    calibration(prog_name="python -m stickslip.calibration")

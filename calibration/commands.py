"""``python -m calibration train`` and ``score``: the calibrated model again from nothing, and what it is worth."""

import json
from pathlib import Path
from typing import Any, get_args

import click
import numpy as np

from calibration.spec import Setting

# First seeds of the two laws that are learnt from: to fit patterns, trees, and the calibration.
PATTERNS: dict[Setting, int] = {"training": 10_001, "creeping": 31_000}
TREES: dict[Setting, int] = {"training": 20_000, "creeping": 30_000}
HOLDING: dict[Setting, int] = {"training": 20_040, "creeping": 30_060}
SHARE: dict[Setting, float] = {"training": 2 / 3, "creeping": 1 / 3}  # of the loops for the trees
KERNELS = 10_000  # seed of the loops that the limits of the kernels are taken from
CHOOSING, TESTING = (7000, 7100), 9100  # of the other physics: to choose on (no fit); to report on, and nothing else
FOLDER = click.Path(file_okay=False, path_type=Path)


def _table(folder: Path, setting: Setting, seed: int, loops: int, workers: int | None) -> Any:
    from calibration.records import PART, kept_table

    try:
        return kept_table(folder, setting, seed, max(round(loops / PART), 1), workers)
    except ValueError as error:
        raise click.UsageError(str(error)) from None


def _read_out(folder: Path, loops: int, workers: int | None) -> None:
    """Fit the patterns, which the features of all loops contain, and write the shipped file."""
    from calibration.patterns import LIMITED, PART, fit, kernels, pooled_loops, views
    from detect.judge.features.patterns import FILE

    odd, even = kernels([view for view, _ in views(KERNELS)][:LIMITED])
    count = max(round(loops / len(PATTERNS) / PART), 1)
    pooled = [
        pooled_loops(folder / f"patterns_{setting}", seed, count, odd, even, workers, setting)
        for setting, seed in PATTERNS.items()
    ]
    x, group = (np.concatenate(both) for both in zip(*pooled, strict=True))
    fit(x, group, odd, even, click.echo).write(FILE)


def _both(folder: Path, seeds: dict[Setting, int], loops: dict[Setting, float], workers: int | None) -> Any:
    """The tables of both laws, one after the other."""
    from calibration.records import Table

    return Table.joined([_table(folder, law, seed, round(loops[law]), workers) for law, seed in seeds.items()])


@click.command()
@click.option("--loops", type=click.IntRange(min=1), default=30_000, show_default=True, help="to fit the trees on")
@click.option("--holding", type=click.IntRange(min=1), default=4000, show_default=True, help="to calibrate on")
@click.option(
    "--patterns", type=click.IntRange(min=0), default=31_000, show_default=True,
    help="to fit the patterns on; 0: those of the shipped file",
)  # fmt: skip
@click.option("--trees", type=click.IntRange(min=10), default=400, show_default=True, help="of the accusing part")
@click.option(
    "--folder", type=FOLDER, default=Path("calibration_parts"), show_default=True, help="for what is simulated"
)
@click.option(
    "--out", type=click.Path(dir_okay=False, path_type=Path), default=None, help="the model; default: shipped file"
)
@click.option("--workers", type=click.IntRange(min=1), default=None, help="processes; all cores if not given")
def train(
    loops: int, holding: int, patterns: int, trees: int, folder: Path, out: Path | None, workers: int | None
) -> None:
    """Simulate, fit and calibrate the model of ``stickslip check``; a second call goes on where it was stopped."""
    from calibration.training import fit
    from detect.judge.model import FILE

    if patterns:
        _read_out(folder, patterns, workers)
    fitted = _both(folder, TREES, {law: share * loops for law, share in SHARE.items()}, workers)
    held = _both(folder, HOLDING, dict.fromkeys(HOLDING, holding / len(HOLDING)), workers)
    model = fit(fitted, held, click.echo, trees=trees)
    file = out or FILE
    model.write(file)
    click.echo(f"{file}: {file.stat().st_size / 1e3:.0f} kB")
    click.echo(f"stiction from {model.accuse:.3f} on, cleared up to {model.clear:.4f}")


@click.command()
@click.option("--loops", type=click.IntRange(min=500), default=4000, show_default=True)
@click.option("--setting", type=click.Choice(get_args(Setting)), default="other_physics", show_default=True)
@click.option("--seed", type=click.IntRange(min=0), default=TESTING, show_default=True, help="first seed")
@click.option(
    "--folder", type=FOLDER, default=Path("calibration_parts"), show_default=True, help="for what is simulated"
)
@click.option(
    "--model", "file", type=click.Path(dir_okay=False, path_type=Path), default=None, help="default: shipped file"
)
@click.option("--workers", type=click.IntRange(min=1), default=None, help="processes; all cores if not given")
def score(loops: int, setting: Setting, seed: int, folder: Path, file: Path | None, workers: int | None) -> None:
    """Say how good the calibrated probability is on loops that no fit has seen, as JSON."""
    from calibration.scoring import score as figures
    from detect.judge.model import FILE, Model

    told = _table(folder, setting, seed, loops, workers)
    click.echo(json.dumps(figures(Model.read(file or FILE), told), indent=1))

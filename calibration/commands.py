"""``python -m stickslip.calibration train`` and ``score``: the calibrated model again from nothing, and what it is
worth.
"""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Any, get_args

import click
from stickslip.calibration.laws import Law
from stickslip.calibration.spec import Kinds, Setting


@dataclass(frozen=True)
class Source:
    """Loops of one law: its first seed, which kinds of loop (``draw``), how many."""

    law: Law
    seed: int
    kinds: Kinds
    loops: int


# What the networks learn from, what the first of them then goes on with, and what the judge learns from.
FIRST = (
    Source("creeping", 70_100, "usual", 6_000),
    Source("crossed", 1000, "usual", 39_500), Source("crossed", 1200, "usual", 14_500),
    Source("crossed", 2000, "usual", 170_000), Source("training", 70_000, "usual", 12_000),
)  # fmt: skip
AGAIN = (
    Source("crossed", 1000, "usual", 39_500), Source("crossed", 1200, "usual", 14_500),
    Source("crossed", 2000, "usual", 20_000),
    Source("training", 70_000, "usual", 12_000), Source("creeping", 70_100, "usual", 6_000),
    Source("training", 71_000, "usual", 80_000),
)  # fmt: skip
PASSES = 3  # over the loops of ``AGAIN``
SEEDS = (0, 1)  # of the random numbers that a network begins from
JUDGE = (Source("crossed", 11, "usual", 9000), Source("training", 84_200, "usual", 3000))
CHOOSING, TESTING = (7000, 7100), 9700  # of the other physics: to choose on (no fit); to report on, and nothing else
FOLDER = click.Path(file_okay=False, path_type=Path)


def _total(sources: Sequence[Source]) -> int:
    return sum(source.loops for source in sources)


def _parts(sources: Sequence[Source], loops: int, part: int) -> list[tuple[Source, int]]:
    """How many parts of each source there are, where ``loops`` are asked for in all; at least one."""
    return [(one, max(loops * one.loops // (_total(sources) * part), 1)) for one in sources]


def _tables(folder: Path, sources: Sequence[Source], loops: int, workers: int | None) -> Any:
    """The tables of several sources, one after the other."""
    from stickslip.calibration.records import PART, Table, kept_table

    try:
        return Table.joined([
            kept_table(folder, one.law, one.seed, count, workers, one.kinds)
            for one, count in _parts(sources, loops, PART)
        ])  # fmt: skip
    except ValueError as error:
        raise click.UsageError(str(error)) from None


def _networks(folder: Path, loops: int, workers: int | None) -> None:
    """Fit the networks, whose scores the features of all loops contain, and write the shipped file.

    The first goes on over more loops of the first law, which the other has seen few of.
    """
    from stickslip.calibration.network import fit
    from stickslip.calibration.signals import PART, Examples, examples
    from stickslip.detect.judge.features.network import FILE, write

    def seen(sources: Sequence[Source]) -> Examples:
        many = loops * _total(sources) // _total(FIRST)
        return Examples.joined([
            examples(folder / f"signals_{one.law}_{one.kinds}_{one.seed}", one.seed, count, one.law, one.kinds, workers)
            for one, count in _parts(sources, many, PART)
        ])  # fmt: skip

    every = seen(FIRST)
    going_on, other = (fit(every, click.echo, seed) for seed in SEEDS)
    write([fit(seen(AGAIN), click.echo, SEEDS[0], PASSES, going_on), other], FILE)


@click.command()
@click.option("--loops", type=click.IntRange(min=1), default=_total(JUDGE), show_default=True, help="for the judge")
@click.option(
    "--network", type=click.IntRange(min=0), default=_total(FIRST), show_default=True,
    help="to fit the networks on, by PyTorch; 0: none, the shipped networks stay",
)  # fmt: skip
@click.option(
    "--folder", type=FOLDER, default=Path("calibration_parts"), show_default=True, help="for what is simulated"
)
@click.option(
    "--out", type=click.Path(dir_okay=False, path_type=Path), default=None, help="the model; default: shipped file"
)
@click.option("--workers", type=click.IntRange(min=1), default=None, help="processes; all cores if not given")
def train(
    loops: int, network: int, folder: Path, out: Path | None, workers: int | None,
) -> None:  # fmt: skip
    """Simulate, fit and calibrate the model of ``stickslip check``; a second call goes on where it was stopped."""
    from stickslip.calibration.network import MISSING
    from stickslip.calibration.training import fit
    from stickslip.detect.judge.model import FILE

    if network and not find_spec("torch"):
        raise click.UsageError(MISSING)
    if network:
        _networks(folder, network, workers)
    model = fit(_tables(folder, JUDGE, loops, workers), click.echo)
    file = out or FILE
    model.write(file)
    click.echo(f"stiction from {model.accuse:.3f} on, contested {model.contested:.3f}, cleared up to {model.clear:.4f}")


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
    from stickslip.calibration.scoring import score as figures
    from stickslip.detect.judge.model import FILE, Model

    values = _tables(folder, [Source(setting, seed, "usual", loops)], loops, workers)
    click.echo(json.dumps(figures(Model.read(file or FILE), values), indent=1))

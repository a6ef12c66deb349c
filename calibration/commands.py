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


# What is learnt from: to fit a network from nothing, to go on with that one, and the judge.
FIRST = (
    Source("training", 40_000, "moved", 15_000), Source("creeping", 41_000, "moved", 15_000),
    Source("training", 50_000, "moved", 85_000), Source("creeping", 50_000, "moved", 74_000),
    Source("training", 60_000, "usual", 73_000), Source("creeping", 60_000, "usual", 61_500),
)  # fmt: skip
AGAIN = (
    Source("crossed", 1000, "usual", 39_500), Source("crossed", 1200, "usual", 14_500),
    Source("training", 70_000, "usual", 12_000), Source("creeping", 70_100, "usual", 6_000),
)  # fmt: skip
PASSES = 8  # over the loops of ``AGAIN``
JUDGE = (Source("crossed", 11, "usual", 3000), Source("training", 84_200, "usual", 1000))
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


def _network(folder: Path, loops: int, begun: Path | None, workers: int | None) -> None:
    """Fit the network, whose scores the features of all loops contain, and write the shipped file."""
    from stickslip.calibration.network import PASSES as FROM_NOTHING
    from stickslip.calibration.network import fit
    from stickslip.calibration.signals import PART, Examples, examples
    from stickslip.detect.judge.features.network import FILE, Network

    first = None if begun is None else Network.read(begun)
    seen = [
        examples(folder / f"signals_{one.law}_{one.kinds}_{one.seed}", one.seed, count, one.law, one.kinds, workers)
        for one, count in _parts(FIRST if first is None else AGAIN, loops, PART)
    ]
    passes = FROM_NOTHING if first is None else PASSES
    fit(Examples.joined(seen), click.echo, passes=passes, begun=first).write(FILE)


@click.command()
@click.option("--loops", type=click.IntRange(min=1), default=_total(JUDGE), show_default=True, help="for the judge")
@click.option(
    "--network", type=click.IntRange(min=0), default=None,
    help=f"to fit the network on, by PyTorch; default: {_total(FIRST):,}, with --begun {_total(AGAIN):,}; 0: none, "
    "the shipped network stays",
)  # fmt: skip
@click.option(
    "--begun", type=click.Path(exists=True, dir_okay=False, path_type=Path), default=None,
    help="network to go on from; default: from nothing",
)  # fmt: skip
@click.option(
    "--folder", type=FOLDER, default=Path("calibration_parts"), show_default=True, help="for what is simulated"
)
@click.option(
    "--out", type=click.Path(dir_okay=False, path_type=Path), default=None, help="the model; default: shipped file"
)
@click.option("--workers", type=click.IntRange(min=1), default=None, help="processes; all cores if not given")
def train(
    loops: int, network: int | None, begun: Path | None, folder: Path, out: Path | None, workers: int | None,
) -> None:  # fmt: skip
    """Simulate, fit and calibrate the model of ``stickslip check``; a second call goes on where it was stopped."""
    from stickslip.calibration.network import MISSING
    from stickslip.calibration.training import fit
    from stickslip.detect.judge.model import FILE

    if network != 0 and not find_spec("torch"):
        raise click.UsageError(MISSING)
    if network != 0:
        _network(folder, network or _total(FIRST if begun is None else AGAIN), begun, workers)
    model = fit(_tables(folder, JUDGE, loops, workers), click.echo)
    file = out or FILE
    model.write(file)
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
    from stickslip.calibration.scoring import score as figures
    from stickslip.detect.judge.model import FILE, Model

    values = _tables(folder, [Source(setting, seed, "usual", loops)], loops, workers)
    click.echo(json.dumps(figures(Model.read(file or FILE), values), indent=1))

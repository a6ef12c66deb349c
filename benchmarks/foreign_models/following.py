"""How far a record lies from its model without noise and loads, beside how far the model's own records lie from it.

    distance of a signal = rms(record - model without noise and loads, at the logged set points)

A logged set point moved at any time since the row before; at the row, as it is played back, is too late.  The model's
own records have noise, loads and moves at random times between rows as well, so their distances are what a model that
is right would have.  ``python -m benchmarks.foreign_models.following [plant ...]`` prints both,
and ``--plot FOLDER`` draws.
"""

import argparse
import importlib
import math
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from stickslip.diagram import Diagram, ensemble, simulate

from benchmarks.foreign.trial import Wired

MODELS = (
    "batch_ramp", "belt_dryer", "cascade", "cone", "drum_level", "exotherm", "gas_pressure", "heat_exchanger",
    "neutralisation", "pipeline_pack", "pump_flow", "quench", "ratio_feedforward", "recycle", "split_range",
    "sqrt_tank", "steam_header", "two_by_two",
)  # fmt: skip

Signals = Mapping[str, np.ndarray]


def model(plant: str, noise_factor: float = 1.0, load_factor: float = 1.0) -> Diagram:
    """Return the model of a plant; raises ``ValueError`` for a plant that has none."""
    if plant not in MODELS:
        raise ValueError(f"there is no model of {plant!r}; there are {', '.join(MODELS)}")
    made: Callable[..., Wired] = importlib.import_module(f"benchmarks.foreign_models.{plant}").model
    return made(noise_factor, load_factor).diagram


def silent(diagram: Diagram) -> Diagram:
    """Return the diagram without noise and loads."""
    return diagram.with_params({f"{block.name}.sd": 0.0 for block in diagram.blocks if "sd" in block.params})


def played(diagram: Diagram, record: Signals, seed: int | None = None) -> dict[str, np.ndarray]:
    """Return what the diagram makes of the record's set points, by rows; it has run for a quarter of the record before.

    With a ``seed`` its noise and loads are drawn by that, and set points move at random times between their rows.
    """
    t = record["time"]
    row = t[1] - t[0]
    before = row * np.ceil(0.25 * t[-1] / row)
    given: dict[str, Any] = {}
    for name in diagram.open_inputs:
        at, value = np.concatenate([[0.0], before + t]), np.concatenate([[record[name][0]], record[name]])
        if seed is not None:
            moved = np.flatnonzero(np.diff(value)) + 1
            at[moved] -= row * np.random.default_rng(seed).uniform(0.0, 0.999, len(moved))
        given[name] = {"time": at, name: value}
    signals = [name for name in record if name in diagram.signals]
    asked: dict[str, Any] = {"times": before + t, "inputs": given, "signals": signals}
    if seed is None:
        run = simulate(diagram, float(before + t[-1]), **asked)
        return {name: run.log[name] for name in signals}
    runs = ensemble(diagram, float(before + t[-1]), **asked, seeds=[seed], progress=False)
    return {name: runs.values[name][0] for name in signals}


def distances(record: Signals, still: Signals) -> dict[str, float]:
    """Return the distance of each signal that the model has, in its unit."""
    return {name: float(np.sqrt(np.mean((record[name] - still[name]) ** 2))) for name in still}


def following(diagram: Diagram, record: Signals, seeds: Sequence[int] = range(6)) -> dict[str, tuple[float, float]]:
    """Return of each signal the distance of the record, and the mean distance of the model's own records."""
    still = played(silent(diagram), record)
    own = [distances(played(diagram, record, seed), still) for seed in seeds]
    return {
        name: (distance, float(np.mean([each[name] for each in own])))
        for name, distance in distances(record, still).items()
        if name not in diagram.open_inputs
    }


def behind_switches(plant: str, moves: int = 2, rows: int = 10) -> dict[str, float]:
    """Return how far the plant without noise and loads is from its model behind its first moves, in steps of the log.

    A move is put at the scan since the row before that suits OP best.  For plants with one set point, which is stepped.
    """
    from benchmarks.foreign.record import plant as known
    from benchmarks.foreign.record import record

    of, diagram = known(plant), silent(model(plant))
    (name,) = diagram.open_inputs
    signals = record(plant, "none", 0.0, 0, 0.0, 0.0).signals
    t = signals["time"]
    before = of.scan * np.round(0.25 * t[-1] / of.scan)
    found = np.flatnonzero(np.diff(signals[name]))[:moves] + 1
    values = np.concatenate([[signals[name][0]], signals[name][found], signals[name][found[-1:]]])
    at = np.concatenate([[0.0], before + t[found], [before + t[-1]]])
    worst: dict[str, float] = {}
    for j, row in enumerate(found, start=1):
        log, best = {}, math.inf
        last, first = before + t[row], before + t[row - 1]
        for scan in of.scan * np.arange(np.floor(first / of.scan + 1e-9) + 1.0, np.floor(last / of.scan + 1e-9) + 1.0):
            tried = {"time": np.where(np.arange(len(at)) == j, scan, at), name: values}
            end = min(row + rows, len(t))
            run = simulate(diagram, float(before + t[end - 1]), times=before + t[row:end], inputs={name: tried})
            missed = float(np.abs(run.log["OP"] - signals["OP"][row:end]).max())
            if missed < best:
                at[j], log, best = scan, run.log, missed
        for tag in (tag for tag in signals if tag in diagram.signals and tag != name):
            error = float(np.abs(log[tag] - signals[tag][row:end]).max()) / of.tags[tag]
            worst[tag] = max(error, worst.get(tag, 0.0))
    return worst


def _draw(plant: str, record: Signals, folder: Path) -> None:
    """Draw record and silent model over time, one panel a signal."""
    import matplotlib.pyplot as plt

    still = played(silent(model(plant)), record)
    figure, axes = plt.subplots(len(still), 1, figsize=(14.0, 2.6 * len(still)), sharex=True)
    for axis, (name, values) in zip(np.atleast_1d(axes), still.items(), strict=True):
        axis.plot(record["time"], record[name], lw=0.8, label="record")
        axis.plot(record["time"], values, lw=0.8, label="model without noise and loads")
        axis.set_ylabel(name)
    axes[0].legend(loc="upper right")
    axes[-1].set_xlabel("time [s]")
    axes[0].set_title(plant)
    figure.tight_layout()
    figure.savefig(folder / f"{plant}.png", dpi=60)
    plt.close(figure)


def main() -> None:
    """Print the distances of records without an effect."""
    from benchmarks.foreign.record import record

    parser = argparse.ArgumentParser(prog="python -m benchmarks.foreign_models.following", description=__doc__)
    parser.add_argument("plants", nargs="*", default=list(MODELS))
    parser.add_argument("--seeds", type=int, default=3, help="records of each plant (3)")
    parser.add_argument("--plot", type=Path, metavar="FOLDER", help="draw the first record of each plant")
    asked = parser.parse_args()
    for plant in asked.plants:
        for seed in range(asked.seeds):
            signals = record(plant, "none", 0.0, seed, 1.0, 1.0).signals
            for name, (distance, own) in following(model(plant), signals).items():
                moves = float(np.std(signals[name]))
                print(
                    f"{plant:18} {seed} {name:5} moves {moves:8.4g}, distance {distance:8.4g}, "
                    f"{distance / own:5.2f} of the model's own"
                )
            if asked.plot is not None and seed == 0:
                asked.plot.mkdir(parents=True, exist_ok=True)
                _draw(plant, signals, asked.plot)


if __name__ == "__main__":
    main()

"""A record of a foreign plant, with an effect whose name, place and size are known."""

from dataclasses import dataclass
from functools import cache
from importlib import import_module

import numpy as np

from benchmarks.foreign.historian import filtered, late, rounded, swinging_door
from benchmarks.foreign.plant import Effect, Plant

NAMES = (
    "heat_exchanger", "gas_pressure", "pump_flow", "neutralisation", "sqrt_tank", "split_range", "ratio_feedforward",
    "two_by_two", "cascade", "recycle", "cone", "batch_ramp", "exotherm", "drum_level",
)  # fmt: skip
UNSEEN = ("steam_header", "belt_dryer", "pipeline_pack", "quench")  # of a third hand; no method was made with them


@dataclass(frozen=True)
class Truth:
    """What is in a record: ``effect`` "none" or a name, ``place`` "" or a block of the data sheet, ``size`` 1 typical.

    ``values``: the parameters of the plant that it changed; ``outside``: no catalogue has it.
    """

    plant: str
    effect: str
    place: str
    size: float
    values: dict[str, float]
    outside: bool
    noise_factor: float
    load_factor: float


@dataclass(frozen=True)
class Record:
    """Rows of a log: ``signals`` has "time" [s] and every tag of the data sheet."""

    signals: dict[str, np.ndarray]
    truth: Truth


@cache
def plant(name: str) -> Plant:
    """Return a plant; raises ``ValueError`` for a name that is none."""
    if name not in (*NAMES, *UNSEEN):
        raise ValueError(f"no foreign plant {name!r}; there are {', '.join((*NAMES, *UNSEEN))}")
    found: Plant = import_module(f"benchmarks.foreign.{name}").PLANT
    return found


def record(
    name: str,
    effect: str = "none",
    size: float = 1.0,
    seed: int = 1,
    noise_factor: float = 1.0,
    load_factor: float = 1.0,
    chance: int | None = None,
) -> Record:
    """Return a record of a plant; the same seed has the same set points, loads and noise, whatever the effect.

    ``size``: 1 is typical, 0 nothing, negative the opposite of an effect that has one.  ``noise_factor`` and
    ``load_factor``: true over stated standard deviation.  ``chance``: another seed for noise and unmeasured loads.
    Raises ``ValueError`` for an unknown name.
    """
    of = plant(name)
    if effect != "none" and effect not in of.effects and effect not in of.outside:
        raise ValueError(f"{name} has no effect {effect!r}; it has {', '.join((*of.effects, *of.outside))}")
    what = {**of.effects, **of.outside}.get(effect, Effect("", lambda size: {}))
    values = what.of(size)
    again = seed if chance is None else chance
    signals = signals_of(of, {} if what.log else values, seed, again, noise_factor, load_factor)
    if what.log:
        signals |= _logged(signals, values)
    for tag, step in of.tags.items():
        signals[tag] = rounded(signals[tag], step)
    outside = effect in of.outside
    return Record(signals, Truth(name, effect, what.place, size, values, outside, noise_factor, load_factor))


def signals_of(
    of: Plant, values: dict[str, float], seed: int, chance: int, noise_factor: float, load_factor: float
) -> dict[str, np.ndarray]:
    """Return "time" and the tags of a plant with some parameters replaced, before the historian rounds them."""
    first, every = round(of.warm / of.dt), round(of.row / of.dt)
    rows = int(3600.0 * of.hours / of.row) + 1
    steps = first + (rows - 1) * every + 1
    t = of.dt * np.arange(steps)
    moves = np.random.default_rng([seed, 0])
    sp = np.array([one.path(moves, t) for one in of.set_points])
    load = np.empty((len(of.loads), int(t[-1]) + 2))
    for k, one in enumerate(of.loads):
        measured = k in of.measured
        rng = np.random.default_rng([seed if measured else chance, 1, k])
        load[k] = walk(rng, load.shape[1], one.tau) * one.sd * (1.0 if measured else load_factor)
    scans = int(t[-1] / of.scan) + 2
    noise = np.random.default_rng([chance, 2]).standard_normal((len(of.sensors), scans)) * noise_factor
    luck = np.random.default_rng([chance, 3]).random(scans)
    out = np.full((rows, len(of.tags)), np.nan)
    of.run(of.with_settings(values), sp, load, noise, luck, of.dt, first, every, out)
    return {"time": np.round(of.row * np.arange(rows), 6)} | {tag: out[:, k] for k, tag in enumerate(of.tags)}


def walk(rng: np.random.Generator, n: int, tau: float) -> np.ndarray:
    """Return AR(1) of unit variance, new each second, from its stationary distribution."""
    a = np.exp(-1.0 / tau)
    out = rng.standard_normal(n)
    for k in range(1, n):
        out[k] = a * out[k - 1] + np.sqrt(1.0 - a * a) * out[k]
    return out


def _logged(signals: dict[str, np.ndarray], values: dict[str, float]) -> dict[str, np.ndarray]:
    out = {}
    ways = {"compression": swinging_door, "late": late, "filter": filtered}
    for name, value in values.items():
        what, tag = name.split(".")
        out[tag] = ways[what](signals["time"], signals[tag], value)
    return out

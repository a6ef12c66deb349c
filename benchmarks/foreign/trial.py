"""Which records of foreign plants are diagnosed, and what comes of each.

Every plant has each of its effects twice or three times, what no catalogue has three times, and eleven records without
an effect; sizes are 0.7 to 1.4 of typical.  In half of the records noise and load are not of the stated size.
"""

import time
import traceback
import zlib
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass
from importlib import import_module
from importlib.util import find_spec
from typing import Any, NamedTuple

import numpy as np
from stickslip.diagram.diagram import Diagram
from stickslip.logs import Log

from benchmarks.foreign.answer import Answer
from benchmarks.foreign.record import NAMES, UNSEEN, Record, plant, record
from benchmarks.foreign.scoring import scored

NONE, INSIDE, OUTSIDE = "none", "effect", "outside"
WITHOUT = 11  # records of each plant


class Wired(NamedTuple):
    """What ``model()`` of ``benchmarks/foreign_models/<plant>.py`` returns, wired from the data sheet.

    ``signals``: signal of the diagram -> (factor, tag), so that signal = factor x tag; an OP in % has the factor 0.01
    where the diagram has shares.  ``places``: block of the diagram -> block of the data sheet, where names differ.
    """

    diagram: Diagram
    signals: dict[str, tuple[float, str]]
    places: dict[str, str]


@dataclass(frozen=True)
class Run:
    """One record to diagnose."""

    plant: str
    group: str
    effect: str
    seed: int
    size: float
    noise_factor: float
    load_factor: float

    @property
    def key(self) -> str:
        """The name of the run."""
        room = "foreign/unseen" if self.plant in UNSEEN else "foreign"
        return f"{room}/{self.plant}/{self.group}/{self.effect}/{self.seed}"

    @property
    def kind(self) -> tuple[str, str]:
        """What it counts among."""
        return self.plant, self.group

    def made(self) -> Record:
        """Return the record."""
        return record(self.plant, self.effect, self.size, self.seed, self.noise_factor, self.load_factor)

    def change(self, made: Record) -> float:
        """Return how far the effect moves the tag that it moves most, over what chance does to that tag (rms)."""
        rows = [record(self.plant, "none", 1.0, self.seed, self.noise_factor, self.load_factor, chance)
                for chance in (None, 1, 2, 3)]  # fmt: skip
        moved = [0.0]
        for tag, rounding in plant(self.plant).tags.items():
            values = np.array([one.signals[tag] for one in rows])
            natural = float(np.mean(np.var(values, axis=0, ddof=1)))
            if natural > 0.0:  # not a set point
                square = float(np.mean((made.signals[tag] - values[0]) ** 2))
                moved.append(np.sqrt(square / (natural + rounding**2)))
        return max(moved)


def runs() -> list[Run]:
    """Return all runs; the same each time."""
    out = []
    for name in (*NAMES, *UNSEEN):
        of = plant(name)
        asked = [(NONE, "none", seed) for seed in range(WITHOUT)]
        asked += [(INSIDE, effect, seed) for k, effect in enumerate(of.effects) for seed in range(2 + k % 2)]
        asked += [(OUTSIDE, effect, seed) for effect in of.outside for seed in range(3)]
        out += [_run(name, *one, stated=k % 2 == 0) for k, one in enumerate(asked)]
    return out


def _run(name: str, group: str, effect: str, repeat: int, *, stated: bool) -> Run:
    rng = np.random.default_rng(zlib.crc32(f"{name} {group} {effect} {repeat}".encode()))
    of = plant(name)
    what = {**of.effects, **of.outside}.get(effect)
    size = float(np.exp(rng.uniform(np.log(0.7), np.log(1.4)))) if what else 0.0
    if what is not None and what.signed and rng.random() < 0.5:
        size = -size
    seed = int(rng.integers(1, 2**31))
    noise, load = (1.0, 1.0) if stated else np.exp2(rng.uniform(-1.0, 1.0, 2))
    return Run(name, group, effect, seed, round(size, 4), round(float(noise), 4), round(float(load), 4))


def wired(name: str) -> Callable[[], Wired] | None:
    """Return the function that builds the model of a plant; None where nobody has wired it yet."""
    module = f"benchmarks.foreign_models.{name}"
    if find_spec("benchmarks.foreign_models") is None or find_spec(module) is None:
        return None
    build: Callable[[], Wired] = import_module(module).model
    return build


def diagnosed(run: Run, ask: Callable[[Wired, Log], Answer] | None = None) -> dict[str, Any]:
    """Return the row of one run: what is true, what was answered, what it took, what is right.

    ``ask``: the tool that diagnoses, by default this house's.  An exception of the model or the tool is a crash.
    """
    made = run.made()
    row: dict[str, Any] = {"key": run.key, **asdict(run), "place": made.truth.place}
    row |= {"values": made.truth.values, "change": run.change(made) if run.effect != "none" else 0.0}
    build = wired(run.plant)
    begin = time.process_time()
    answer, fault = None, ""
    try:
        if build is None:
            raise LookupError(f"no model of {run.plant}")
        model = build()
        values = {signal: factor * made.signals[tag] for signal, (factor, tag) in model.signals.items()}
        answer = (ask or _house)(model, Log(made.signals["time"], values))
    except Exception as error:  # whatever it is, it is a crash, and the next record is asked
        fault = f"{type(error).__name__}: {error} ({traceback.extract_tb(error.__traceback__)[-1].name})"
    row |= {"cpu": time.process_time() - begin, "crash": fault, "answer": None if answer is None else asdict(answer)}
    return row | scored(run.group, run.effect, made.truth.place, answer, plant(run.plant).alike)


def _house(model: Wired, log: Log) -> Answer:
    from stickslip.gap import diagnose

    report = diagnose(model.diagram, log, limits=False, progress=False)
    return Answer.of(report.to_dict(), model.places)


def chosen(all_: Sequence[Run], only: str, quick: bool) -> Iterator[Run]:
    """Yield the runs of wired plants whose key contains ``only``; a quick run has one record of each plant."""
    had: set[str] = set()
    for run in all_:
        if only in run.key and wired(run.plant) is not None and not (quick and run.plant in had):
            had.add(run.plant)
            yield run

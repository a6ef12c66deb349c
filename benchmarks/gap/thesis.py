"""The thesis as the real side: which single change of its printed loop explains its printed figures?

    python -m benchmarks.gap.thesis [--json FILE]

Eq. 6.2 with a sticking valve (table 5.3) gives other indices R (Algorithm 1) than figures 6.1(b), B.3(a) and B.3(b)
print.  No time series is printed, so each effect of the catalogue is put into the printed loop, over its whole range,
and scored by summary statistics:

    distance^2 = sum over the three figures of (ln(R / R_printed) / sd)^2        sd^2 = (spread / R)^2 + TOLERANCE^2

Each loop starts on its symmetric cycle just after an upward slip.  B.3(a) is read as its caption says, high stiction at
half gain, and as normal stiction at half gain.
"""

import argparse
import json
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from stickslip.gap.effects import CATALOGUE
from stickslip.gap.insertion.effect import Effect
from stickslip.logs.arrays import Values

if TYPE_CHECKING:
    from stickslip.diagram.diagram import Diagram

TOLERANCE = 0.05  # of R: that of another solver and another start
SECONDS, EVERY = 600.0, 0.1
SIZES = 24  # of an effect's first parameter; a second one is a share of its range
SECONDS_OF_RANGE = (0.1, 0.5, 0.9)
FEWEST = 4  # half cycles, without which there is no index
NONE_SEEN = 9.0  # distance of a loop that does not cycle, in each figure
PRINTED = {"6.1(b)": (3.71, 0.06), "B.3(b)": (6.40, 0.80), "B.3(a)": (18.40, 0.70)}
HIGH, NORMAL = 2250.0, 1750.0  # F_s [N], table 5.3
READINGS = {
    "caption": {"6.1(b)": (HIGH, 0.4), "B.3(b)": (NORMAL, 0.4), "B.3(a)": (HIGH, 0.2)},
    "normal stiction in B.3(a)": {"6.1(b)": (HIGH, 0.4), "B.3(b)": (NORMAL, 0.4), "B.3(a)": (NORMAL, 0.2)},
}
NO_SENSE = ("stiction", "sensor_noise", "quantisation", "compression")  # it sticks already; the figures show no noise


@dataclass(frozen=True)
class Scored:
    """An effect at a place with the size that comes nearest: ``R`` figure -> (mean, count); ``distance`` [-]."""

    effect: str
    place: str
    reading: str
    values: dict[str, float]
    R: dict[str, tuple[float, int]]
    distance: float


@cache
def loop(F_s: float, K_p: float, factor: float = 1.0, of: str = "") -> "Diagram":
    """Return the printed loop with its sticking valve, on its symmetric cycle.

    ``factor`` of the gain of the process or of the controller (``of``), which moves that cycle.
    """
    from stickslip.cases.exact.closed_form import symmetric_start
    from stickslip.cases.exact.parameters import ExactLoop
    from stickslip.cases.models import ideal_flow
    from stickslip.diagram import wire
    from stickslip.gap.effects import effect

    gains = {"K": 3.0 * (factor if of == "process" else 1.0), "K_p": K_p * (factor if of == "controller" else 1.0)}
    exact = symmetric_start(ExactLoop(F_s=F_s, **gains))
    from stickslip.blocks import Constant

    model = ideal_flow().with_params({"noise.sd": 0.0, "controller.K_p": K_p})
    closed = wire([Constant("SP", exact.SP), *model.blocks], name="printed")
    stuck = effect("stiction").insert(closed, "valve", S=100.0 * exact.S, J=100.0 * exact.J)
    return stuck.starting_at({"valve:stiction.x": exact.x_0, "process.PV": exact.PV_0, "controller.z": exact.z_0})


def indices(changed: "Diagram", params: dict[str, Any]) -> list[tuple[float, int]]:
    """Return mean and count of R for each set of parameters; NaN where the loop does not cycle."""
    from stickslip.detect.methods.algorithm1 import ratios
    from stickslip.diagram import ensemble

    many = max(len(np.atleast_1d(v)) for v in params.values()) if params else 1
    run = ensemble(
        changed, SECONDS, every=EVERY, params=params, seeds=np.zeros(many, dtype=int), signals=["PV", "SP"],
        progress=False,
    )  # fmt: skip
    found = []
    for k in range(many):
        e = run.values["SP"][k] - run.values["PV"][k]
        R = ratios(np.arange(len(e)) * EVERY, e).R if run.ok[k] and np.ptp(e[len(e) // 2 :]) > 1e-4 else ()
        found.append((float(np.mean(R)), len(R)) if len(R) >= FEWEST else (float("nan"), len(R)))
    return found


def grids(effect: Effect, diagram: "Diagram", place: str) -> dict[str, Values]:
    """Return the sizes of an effect that are tried, parameter -> one value a run."""
    limits = effect.bounds(diagram, place)
    first, *others = [p for p in effect.parameters if not p.nuisance]
    low, high = limits[first.name]
    sizes = np.geomspace(max(low, 1e-3 * high), high, SIZES) if low >= 0.0 else np.linspace(low, high, SIZES)
    found = {first.name: sizes}
    for p in others:
        span = limits[p.name]
        values = span[0] + np.array(SECONDS_OF_RANGE) * (span[1] - span[0])
        found = {name: np.repeat(v, len(values)) for name, v in found.items()} | {p.name: np.tile(values, len(sizes))}
    fixed = {p.name: np.full(len(found[first.name]), p.neutral) for p in effect.parameters if p.nuisance}
    return {p.name: {**found, **fixed}[p.name] for p in effect.parameters}


def scored(effect: Effect, place: str) -> Iterator[Scored]:
    """Yield the size of an effect that comes nearest to the printed figures, for each reading."""
    plain = loop(HIGH, 0.4)
    values = grids(effect, plain, place)
    legal = [
        k for k in range(len(next(iter(values.values()))))
        if not effect.rules(plain, place, {name: float(v[k]) for name, v in values.items()})
    ]  # fmt: skip
    values = {name: v[legal] for name, v in values.items()}
    yield from _nearest(effect.name, place, values, {c: _of(effect, place, values, *c) for c in _conditions()})


def _of(effect: Effect, place: str, values: dict[str, Values], F_s: float, K_p: float) -> list[tuple[float, int]]:
    """Return the indices of a condition; a factor of a gain starts on the cycle of that gain."""
    of = {"process_gain": "process", "valve_gain": "process", "controller_gain": "controller"}.get(effect.name, "")
    if not of:
        put = effect.put(loop(F_s, K_p), place)
        settings = effect.settings(loop(F_s, K_p), place, **values)
        return indices(put, {k: np.broadcast_to(v, len(next(iter(values.values())))) for k, v in settings.items()})
    found = []
    for factor in values["factor"].tolist():
        base = loop(F_s, K_p, factor, of)
        found += indices(effect.insert(base, place, factor=factor), {})
    return found


def _conditions() -> list[tuple[float, float]]:
    return sorted({condition for figures in READINGS.values() for condition in figures.values()})


def _nearest(
    name: str, place: str, values: dict[str, Values], R: dict[tuple[float, float], list[tuple[float, int]]]
) -> Iterator[Scored]:
    for reading, figures in READINGS.items():
        distances = []
        for k in range(len(next(iter(R.values())))):
            total = 0.0
            for figure, condition in figures.items():
                printed, spread = PRINTED[figure]
                off = np.log(R[condition][k][0] / printed) / np.hypot(spread / printed, TOLERANCE)
                total += off**2 if np.isfinite(off) else NONE_SEEN**2
            distances.append(np.sqrt(total))
        k = int(np.argmin(distances))
        found = {figure: R[condition][k] for figure, condition in figures.items()}
        yield Scored(name, place, reading, {p: float(v[k]) for p, v in values.items()}, found, float(distances[k]))


def table(catalogue: tuple[Effect, ...] = CATALOGUE) -> list[Scored]:
    """Return all effects with their distance to the printed figures, the nearest first; "none" is the printed loop."""
    plain = {condition: indices(loop(*condition), {}) for condition in _conditions()}
    found = list(_nearest("none", "", {}, plain))
    for effect in catalogue:
        if effect.of_log or effect.name in NO_SENSE:
            continue
        for place in effect.places(loop(HIGH, 0.4)):
            found += scored(effect, place)
    return sorted(found, key=lambda one: one.distance)


def page(found: list[Scored]) -> str:
    """Return the table as Markdown."""
    lines = ["| effect | at | size | R 6.1(b) | R B.3(b) | R B.3(a) | values in 600 s | distance | B.3(a) read as |"]
    lines += ["|---|---|---|---|---|---|---|---|---|"]
    for one in found:
        size = ", ".join(f"{name} {value:.3g}" for name, value in one.values.items())
        R = " | ".join(f"{one.R[figure][0]:.2f}" for figure in PRINTED)
        read = "its caption" if one.reading == "caption" else "normal stiction"
        lines.append(
            f"| {one.effect} | {one.place} | {size} | {R} | {one.R['6.1(b)'][1]} | {one.distance:.1f} | {read} |"
        )
    return "\n".join(lines)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--json", metavar="FILE", help="also write the table as JSON")
    options = parser.parse_args()
    found = table()
    print(page(found))
    if options.json:
        Path(options.json).write_text(json.dumps([vars(one) for one in found], indent=1))


if __name__ == "__main__":
    main()

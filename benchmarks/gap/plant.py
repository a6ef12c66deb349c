"""Records of the plant with a hidden effect: these come from our own simulator, and only these.

No second program of the plant exists.  What differs from a replay of the model: stems that stick have mass
(``StickSlip``), set points that move, a feed that swings with other random numbers, and a log every 2 s rounded as
instruments do.  The tolerance is 1e-8, so that no row is off by more than that rounding: at 1e-5 the torque was off by
2 % in the rows behind a switch of a set point, which no plant does.  Figures on them say less than those of
``generator``.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from stickslip.blocks import Staircase, StickSlip
from stickslip.cases.plant_models import LOGGED_PLANT, LOGGED_SECTION, full_plant, separator_section
from stickslip.diagram import simulate
from stickslip.diagram.diagram import Diagram
from stickslip.gap.effects import effect
from stickslip.logs import Log

from benchmarks.gap.generator import FAMILIES

MODELS = {"separator_section": (separator_section, LOGGED_SECTION), "full_plant": (full_plant, LOGGED_PLANT)}
ROUNDING = {"p": 100.0, "V": 1e-3, "O": 1e-4, "w": 1e-2, "t": 1.0, "S": 0.0}  # by the first letter of the signal
EVERY = 2.0  # [s]
SWINGS = {"SP_PCS11": 0.02, "SP_LCS11": 0.02, "SP_PCS21": 0.02, "SP_LCS21": 0.02}  # of the set point, either way

# typical sizes; gross ones are twice as far from neutral
SIZES: Mapping[str, tuple[tuple[str, ...], Mapping[str, float]]] = {
    "stiction": (("VPCS1", "VLCS1"), {"S": 5.0, "J": 1.5}),
    "deadband": (("VPCS1",), {"width": 3.0}),
    "valve_leak": (("VPCS1", "VLCS1"), {"flow": 3.0}),
    "valve_gain": (("VPCS1", "VLCS1"), {"factor": 1.1}),
    "positioner_lag": (("VPCS1",), {"tau": 3.0}),
    "valve_characteristic": (("VPCS1",), {"rangeability": 3.0}),
    "controller_gain": (("PCS11", "LCS11"), {"factor": 1.3}),
    "controller_integral_time": (("PCS11",), {"factor": 1.4}),
    "sine_disturbance": (("F_in",), {"amplitude": 150.0, "period": 300.0}),
    "step_disturbance": (("F_in",), {"amplitude": 250.0, "time": 1500.0}),
    "horizontal_separator": (("S1",), {"share": 0.8}),
    "boil_off_rate": (("S1",), {"factor": 0.6}),
    "vapour_pressure": (("S1",), {"factor": 1.05}),
    "real_gas": (("S1",), {"factor": 0.9}),
}
SIZES_OF_PLANT: Mapping[str, tuple[tuple[str, ...], Mapping[str, float]]] = {
    **SIZES,
    "stiction": (("VPCS1", "VLCS1", "VPCS2"), {"S": 5.0, "J": 1.5}),
    "valve_gain": (("VPCS1", "VLCS1", "VPCS2"), {"factor": 1.1}),
    "boil_off_rate": (("S1", "S2"), {"factor": 0.6}),
    "vapour_pressure": (("S1", "S2"), {"factor": 1.05}),
    "real_gas": (("S1", "S2"), {"factor": 0.9}),
    "compressor_fouling": (("C2", "C3"), {"factor": 0.96}),
    "compressor_map_shift": (("C2", "C3"), {"factor": 0.95}),
    "recycle_leak": (("VRVC2_body", "VRVC3_body"), {"flow": 5.0}),
    "shaft_friction": (("shaft",), {"coefficient": 0.8}),
    "line_friction": (("C2_pipe", "C3_pipe"), {"factor": 1.4}),
}


@dataclass(frozen=True)
class PlantRun:
    """One record of the plant: ``model``, ``effect`` at ``place`` ("" for none), seed and family."""

    model: str
    effect: str = ""
    place: str = ""
    seed: int = 0
    family: str = "tuning"

    @property
    def key(self) -> str:
        """A name of the run that no other has."""
        return "/".join([self.family, self.model, self.effect or "none", self.place or "-", str(self.seed)])

    @property
    def kind(self) -> tuple[str | bool, ...]:
        """What the run counts among: the model, with an effect or none."""
        return (self.model, bool(self.effect))

    def made(self, hours: float = 1.0, clean: bool = False) -> Log:
        """Return the log, ``clean`` without the effect; raise ``RuntimeError`` if the plant stops early with it."""
        build, logged = MODELS[self.model]
        rng = np.random.default_rng([FAMILIES[self.family], self.seed, len(self.effect), len(self.place)])
        plant = _moving(build(), rng, 3600.0 * hours)
        if self.effect and not clean:
            swing = float(np.exp(rng.uniform(-0.18, 0.18)))
            values = {key: _swung(key, value, swing) for key, value in SIZES_OF_PLANT[self.effect][1].items()}
            plant = _with(plant, self.effect, self.place, values)
        seeds = {"F_in": [[FAMILIES[self.family], self.seed, 5]]}
        plant = plant.replace("F_in", plant["F_in"].reseeded(seeds["F_in"][0]))
        run = simulate(plant, 3600.0 * hours, every=EVERY, signals=list(logged), rtol=1e-8, atol=1e-11)
        if not run.ok:
            raise RuntimeError(f"{self.key}: {run.hint}")
        return _rounded(run.log)


def runs(family: str, seeds: int = 2) -> Iterator[PlantRun]:
    """Yield the runs of a family; with two seeds more than 60 with an effect in the full plant.

    >>> sum(run.model == "full_plant" and run.effect != "" for run in runs("report"))
    64
    """
    for model, sizes in (("separator_section", SIZES), ("full_plant", SIZES_OF_PLANT)):
        for seed in range(seeds):
            for name, (places, _) in sizes.items():
                for place in places:
                    yield PlantRun(model, name, place, seed, family)
        for seed in range(10 * seeds):
            yield PlantRun(model, seed=1000 + seed, family=family)


def _moving(plant: Diagram, rng: np.random.Generator, duration: float) -> Diagram:
    """Return the plant with set points that move every few minutes."""
    for name, swing in SWINGS.items():
        if any(block.name == name for block in plant.blocks):
            rest = plant[name].params["value"]
            times = np.concatenate([[0.0], np.cumsum(rng.uniform(180.0, 600.0, int(duration / 180.0)))])
            levels = rest * (1.0 + swing * rng.uniform(-1.0, 1.0, len(times)))
            levels[0] = rest
            plant = plant.replace(name, Staircase(name, levels, at=2.0 * np.round(times / 2.0)))
    return plant


def _with(plant: Diagram, name: str, place: str, values: Mapping[str, float]) -> Diagram:
    if name != "stiction":
        return effect(name).insert(plant, place, **values)
    start = float(simulate(plant, EVERY, every=EVERY).log[str(plant[place].output_labels[0])][0])
    return plant.replace(place, StickSlip.from_bands(values["S"] / 100.0, values["J"] / 100.0, start=start))


def _swung(key: str, value: float, swing: float) -> float:
    """Return a size that differs from record to record; times and periods stay."""
    if key in ("factor", "rangeability"):
        return value**swing
    return min(value * swing, 1.0) if key == "share" else value if key in ("time", "period") else value * swing


def _rounded(log: Log) -> Log:
    steps = {name: ROUNDING[name[0]] for name in log.names}
    signals = {name: np.round(log[name] / step) * step for name, step in steps.items() if step > 0.0}
    return log.with_signals(**signals)

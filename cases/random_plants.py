"""Random production plants: every number +-20 %, any feed, kick and stiction, from a seed.

For robustness: what a user may ask of the plant, drawn blindly.  ``draw(seed, number)`` says what is asked, ``build``
makes the plant of it or refuses it with the numbers; ``run`` simulates it and says how that went.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields, is_dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from stickslip.blocks.block import Block
    from stickslip.diagram.diagram import Diagram
    from stickslip.diagram.simulation import Run
    from stickslip.plant import Production

SHARE = 0.2  # how far every parameter is moved
KICK = 0.05  # how far the contents of separator 1 are moved
DURATION, EVERY = 2000.0, 1.0  # s
FEEDS = ("constant", "sine", "slugs", "trip")
FROM = ("A", "B", "C")  # the parameter sets that are varied
BALANCE = 1e-9  # of what is held or turned over: linear balances survive every step to rounding
ENERGY = 1e-4  # of the energy of the shaft, which closes to the tolerance only


@dataclass(frozen=True)
class RandomPlant:
    """A random plant to run: parameters, the feed at rest and its later course, valves, kick, method."""

    number: int
    plant: "Production"
    F_in: float  # mol/s
    Z_I: float
    feed: str
    values: Mapping[str, float]  # of the feed
    F_s: Mapping[str, float]  # N, of the sticky valves
    stem: str
    turbine: str
    anti_surge: bool | str
    kick: tuple[float, float, float]  # factors on N_oil, N_metL, N_metG of separator 1
    method: str

    def build(self) -> "Diagram":
        """Return the plant, kicked; raise ``InfeasibleFeed`` or ``BlockError`` if it cannot be."""
        from stickslip.plant import production_plant

        plant = production_plant(
            self.plant, tuple(self.F_s), self.F_s, feed=self._feed(), stem=self.stem, turbine=self.turbine,
            anti_surge=self.anti_surge, F_in=self.F_in, Z_I=self.Z_I, name=f"random_{self.number}",
        )  # fmt: skip
        contents = plant["S1"].x0 * self.kick
        return plant.starting_at(dict(zip(("S1.N_oil", "S1.N_metL", "S1.N_metG"), contents.tolist(), strict=True)))

    def _feed(self) -> "list[Block]":
        from stickslip.plant import feed

        if self.feed == "sine":
            return feed.sine(self.F_in, self.Z_I, **self.values)
        return {"constant": feed.constant, "slugs": feed.slugs, "trip": feed.trip}[self.feed](
            self.F_in, self.Z_I, **self.values
        )

    def described(self) -> str:
        """Return the request in one line."""
        sticky = ", ".join(f"{valve} {F_s:.0f} N" for valve, F_s in self.F_s.items()) or "no valve"
        values = ", ".join(f"{key} {value:.3g}" for key, value in self.values.items())
        surge = "" if self.anti_surge is True else f", anti_surge {self.anti_surge}"
        return (
            f"plant {self.number}: F_in {self.F_in:.0f} mol/s, Z_I {self.Z_I:.3f}, {self.feed} ({values}); sticky: "
            f"{sticky} ({self.stem}); turbine {self.turbine}{surge}; method {self.method}"
        )


def varied(data: Any, rng: np.random.Generator, share: float = SHARE) -> Any:
    """Return a dataclass with each of its numbers times an independent uniform factor, in nested ones too.

    >>> from stickslip.plant import SET_B
    >>> other = varied(SET_B, np.random.default_rng(1))
    >>> 0.8 <= other.S1.V_sep / SET_B.S1.V_sep <= 1.2, other.S1.V_sep != SET_B.S1.V_sep
    (True, True)
    """
    changes: dict[str, Any] = {}
    for field in fields(data):
        value = getattr(data, field.name)
        if isinstance(value, float):
            changes[field.name] = value * float(rng.uniform(1.0 - share, 1.0 + share))
        elif is_dataclass(value):
            changes[field.name] = varied(value, rng, share)
    return replace(data, **changes)


def draw(number: int, seed: int = 2009) -> RandomPlant:
    """Return what random plant ``number`` asks for, feasible or not.

    >>> draw(3).described() == draw(3).described(), draw(3).described() == draw(4).described()
    (True, False)
    """
    from stickslip.plant import SETS
    from stickslip.plant.parts import VALVES

    rng = np.random.default_rng([seed, number])
    plant = varied(SETS[str(rng.choice(FROM))], rng)
    kind = str(rng.choice(FEEDS))
    values: dict[str, dict[str, float]] = {
        "constant": {},
        "sine": {"amplitude": float(rng.uniform(0.0, 0.1)), "period": float(rng.uniform(100.0, 1000.0))},
        "slugs": {
            "flow": float(rng.uniform(0.0, 800.0)), "gas": float(rng.uniform(0.0, 0.08)),
            "period": float(rng.uniform(60.0, 1000.0)),
        },
        "trip": {
            "to": float(rng.uniform(0.3, 1.1)), "within": float(rng.uniform(5.0, 60.0)),
            "at": float(rng.uniform(10.0, 500.0)),
        },
    }  # fmt: skip
    sticky = [valve for valve in VALVES if rng.random() < (0.7 if valve in ("VLCS1", "VPCS1") else 0.25)]
    F_c = plant.stem.F_c
    friction = [F_c if rng.random() < 0.25 else F_c * float(rng.uniform(1.0, 1.8)) for _ in sticky]
    return RandomPlant(
        number, plant,
        F_in=plant.F_in * float(rng.uniform(0.9, 1.1)),
        Z_I=plant.Z_I * float(rng.uniform(0.9, 1.1)),
        feed=kind, values=values[kind],
        F_s=dict(zip(sticky, friction, strict=True)),
        stem="full" if rng.random() < 0.15 else "quasi_static",
        turbine="lag" if rng.random() < 0.2 else "direct",
        anti_surge=(True, "gradient", False)[int(rng.choice(3, p=(0.6, 0.2, 0.2)))],
        kick=tuple(rng.uniform(1.0 - KICK, 1.0 + KICK, 3).tolist()),
        method="auto" if rng.random() < 0.25 else "stiff",
    )  # fmt: skip


def feasible(count: int, seed: int = 2009) -> Iterator[tuple[RandomPlant, "Diagram | str"]]:
    """Yield random plants until ``count`` could be built: each with its diagram, or with why it was refused."""
    from stickslip.blocks.ports import BlockError
    from stickslip.plant import InfeasibleFeed

    built = number = 0
    while built < count:
        asked = draw(number, seed)
        number += 1
        try:
            plant = asked.build()
        except (InfeasibleFeed, BlockError) as refusal:
            yield asked, str(refusal)
        else:
            built += 1
            yield asked, plant


@dataclass(frozen=True)
class Outcome:
    """How a run went: ``status`` by name, ``reason`` ("" if all is well), when it ``ended``, errors of the balances.

    ``ended`` is the last log time reached [s]; ``lowest`` and ``highest`` are of the signals in ``BOUNDS``.
    """

    status: str
    reason: str
    ended: float
    balance: float
    energy: float
    lowest: Mapping[str, float]
    highest: Mapping[str, float]
    steps: int
    events: int

    @property
    def integrated(self) -> bool:
        """Whether the run reached its end with finite values and closed balances."""
        return self.status == "OK" and not self.reason


BOUNDS = {
    "p_1": (0.0, 1e7), "p_2": (0.0, 1e7), "V_1": (0.0, 150.0), "V_2": (0.0, 150.0), "z_1": (0.0, 1.0),
    "z_2": (0.0, 1.0), "p_in2": (0.0, 1e7), "p_out2": (0.0, 2e7), "p_in3": (0.0, 1e7), "p_out3": (0.0, 1e7),
    "m_2": (-100.0, 200.0), "m_3": (-50.0, 100.0), "w": (300.0, 2000.0),
}  # fmt: skip


def run(asked: RandomPlant, plant: "Diagram", duration: float = DURATION, every: float = EVERY) -> Outcome:
    """Simulate a plant with its balances and return how that went.

    >>> asked, plant = next(pair for pair in feasible(1) if not isinstance(pair[1], str))
    >>> run(asked, plant, 20.0).integrated
    True
    """
    from stickslip.diagram import simulate
    from stickslip.plant.balances import contents, with_balances

    result = simulate(with_balances(plant), duration, every=every, method=asked.method)
    error = np.abs(contents(result.final) / result.final["balances"].x0 - 1.0)
    reached = np.isfinite(result.log["p_1"])
    found = Outcome(
        result.status.name, result.hint, float(result.log.t[reached].max(initial=0.0)),
        balance=float(error[:4].max()), energy=float(error[4]),
        lowest={s: float(result.log[s][reached].min(initial=np.inf)) for s in BOUNDS},
        highest={s: float(result.log[s][reached].max(initial=-np.inf)) for s in BOUNDS},
        steps=result.statistics.steps, events=result.statistics.events,
    )  # fmt: skip
    return replace(found, reason=_doubt(found, result) if result.ok else result.hint)


def _doubt(found: Outcome, result: "Run") -> str:
    """Return what is wrong with a run that reached its end, "" if nothing is."""
    if not all(np.isfinite(values).all() for values in result.log.signals.values()):
        return "values that are not finite in a log whose status is OK"
    if not (found.balance <= BALANCE and found.energy <= ENERGY):
        return f"balances off by {found.balance:.2g}, energy by {found.energy:.2g}"
    beyond = [s for s, (low, high) in BOUNDS.items() if found.lowest[s] < low or found.highest[s] > high]
    return ", ".join(f"{s} from {found.lowest[s]:.4g} to {found.highest[s]:.4g}" for s in beyond)

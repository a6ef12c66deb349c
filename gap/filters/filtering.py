"""What one explanation of a record leaves: innovations and their likelihood."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from stickslip.blocks.block import Block
from stickslip.diagram.diagram import Diagram
from stickslip.gap.effects.deadband import Deadband
from stickslip.gap.effects.disturbance import Disturbance
from stickslip.gap.effects.quantisation import Quantisation
from stickslip.gap.effects.sensor_noise import SensorNoise
from stickslip.gap.effects.step_disturbance import StepDisturbance
from stickslip.gap.effects.stiction import Stiction
from stickslip.gap.effects.valve_characteristic import ValveCharacteristic
from stickslip.gap.effects.valve_rate_limit import ValveRateLimit
from stickslip.gap.effects.valve_saturation import ValveSaturation
from stickslip.gap.filters import kalman, laws
from stickslip.gap.filters.affine import NotAffine
from stickslip.gap.filters.lifted import NOWHERE, lifted
from stickslip.gap.filters.operating import operating
from stickslip.gap.filters.reading import Filtering
from stickslip.gap.filters.scanned import Scanned, scanned
from stickslip.gap.insertion.effect import Effect
from stickslip.gap.insertion.inserted import percent_out
from stickslip.gap.insertion.paths import given, noise_of
from stickslip.gap.records.model import Nuisance

Floats = NDArray[np.float64]
FINER = 8  # points of a scan at which a planned load is averaged
UNCHANGED = (SensorNoise, Quantisation)  # effects that change no path of a signal
LAWS = {ValveSaturation: laws.STOPS, ValveCharacteristic: laws.CURVED, ValveRateLimit: laws.SLOW}


@dataclass(frozen=True, eq=False)
class Explanation:
    """An effect at a place, or none, as a filter sees it; ``beside`` are additional random signals that the model
    lacks.
    """

    filtering: Filtering
    effect: Effect | None = None
    place: str = ""
    beside: tuple[Nuisance, ...] = ()

    @cached_property
    def law(self) -> int:
        """Which law of the valve the effect is (``laws``)."""
        return LAWS.get(type(self.effect), laws.NONE)  # type: ignore[arg-type]

    @cached_property
    def load(self) -> bool:
        """Whether the effect is a load that follows a plan."""
        return isinstance(self.effect, Disturbance)

    @cached_property
    def sticks(self) -> bool:
        """Whether the effect needs a bank of stems."""
        return isinstance(self.effect, Stiction | Deadband)

    @cached_property
    def changed(self) -> Diagram:
        """The silent diagram with the blocks of the effect."""
        base = self.filtering.quiet
        if self.law or self.load or self.effect is None or self.sticks or isinstance(self.effect, UNCHANGED):
            return base
        return self.effect.put(base, self.place)

    @cached_property
    def bounds(self) -> dict[str, tuple[float, float]]:
        """Parameter -> (low, high): those of the effect, then those of the model that are not exactly known."""
        own = dict(self.effect.bounds(self.filtering.model, self.place)) if self.effect else {}
        return own | self.filtering.free

    @cached_property
    def nominal(self) -> dict[str, float]:
        """Parameter -> its value without the effect."""
        own = self.effect.nominal(self.filtering.model, self.place) if self.effect else {}
        return own | self.filtering.stated

    @cached_property
    def own(self) -> tuple[str, ...]:
        """Parameters of the effect."""
        return tuple(p.name for p in self.effect.parameters) if self.effect else ()

    def matrices(self, values: Mapping[str, float]) -> Scanned:
        """Return the matrices of the diagram with these values; the size of a load, or of a law, is not in them."""
        apart = self.law or self.load or self.sticks
        key = tuple(values[name] for name in (*(() if apart else self.own), *self.filtering.free))
        if key not in self._known:
            self._known.clear()
            self._known[key] = self._made(values)
        return self._known[key]

    @cached_property
    def _known(self) -> dict[tuple[float, ...], Scanned]:
        """The last matrices."""
        return {}

    def _made(self, values: Mapping[str, float]) -> Scanned:
        f = self.filtering
        own = {name: values[name] for name in self.own}
        there = {b.name for b in self.changed.blocks}  # not a load that follows a plan, nor what draws random numbers
        settings = f.given.settings(values)
        params = {k: v for k, v in settings.items() if k not in f.given.random and k.rpartition(".")[0] in there}
        noise = tuple(_with_sizes(one, values) for one in f.noise)
        if isinstance(self.effect, SensorNoise):
            noisy = str(noise_of(f.model, f.model[self.place]))
            noise = tuple(replace(n, sd=n.sd * own["factor"]) if n.block == noisy else n for n in f.noise)
        elif isinstance(self.effect, Quantisation):
            noisy = str(noise_of(f.model, f.model[self.place]))
            noise = tuple(
                replace(n, sd=math.sqrt(n.sd**2 + own["step"] ** 2 / 12.0)) if n.block == noisy else n for n in noise
            )
        elif self.effect is not None and not (self.law or self.load or self.sticks):
            params |= self.effect.settings(f.quiet, self.place, **own)
        valve = given(f.quiet, self.place) if self.law or self.sticks else ""
        noise, blocks = (*noise, *self.beside), self._blocks(params)
        return scanned(blocks, noise, f.controllers, f.signals, f.record.played, self.near, valve, self.moved, f.period)

    @property
    def moved(self) -> str:
        """The signal to which planned loads are added, "" for none."""
        places = {place for _, place, _ in self._plans(self.nominal)}
        if len(places) > 1:
            raise NotAffine("planned loads at two places")
        return str(self.filtering.quiet[places.pop()].output_labels[0]) if places else ""

    @cached_property
    def near(self) -> dict[str, float]:
        """A value of each signal at which nothing is at a limit."""
        f = self.filtering
        return operating(self.changed, f.seen, f.record.played, f.controllers)

    def _blocks(self, params: Mapping[str, float]) -> list[Block]:
        """Return the blocks of the changed diagram with these parameters, by ``block.name``."""
        grouped: dict[str, dict[str, float]] = {}
        for key, value in params.items():
            block, _, name = key.rpartition(".")
            grouped.setdefault(block, {})[name] = float(value)
        return [b.with_params(**grouped[b.name]) if b.name in grouped else b for b in self.changed.blocks]

    def numbers(self, values: Mapping[str, float]) -> tuple[float, float]:
        """Return the numbers of the valve's law."""
        f = self.filtering
        if self.law == laws.NONE:
            return 0.0, 0.0
        percent = percent_out(f.quiet, self.place)
        if self.law == laws.STOPS:
            low, high = values["low"], values["high"]
            return (low * percent if low > 0.0 else -math.inf), (high * percent if high < 100.0 else math.inf)
        if self.law == laws.SLOW:
            return values["rate"] * percent * f.period, 0.0
        if abs(100.0 * percent - 1.0) > 1e-9:
            raise NotAffine("a characteristic needs an opening from 0 to 1")
        return values["rangeability"], 0.0

    def _plans(self, values: Mapping[str, float]) -> list[tuple[Disturbance, str, Mapping[str, float]]]:
        """Return the planned loads, its own and that which is part of the model, each with its place and values."""
        part = self.filtering.given.part
        found: list[tuple[Disturbance, str, Mapping[str, float]]] = []
        if isinstance(self.effect, Disturbance):
            found.append((self.effect, self.place, values))
        if part is not None and isinstance(part.effect, Disturbance):
            found.append((part.effect, part.place, part.now(values)))
        return found

    def wave(self, values: Mapping[str, float]) -> Floats:
        """Return the planned loads at each scan, their mean until the next, (scans,)."""
        f, total = self.filtering, np.zeros(self.filtering.scans)
        for effect, _, own in self._plans(values):
            if own["amplitude"] == 0.0:
                continue
            if isinstance(effect, StepDisturbance):
                total += own["amplitude"] * np.clip((f.time + f.period - own["time"]) / f.period, 0.0, 1.0)
                continue
            t = f.time[:, None] + f.period * (np.arange(FINER) + 0.5) / FINER
            plan = effect.plan(t / own["period"] + own["phase"])  # type: ignore[attr-defined]
            total += own["amplitude"] * plan.mean(axis=1)
        return total

    def filtered(
        self, values: Mapping[str, float], exact: bool | None = None, matrices: Scanned | None = None
    ) -> "Filtered":
        """Return what a filter of the diagram with these values leaves of the record; ``matrices`` if they are known.

        Raises ``NotAffine`` where there is no such filter.
        """
        f = self.filtering
        full = {**self.nominal, **values}
        one = matrices or self.matrices(full)
        a, b = self.numbers(full)
        U = np.column_stack([f.played, f.time, np.ones(f.scans), self.wave(full)])
        exact = (self.law in (laws.CURVED, laws.SLOW) or bool((one.period > 1).any())) if exact is None else exact
        return run(f, one, U, self.law, a, b, exact, self, full)


def _with_sizes(one: Nuisance, values: Mapping[str, float]) -> Nuisance:
    """Return a source of random numbers with its standard deviation and time as fitted, else as stated."""
    T = values.get(f"{one.block}.correlation_time", one.correlation_time)
    return replace(one, sd=values.get(f"{one.block}.sd", one.sd), correlation_time=T)


@dataclass(frozen=True, eq=False)
class Filtered:
    """What an explanation with certain ``values`` leaves: innovations ``e`` (rows, signals) of unit variance if it is
    right, their variances ``S``, and ``OP`` of each controller at each scan; ``mixed`` the loss of each row where many
    filters are one.
    """

    explanation: Explanation
    values: Mapping[str, float]
    e: Floats
    S: Floats
    OP: Floats
    mixed: Floats | None = None

    @cached_property
    def losses(self) -> Floats:
        """Negative log likelihood of each row, without its constant, (rows,).

        What is logged and has no innovation is sure: an output that stands at a limit, or has not been made anew.
        """
        f = self.explanation.filtering
        sure = (np.isnan(self.S) & np.isfinite(f.Y)) @ f.sure
        if self.mixed is not None:
            return np.asarray(sure + self.mixed)
        return np.asarray(sure + 0.5 * (np.nansum(self.e**2, axis=1) + np.nansum(np.log(self.S), axis=1)))

    @cached_property
    def nll(self) -> float:
        """Negative log likelihood of the rows that count."""
        value = float(self.losses[self.explanation.filtering.counted].sum())
        return value if math.isfinite(value) else math.inf

    @cached_property
    def judged(self) -> Floats:
        """The innovations that count."""
        return self.e[self.explanation.filtering.skipped :]


def run(
    f: Filtering, one: Scanned, U: Floats, law: int, a: float, b: float, exact: bool, explanation: Explanation,
    values: Mapping[str, float],
) -> Filtered:  # fmt: skip
    """Return what a filter with these matrices leaves of a record."""
    n, m = one.n, len(f.signals)
    skip = np.zeros(f.Y.shape, dtype=bool)
    for j, c in enumerate(f.acts):
        if c >= 0 and one.period[c] > 1:  # the log shows the same output again, and rounds it to the same value
            scans = (np.arange(len(f.Y)) * f.every - one.offset[c]) // one.period[c]
            same = np.abs(np.diff(f.Y[:, j])) <= 0.5 * np.sqrt(12.0 * f.r[j])
            skip[1:, j] = (np.diff(scans) == 0) & same
    told = one.told if one.told is not None else np.zeros(one.F.shape[1])
    K, s, r, P = np.zeros((m, n)), np.ones(m), f.r, np.zeros((f.every + 1, n, n))
    P[0] = 1e-4 * np.eye(n)
    if not exact:
        A = np.empty((n, n))
        kalman.closed(one.F, one.free, told, n, 1.0, law > 0, A)
        kalman.steady(A, one.Q, one.shown, r, f.every, P, K, s)
    jumps = NOWHERE if exact or law in (laws.CURVED, laws.SLOW) else lifted(one, U, f.every, law)
    e, S = np.empty(f.Y.shape), np.empty(f.Y.shape)
    given = np.empty((f.scans, len(one.v)))
    kalman.filtered(
        one.F, one.v, told, one.H, one.Q, one.limits, one.memory, one.of, one.beyond, one.last, one.period, one.offset,
        one.start, U, f.Y, r, skip, f.acts, f.every, law, a, b, exact, P, K, s, jumps, e, S, given,
    )  # fmt: skip
    S[skip] = np.broadcast_to(kalman.CERTAIN * r, S.shape)[skip]
    return Filtered(explanation, values, e, S, given)

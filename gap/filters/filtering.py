"""A record as a filter reads it, and what one explanation of it leaves: innovations and their likelihood."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from blocks.block import Block
from blocks.role import Role
from diagram.diagram import Diagram
from gap.effect import Effect
from gap.effects.deadband import Deadband
from gap.effects.disturbance import Disturbance
from gap.effects.quantisation import Quantisation
from gap.effects.sensor_noise import SensorNoise
from gap.effects.step_disturbance import StepDisturbance
from gap.effects.stiction import Stiction
from gap.effects.valve_characteristic import ValveCharacteristic
from gap.effects.valve_rate_limit import ValveRateLimit
from gap.effects.valve_saturation import ValveSaturation
from gap.filters import kalman
from gap.filters.affine import NotAffine
from gap.filters.scanned import Scanned, base_period, operating, scanned
from gap.inserted import percent_out
from gap.model import Nuisance, known_within, nuisances
from gap.paths import given, made_of, noise_of
from gap.record import Record, rounding

Floats = NDArray[np.float64]
FINER = 8  # points of a scan at which a planned load is averaged
UNSEEN = 1e9  # variance of a signal that is not there
NEAR = 4  # rows behind a switch of an input that tell of its scan
RARE = 0.1  # share of rows at which an input that switches does so, at most
SKIPPED = 60  # rows at the beginning, and at least the time in which a start is forgotten
UNCHANGED = (SensorNoise, Quantisation)  # effects that change no path of a signal
LAWS = {ValveSaturation: kalman.STOPS, ValveCharacteristic: kalman.CURVED, ValveRateLimit: kalman.SLOW}


@dataclass(frozen=True, eq=False)
class Filtering:
    """``model`` with its nuisances, ``quiet`` without, started as the record starts; ``record``; ``leads`` scans by
    which each switch of an input comes before the row that shows it, (inputs, rows); ``apart``: whether rows just
    behind a switch are left out.
    """

    model: Diagram
    quiet: Diagram
    record: Record
    leads: NDArray[np.int64]
    apart: bool = False

    @cached_property
    def counted(self) -> NDArray[np.bool_]:
        """Which rows count: those behind the start, and ``apart`` those that no switch of an input is near."""
        found = np.arange(len(self.Y)) >= self.skipped
        if self.apart:
            for s in self.record.played:
                moved = np.flatnonzero(np.diff(self.record.log[s]) != 0.0) + 1
                if len(moved) < RARE * len(self.Y):
                    for k in range(NEAR):
                        found[np.minimum(moved + k, len(found) - 1)] = False
        return found

    @cached_property
    def noise(self) -> tuple[Nuisance, ...]:
        """Sources of random numbers."""
        return nuisances(self.model)

    @cached_property
    def period(self) -> float:
        """Scan period [s]."""
        return base_period(self.quiet)

    @cached_property
    def every(self) -> int:
        """Scans between two rows."""
        return round(self.record.log.dt / self.period)

    @cached_property
    def controllers(self) -> tuple[str, ...]:
        """The blocks that scan and act, the outer one of a cascade before those whose set points it moves."""
        found = [b for b in self.quiet.blocks if b.role is Role.CONTROLLER and b.sampled]
        if not found:
            raise NotAffine("the diagram has no controller that scans")
        given_by = {str(b.output_labels[0]): b for b in found}

        def depth(block: Block) -> int:
            behind = [given_by[s] for s in made_of(self.quiet, str(block.loop_signal("SP"))) if s in given_by]
            return 1 + max((depth(b) for b in behind), default=0)

        return tuple(b.name for b in sorted(found, key=depth))

    @cached_property
    def ops(self) -> tuple[str, ...]:
        """The outputs of the controllers."""
        return tuple(str(self.quiet[name].output_labels[0]) for name in self.controllers)

    @cached_property
    def signals(self) -> tuple[str, ...]:
        """Logged signals in the order in which they are taken in: measurements first, then outputs of controllers."""
        return tuple(sorted(self.record.pinned, key=lambda s: self.ops.index(s) if s in self.ops else -1))

    @cached_property
    def acts(self) -> NDArray[np.int64]:
        """Which controller gives each signal, -1 for measurements."""
        return np.array([self.ops.index(s) if s in self.ops else -1 for s in self.signals])

    def op_at(self, place: str) -> str:
        """Return the output of the controller at a place, or of the one that the place follows."""
        block = self.quiet[place]
        behind = [
            str(block.output_labels[0]),
            *(one for s in block.input_labels for one in made_of(self.quiet, str(s))),
        ]
        return next((s for s in behind if s in self.ops), self.ops[-1])

    @cached_property
    def free(self) -> dict[str, tuple[float, float]]:
        """Parameters of the model that are known within a tolerance only, with (low, high)."""
        return known_within(self.quiet)

    @cached_property
    def Y(self) -> Floats:
        """Logged values, (rows, signals); NaN where they are not good."""
        log = self.record.log
        return np.stack([np.where(log.good(s), log[s], np.nan) for s in self.signals], axis=1)

    @cached_property
    def r(self) -> Floats:
        """Variance of the log's rounding of each signal, not quite 0 where it does not round."""
        log = self.record.log
        found = []
        for s in self.signals:
            values = log[s][log.good(s)]
            step = self.record.computed.get(s, 0.0) or rounding(values)
            found.append(max(step**2 / 12.0, 1e-12 * float(np.var(values))) if len(values) else UNSEEN)
        return np.array(found)

    @cached_property
    def sure(self) -> Floats:
        """Loss of a value of each signal that is sure, (signals,): the likelihood of a rounded value is 1/step."""
        return np.asarray(0.5 * np.log(12.0 * self.r / (2.0 * np.pi)))

    @cached_property
    def skipped(self) -> int:
        """Rows at the beginning that are not judged."""
        return min(SKIPPED, len(self.Y) // 4)

    @cached_property
    def scans(self) -> int:
        """Scans of the whole record."""
        return (len(self.Y) - 1) * self.every + 1

    @cached_property
    def time(self) -> Floats:
        """Time of each scan [s]."""
        return np.asarray(float(self.record.log.t[0]) + self.period * np.arange(self.scans))

    @cached_property
    def played(self) -> Floats:
        """Logged inputs at each scan, (scans, inputs)."""
        log = self.record.log
        found = np.empty((self.scans, len(self.record.played)))
        for j, s in enumerate(self.record.played):
            found[:, j] = np.repeat(log[s], self.every)[: self.scans]
            for row in np.flatnonzero(self.leads[j, 1:] * np.diff(log[s])) + 1:
                found[row * self.every - self.leads[j, row] : row * self.every, j] = log[s][row]
        return found

    @cached_property
    def seen(self) -> dict[str, float]:
        """Mean of each logged signal."""
        return {s: float(np.nanmean(self.record.log[s])) for s in (*self.record.played, *self.record.pinned)}

    def with_leads(self, leads: NDArray[np.int64]) -> "Filtering":
        """Return the same record with other scans at which its inputs switch."""
        return replace(self, leads=leads)


@dataclass(frozen=True, eq=False)
class Explanation:
    """An effect at a place, or none, as a filter sees it."""

    filtering: Filtering
    effect: Effect | None = None
    place: str = ""

    @cached_property
    def law(self) -> int:
        """Which law of the valve the effect is (``kalman``)."""
        return LAWS.get(type(self.effect), kalman.NONE)  # type: ignore[arg-type]

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
        return own | {key: float(self.filtering.quiet.params[key]) for key in self.filtering.free}

    @cached_property
    def own(self) -> tuple[str, ...]:
        """Parameters of the effect."""
        return tuple(p.name for p in self.effect.parameters) if self.effect else ()

    def matrices(self, values: Mapping[str, float]) -> Scanned:
        """Return the matrices of the diagram with these values."""
        f = self.filtering
        own = {name: values[name] for name in self.own}
        params = {key: values[key] for key in f.free}
        noise = f.noise
        if isinstance(self.effect, SensorNoise):
            noisy = str(noise_of(f.model, f.model[self.place]))
            noise = tuple(replace(n, sd=n.sd * own["factor"]) if n.block == noisy else n for n in noise)
        elif isinstance(self.effect, Quantisation):
            noisy = str(noise_of(f.model, f.model[self.place]))
            noise = tuple(
                replace(n, sd=math.sqrt(n.sd**2 + own["step"] ** 2 / 12.0)) if n.block == noisy else n for n in noise
            )
        elif self.effect is not None and not (self.law or self.load or self.sticks):
            params |= self.effect.settings(f.quiet, self.place, **own)
        valve = given(f.quiet, self.place) if self.law or self.sticks else ""
        load = str(f.quiet[self.place].output_labels[0]) if self.load else ""
        blocks = self._blocks(params)
        return scanned(blocks, noise, f.controllers, f.signals, f.record.played, self.near, valve, load, f.period)

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
        if self.law == kalman.NONE:
            return 0.0, 0.0
        percent = percent_out(f.quiet, self.place)
        if self.law == kalman.STOPS:
            low, high = values["low"], values["high"]
            return (low * percent if low > 0.0 else -math.inf), (high * percent if high < 100.0 else math.inf)
        if self.law == kalman.SLOW:
            return values["rate"] * percent * f.period, 0.0
        if abs(100.0 * percent - 1.0) > 1e-9:
            raise NotAffine("a characteristic needs an opening from 0 to 1")
        return values["rangeability"], 0.0

    def wave(self, values: Mapping[str, float]) -> Floats:
        """Return the planned load at each scan, its mean until the next, (scans,)."""
        f = self.filtering
        if not self.load or values["amplitude"] == 0.0:
            return np.zeros(f.scans)
        if isinstance(self.effect, StepDisturbance):
            share = np.clip((f.time + f.period - values["time"]) / f.period, 0.0, 1.0)
            return np.asarray(values["amplitude"] * share)
        t = f.time[:, None] + f.period * (np.arange(FINER) + 0.5) / FINER
        turns = t / values["period"] + values["phase"]
        plan = self.effect.plan(turns)  # type: ignore[union-attr]
        return np.asarray(values["amplitude"] * plan.mean(axis=1))

    def filtered(self, values: Mapping[str, float], exact: bool | None = None) -> "Filtered":
        """Return what a filter of the diagram with these values leaves of the record.

        Raises ``NotAffine`` where there is no such filter.
        """
        f = self.filtering
        full = {**self.nominal, **values}
        one = self.matrices(full)
        a, b = self.numbers(full)
        U = np.column_stack([f.played, f.time, np.ones(f.scans), self.wave(full)])
        exact = (self.law != kalman.NONE or bool((one.period > 1).any())) if exact is None else exact
        return run(f, one, U, self.law, a, b, exact, self, full)


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
        """Negative logarithm of the likelihood of each row, without its constant, (rows,) [nats].

        What is logged and has no innovation is sure: an output that stands at a limit, or has not been made anew.
        """
        f = self.explanation.filtering
        sure = (np.isnan(self.S) & np.isfinite(f.Y)) @ f.sure
        if self.mixed is not None:
            return np.asarray(sure + self.mixed)
        return np.asarray(sure + 0.5 * (np.nansum(self.e**2, axis=1) + np.nansum(np.log(self.S), axis=1)))

    @cached_property
    def nll(self) -> float:
        """Negative logarithm of the likelihood of the rows that count [nats]."""
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
    e, S = np.empty(f.Y.shape), np.empty(f.Y.shape)
    given = np.empty((f.scans, len(one.v)))
    kalman.filtered(
        one.F, one.v, told, one.H, one.Q, one.limits, one.memory, one.of, one.beyond, one.last, one.period, one.offset,
        one.start, U, f.Y, r, skip, f.acts, f.every, law, a, b, exact, P, K, s, e, S, given,
    )  # fmt: skip
    S[skip] = np.broadcast_to(kalman.CERTAIN * r, S.shape)[skip]
    return Filtered(explanation, values, e, S, given)

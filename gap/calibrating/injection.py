"""Runs of a model with a known effect, at the operating point of a record: what a diagnosis is calibrated on.

Every effect at every place where it may be, with sizes from twice to fifty times the least that would show, evenly in
their logarithm; set points, rows, rounding and missing rows are those of the record, noise and loads the model's own,
parameters with a tolerance anywhere within it.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from stickslip.gap.insertion.effect import Effect, Parameter
from stickslip.gap.likelihood.fit import Fit
from stickslip.gap.likelihood.frame import Frame
from stickslip.gap.likelihood.hidden import least_shown
from stickslip.gap.likelihood.hypothesis import Hypothesis
from stickslip.gap.null_model.null_model import without_gap
from stickslip.logs import Log

KNOWN_WITHIN = (1,)  # of the seed of a run: the random numbers of parameters that are known within a tolerance only
LEAST, MOST = 2.0, 50.0  # sizes in multiples of the least that would show
JUMP = (0.2, 0.8)  # second size of a hidden effect, in shares of the first
REACHED = (0.5, 0.98)  # quantiles of the signal at which limits are put
MIDDLE = (0.15, 0.85)  # of the record, in which a step lies
PERIODS = (20.0, 1.0 / 8.0)  # shortest in rows, longest as a share of the record


@dataclass(frozen=True)
class Injection:
    """One run: ``effect`` (None for none) at ``place`` with ``values``, ``seed`` of its noise; ``key`` its name.

    ``main`` is the parameter that is its size.
    """

    key: str
    effect: Effect | None
    place: str
    values: Mapping[str, float]
    seed: int
    main: str = ""

    def made(self, frame: Frame) -> Log | None:
        """Return the log of the run, None if it failed."""
        model, record = frame.model, frame.record
        rng = np.random.default_rng([self.seed, *KNOWN_WITHIN])
        model = model.with_params({key: float(rng.uniform(*ends)) for key, ends in sorted(frame.given.unsure.items())})
        if self.effect is not None and not self.effect.of_log:
            model = self.effect.insert(model, self.place, **self.values)
            if any(block.name.startswith(self.effect.block(self.place)) for block in model.blocks):
                model = self.effect.started(model, self.place, record.first)
        logs = without_gap(model, record, 1, self.seed)
        if not logs:
            return None
        return self.effect.on_log(logs[0], self.place, **self.values) if self.effect else logs[0]


def injections(null: Fit, legal: Sequence[Hypothesis], runs: int, seed: int) -> Iterator[Injection]:
    """Yield ``runs`` runs of every effect and as many times five without one; ``null`` the model alone, on a record
    without a gap.
    """
    for k in range(runs):
        for n, one in enumerate(legal):
            assert one.effect is not None
            rng = np.random.default_rng([seed, k, n])
            key = f"{one.effect.name} at {one.place} {seed}.{k}"
            values = _drawn(null, one, rng)
            if values is not None:
                main = "high" if one.bends else _size(one).name
                yield Injection(key, one.effect, one.place, values, 10_000 + 1000 * seed + 100 * k + n, main)
        for n in range(5):
            yield Injection(f"none {seed}.{k}.{n}", None, "", {}, 500_000 + 1000 * seed + 10 * k + n)


def _size(one: Hypothesis) -> Parameter:
    """Return the first size of an effect."""
    assert one.effect is not None
    return next(p for p in one.effect.parameters if not p.nuisance)


def _drawn(null: Fit, one: Hypothesis, rng: np.random.Generator) -> dict[str, float] | None:
    """Return random sizes of an effect; None where the record cannot feel it."""
    effect, f = one.effect, null.hypothesis.frame
    assert effect is not None
    nominal = {name: one.nominal[name] for name in one.own}
    if one.bends:
        _, known, zero, to_unit = one.reached
        seen = (known - zero) * to_unit
        return {"low": nominal["low"], "high": float(np.quantile(seen, rng.uniform(*REACHED)))} if len(seen) else None
    p = _size(one)
    low, high = one.bounds[p.name]
    start = nominal[p.name]
    least = None if effect.of_log else least_shown(null, one, p)
    if least is None:
        size = float(np.exp(rng.uniform(*np.log([low, high])))) if low > 0.0 else float(rng.uniform(low, high))
    else:
        sign = -1.0 if low < start and rng.random() < 0.5 else 1.0
        times = float(np.exp(rng.uniform(np.log(LEAST), np.log(MOST))))
        size = start + sign * times * least
    values = {**nominal, p.name: float(np.clip(size, low, high))}
    t = f.record.log.t
    duration, dt = f.record.log.duration, f.record.log.dt
    for p in effect.parameters[1:]:
        if effect.hidden:
            values[p.name] = values[one.own[0]] * float(rng.uniform(*JUMP))
        elif p.name == "time":
            values[p.name] = float(t[0]) + duration * float(rng.uniform(*MIDDLE))
        elif p.name == "period":
            values[p.name] = float(np.exp(rng.uniform(np.log(PERIODS[0] * dt), np.log(PERIODS[1] * duration))))
        elif p.name == "phase":
            values[p.name] = float(rng.uniform())
    return None if effect.rules(f.model, one.place, values) else values

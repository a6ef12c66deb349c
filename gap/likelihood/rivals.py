"""Rivals of a named effect, which are in no catalogue: what would suit the record as well if its cause were unknown.

In its place: one more random signal where the model has one, slow or in between; of a planned load the same plan as a
change of a valve's gain, or of what a sensor shows.  Beside it: one more random signal, to which an effect that is
right leaves nothing.  Each is a hypothesis like any other, with a price for its sizes.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

from stickslip.blocks.arithmetic import Sum
from stickslip.blocks.noise import Noise
from stickslip.blocks.product import Product
from stickslip.blocks.role import Role
from stickslip.diagram import wire
from stickslip.diagram.diagram import Diagram
from stickslip.gap.effects.disturbance import Disturbance
from stickslip.gap.effects.sine_disturbance import SineDisturbance
from stickslip.gap.fits.loads import is_load
from stickslip.gap.insertion.added import with_added
from stickslip.gap.insertion.effect import Effect, Parameter
from stickslip.gap.insertion.paths import given, users
from stickslip.gap.likelihood.beside import with_effect
from stickslip.gap.likelihood.fit import Fit, refined, tried
from stickslip.gap.likelihood.hypothesis import Hypothesis, Innovations
from stickslip.gap.likelihood.search import price
from stickslip.gap.likelihood.settling import free_names
from stickslip.gap.likelihood.verdict import Verdict

BANDS = (1.0 / 600.0, 1.0 / 40.0, 1.0 / 6.0)  # correlation times, in records
SIZES = (0.15, 0.4, 1.0, 2.5)  # of what the source gives in the model
NEARBY, ROUNDS = (0.6, 1.6), 3  # sizes near the likeliest of these; rounds of a fit
MOST, LEAST = 10.0, 1e-4  # times the first size of a plan, and share of that
SMALLEST = 1e-9  # usual value of a signal


class RandomSignal(Effect):
    """One more random signal at a block that draws one."""

    name = "random_signal"
    parameters = (Parameter("sd", "-", 0.0, 0.0, math.inf), Parameter("correlation_time", "s", 0.0, 0.0, math.inf))

    def put(self, diagram: Diagram, place: str) -> Diagram:
        """Return the diagram with the signal added to what the block gives."""
        dt = float(diagram[place].period)
        wave = Noise("wave", 1.0, dt, correlation_time=1.0)
        return with_added(diagram, given(diagram, place), wave, self.block(place))

    def settings(self, diagram: Diagram, place: str, **values: Any) -> dict[str, Any]:
        """Return its size and its correlation time."""
        return {f"{self.block(place)}/wave.{key}": value for key, value in values.items()}


@dataclass(frozen=True)
class SamePlan(Effect):
    """What a planned ``load`` at a ``feed`` does, as a relative change of the ``gain`` of a valve, or as what a sensor
    adds to its signal; ``most`` of it.
    """

    load: Disturbance
    feed: str
    gain: bool
    most: float

    @property
    def name(self) -> str:  # type: ignore[override]
        """The name of its blocks."""
        return f"plan_of_{self.load.name}"

    @property
    def parameters(self) -> tuple[Parameter, ...]:  # type: ignore[override]
        """Those of the load."""
        return self.load.parameters

    def put(self, diagram: Diagram, place: str) -> Diagram:
        """Return the diagram with the same plan elsewhere."""
        signal = given(diagram, place)
        if not self.gain:
            return with_added(diagram, signal, self.load.wave(), self.block(place))
        changed = [self.load.wave(), Product("part", ["in", "wave"]), Sum("out", {"in": 1.0, "part": 1.0}, name="sum")]
        inserted = wire(changed, ["in"], ["out"], name=self.block(place))
        return diagram.insert(signal, inserted, readers=users(diagram, signal))

    def settings(self, diagram: Diagram, place: str, **values: Any) -> dict[str, Any]:
        """Return the parameters of the wave."""
        there = self.load.settings(diagram, self.feed, **values)
        return {key.replace(self.load.block(self.feed), self.block(place)): value for key, value in there.items()}

    def bounds(self, diagram: Diagram, place: str) -> dict[str, tuple[float, float]]:
        """Return the bounds of the load, its amplitude another."""
        found = self.load.bounds(diagram, self.feed)
        return found | {"amplitude": (-self.most if found["amplitude"][0] < 0.0 else LEAST * self.most, self.most)}


def likelier(fit: Fit, null: Fit, unsure: float = 0.0) -> str:
    """Return the name of a rival that suits the record better than a fitted effect, by its price; "" if none does.

    ``unsure``: by how much a rival may lag behind and still not be told from the effect [nats].
    """
    own = price(fit) - unsure
    for rival in (*_same_plans(fit), *_random_alone(fit, null)):
        if price(rival) < own:
            return str(rival.hypothesis)
    return ""


def beside_random(fit: Fit, verdict: Verdict) -> Verdict:
    """Return a verdict on an effect with one figure more: what one more random signal beside it gains.

    2 (nats gained) is 0 in half of all records if the effect is right, else chi-squared of one degree.
    """
    if fit.hypothesis.hides or fit.hypothesis.frame.replays:
        return verdict
    both = Hypothesis(with_effect(fit))
    start = tried(both, {**both.frame.stated, **{key: fit.best.values[key] for key in fit.hypothesis.frame.free}})
    best = None if start is None else _with_random(start)
    if best is None or start is None:
        return verdict
    size, place = math.sqrt(2.0 * (start.nll - best.nll)), best.hypothesis.place
    return replace(verdict, size=size, name=f"a random signal at {place}") if size > verdict.size else verdict


def _random_alone(fit: Fit, null: Fit) -> Iterator[Fit]:
    """Yield the likeliest random signal in place of an effect."""
    bare = Hypothesis(fit.hypothesis.frame)
    for values in (fit.best.values, null.best.values):
        start = tried(bare, {key: values[key] for key in bare.frame.free})
        best = None if start is None else _with_random(start)
        if best is not None:
            yield refined(best, tuple(bare.frame.free), ROUNDS)


def _with_random(start: Innovations) -> Innovations | None:
    """Return what is left with one more random signal of the likeliest of some sizes; None where all are worse."""
    frame = start.hypothesis.frame
    long = float(frame.record.log.t[-1] - frame.record.log.t[0])
    best = start
    for source in frame.noise:
        one = Hypothesis(frame, RandomSignal(), source.block)
        for band in BANDS:
            near = start
            for size in SIZES:
                sizes = {"sd": size * source.sd, "correlation_time": band * long}
                new = tried(one, {**start.values, **sizes}, best=near)
                if new is None or new.nll >= near.nll:
                    break
                near = new
            best = near if near.nll < best.nll else best
    if best is start:
        return None
    for key in ("sd", "correlation_time"):
        for by in NEARBY:
            new = tried(best.hypothesis, {**best.values, key: by * best.values[key]}, best=best)
            best = new if new is not None and new.nll < best.nll else best
    return best


def _same_plans(fit: Fit) -> Iterator[Fit]:
    """Yield fits of what follows the plan of a load elsewhere; of a sine a sensor's error leaves the same log."""
    one = fit.hypothesis
    effect = one.effect
    if not isinstance(effect, Disturbance) or not is_load(effect):
        return
    f, values = one.frame, fit.best.values
    places = [(b.name, True) for b in f.model.blocks if b.role is Role.VALVE and ":" not in b.name]
    if not isinstance(effect, SineDisturbance):
        places += [(b.name, False) for b in f.model.blocks if b.role is Role.SENSOR and ":" not in b.name]
    for place, gain in places:
        usual = max(abs(f.first.get(given(f.model, place), 1.0)), SMALLEST) if gain else 1.0
        size = values["amplitude"] / usual
        rival = Hypothesis(f, SamePlan(effect, one.place, gain, MOST * abs(size)), place)
        sizes = {name: values[name] for name in one.own}
        starts = [tried(rival, {**values, **sizes, "amplitude": way * size}) for way in (1.0, -1.0)]
        best = min((x for x in starts if x is not None), key=lambda x: x.nll, default=None)
        if best is not None:
            yield refined(best, free_names(rival), ROUNDS)

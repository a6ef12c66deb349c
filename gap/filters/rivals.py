"""Generic rivals of an explanation: what would suit the record better if the true effect were in no catalogue.

Beside it: one more random signal at each source of random numbers, white, slow or in between.  An explanation that is
right leaves nothing to it: 2 (nats gained) is then 0 in half of all records, else chi-squared of one degree.

In its place: such a signal alone; of a planned load the same plan as a change of the gain, or of what the sensor shows;
of more noise of a sensor noise that grows with the signal.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from stickslip.gap.effects.quantisation import Quantisation
from stickslip.gap.effects.scan_time import ScanTime
from stickslip.gap.effects.sensor_noise import SensorNoise
from stickslip.gap.effects.sensor_saturation import SensorSaturation
from stickslip.gap.effects.sine_disturbance import SineDisturbance
from stickslip.gap.filters.checks import CALM
from stickslip.gap.filters.constant import FRESH
from stickslip.gap.filters.explaining import free_names
from stickslip.gap.filters.filtering import Explanation, Filtered
from stickslip.gap.filters.fitting import directions, refined, tried
from stickslip.gap.filters.growing import growing
from stickslip.gap.records.model import Nuisance

Floats = NDArray[np.float64]
BANDS = (0.0, 1.0 / 600.0, 1.0 / 40.0, 1.0 / 6.0)  # correlation times, in records; 0 is white
SIZES = (0.15, 0.4, 1.0, 2.5)  # of what the source gives in the model
NEARBY, ROUNDS = (0.7, 1.4), 3  # sizes near the best; steps of its fit
LITTLE = 0.01  # relative size of a little of an effect
OVERTONES = (2, 3)  # of a periodic load that are looked at
TIE = 4.0  # nats by which a wrong one may be ahead by chance: explanations that the record does not separate
LIKE = 1.0  # nats the same of a gain that follows a plan, and of noise that grows: which of the two is likelier decides


def randoms(one: Explanation) -> Iterator[Nuisance]:
    """Yield random signals that a record may contain in addition to the model, each of the size of its source."""
    f = one.filtering
    long = float(f.time[-1] - f.time[0])
    for source in f.noise:
        for band in BANDS:
            yield Nuisance(source.block, source.sd, band * long)


def with_random(now: Filtered, random: Nuisance) -> Filtered:
    """Return the explanation with an additional random signal of the best of a few sizes; itself if none is more
    likely.
    """
    best = now
    for size in SIZES:
        beside = replace(random, sd=size * random.sd)
        new = tried(replace(now.explanation, beside=(beside,)), now.values)
        if new is None or new.nll >= best.nll:
            break
        best = new
    return best


def beside(now: Filtered) -> dict[str, float]:
    """Return name -> gain of each additional random signal, as sqrt(2 log likelihood ratio), never below 0.

    None for a bank of stems, which has no room for one.
    """
    if now.mixed is not None:
        return {}
    found = {}
    for random in randoms(now.explanation):
        gained = now.nll - with_random(now, random).nll
        found[f"beside it {random}"] = math.sqrt(2.0 * max(gained, 0.0))
    return found


def either_way(now: Filtered) -> dict[str, float]:
    """Return name -> figure of whether a small additional effect, or its opposite, fits the record.

        e . v / |v|      v: slope of the innovations in the size of that effect, less its projection on those of the fit

    Normal if the explanation is right.  The opposite of a lag is a lead, which no catalogue has.
    """
    f, first = now.explanation.filtering, now.explanation.filtering.skipped
    if now.mixed is not None or isinstance(now.explanation.effect, ScanTime):
        return {}
    free = {key: now.values[key] for key in f.free}
    bare, slopes = tried(Explanation(f), free), directions(now)
    if bare is None or not slopes:
        return {}
    basis, _ = np.linalg.qr(np.stack([d[first:].ravel() for d in slopes.values()], axis=1))
    e = np.clip(np.nan_to_num(now.judged), -CALM, CALM).ravel()
    pairs = []
    for effect in f.catalogue:
        for place in f.given.places(effect):
            size = _little(Explanation(f, effect, place))
            if size:
                name = f"beside it {effect.name} at {place}, or its opposite"
                pairs.append((name, bare, tried(Explanation(f, effect, place), free | size)))
    pairs += [(name, now, tried(one, now.values)) for name, one in _overtones(now.explanation)]
    found = {}
    for name, without, moved in pairs:
        if moved is None:
            continue
        change = (moved.e * np.sqrt(moved.S) - without.e * np.sqrt(without.S)) / np.sqrt(now.S)
        d = np.nan_to_num(change[first:]).ravel()
        own = d - basis @ (basis.T @ d)
        length = float(np.sqrt(own @ own))
        if length > FRESH * float(np.sqrt(d @ d)):
            found[name] = float(e @ own) / length
    return found


@dataclass(frozen=True, eq=False)
class Overtone(Explanation):
    """A periodic load with a small additional sine, ``turns`` in a period, ``shift`` of a turn later."""

    turns: int = 2
    shift: float = 0.0

    def wave(self, values):  # type: ignore[no-untyped-def]
        """Return the load at each scan."""
        t = self.filtering.time + 0.5 * self.filtering.period
        at = self.turns * (t / values["period"] + values["phase"]) + self.shift
        return super().wave(values) + LITTLE * values["amplitude"] * np.sin(2.0 * np.pi * at)


def _overtones(one: Explanation) -> Iterator[tuple[str, Explanation]]:
    """Yield a periodic load with a little of another shape, by name."""
    if one.load and "period" in one.own:
        for turns in OVERTONES:
            for shift in (0.0, 0.25):
                name = f"beside it a load {turns} times as fast, {shift:g} of its period later"
                yield name, Overtone(one.filtering, one.effect, one.place, turns=turns, shift=shift)


def _little(one: Explanation) -> dict[str, float]:
    """Return a small size of an effect that has one size, moves paths of signals and can be small; else nothing."""
    plain = isinstance(one.effect, SensorNoise | SensorSaturation | Quantisation | ScanTime)
    if one.effect is None or one.effect.of_log or one.effect.hidden or plain or one.load or len(one.own) != 1:
        return {}
    (name,) = one.own
    (low, high), nominal = one.bounds[name], one.nominal[name]
    if not math.isfinite(nominal):
        return {}
    if nominal != 0.0:
        return {name: (1.0 + LITTLE) * nominal}
    return {name: max(low, 0.1 * LITTLE * high) if low >= 0.0 else 0.1 * LITTLE * (high - low)}


class Rival(NamedTuple):
    """A rival of an explanation: ``behind`` in log likelihood, of which ``chance`` alone may explain a part."""

    name: str
    behind: float
    chance: float = 0.0

    @property
    def likelier(self) -> bool:
        """Whether it suits the record better than chance makes it."""
        return self.behind <= -self.chance


def likeliest(now: Filtered) -> Rival:
    """Return the rival that comes nearest to taking the place of an explanation; infinitely far behind for none."""
    found = [Rival(name, loss - now.nll, TIE) for name, loss in _random(now).items()]
    found += [Rival(name, loss - now.nll, LIKE) for name, loss in growing(now).items()]
    return min((*found, *_elsewhere(now)), key=lambda one: one.behind + one.chance, default=Rival("", math.inf))


def _random(now: Filtered) -> dict[str, float]:
    """Return the loss of the likeliest random signal without the effect, its size and the model's own fitted."""
    f = now.explanation.filtering
    bare = tried(Explanation(f), {key: now.values[key] for key in f.free})
    if bare is None:
        return {}
    noisy = {source.block for source in f.noise if source.correlation_time == 0.0}  # more of it is in the catalogue
    rivals = [one for one in randoms(bare.explanation) if one.correlation_time > 0.0 or one.block not in noisy]
    best = min((with_random(bare, one) for one in rivals), key=lambda x: x.nll)
    if best is bare:
        return {}
    best = refined(best, tuple(f.free), ROUNDS).best
    (random,) = best.explanation.beside
    for by in NEARBY:
        new = tried(replace(best.explanation, beside=(replace(random, sd=by * random.sd),)), best.values)
        best = new if new is not None and new.nll < best.nll else best
    return {f"a random signal at {random.block}": best.nll}


@dataclass(frozen=True, eq=False)
class Elsewhere(Explanation):
    """A planned load as something else that follows the same plan: ``signal`` to which it is added, times ``by``."""

    signal: str = ""
    by: Floats | float = 1.0

    @property
    def moved(self) -> str:
        """The signal to which it is added."""
        return self.signal

    def wave(self, values):  # type: ignore[no-untyped-def]
        """Return what is added at each scan."""
        return super().wave(values) * self.by


def _elsewhere(now: Filtered) -> Iterator[Rival]:
    """Yield rivals that follow the same plan as a load; none for other explanations.

    A sine that is added to what the sensor shows leaves the log of a sine at the feed.
    """
    one, f = now.explanation, now.explanation.filtering
    if not one.load:
        return
    op = np.repeat(f.record.log[f.op_at(one.place)], f.every)[: f.scans]
    op = np.where(np.isfinite(op), op, np.nanmean(op))
    rivals: list[tuple[str, str, Floats | float, float]] = [
        ("a gain that follows the same plan", one.moved, op / op.mean(), LIKE)
    ]
    if not isinstance(one.effect, SineDisturbance):
        for s in f.signals:
            if s not in f.ops:
                scale = float(np.nanstd(f.record.log[s]) / np.nanstd(op))
                rivals.append((f"an error of {s} that follows the same plan", s, scale, TIE))
    for name, signal, by, chance in rivals:
        start = tried(Elsewhere(f, one.effect, one.place, (), signal, by), now.values)
        if start is not None:
            yield Rival(name, refined(start, free_names(start.explanation)).nll - now.nll, chance)

"""What the digits of a measurement show, which no likelihood of rows does: a coarse sensor, a compressing historian."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from stickslip.gap.effects.compression import Compression
from stickslip.gap.effects.quantisation import Quantisation
from stickslip.gap.effects.sensor_noise import SensorNoise
from stickslip.gap.fits.digits import FEW, coarse, deviation, measured_by, straightened, unstated
from stickslip.gap.insertion.effect import Effect
from stickslip.gap.insertion.paths import noise_of
from stickslip.gap.likelihood.fit import Fit, refined, tried, unfitted
from stickslip.gap.likelihood.frame import SEEN_FINER
from stickslip.gap.likelihood.hypothesis import Hypothesis
from stickslip.gap.likelihood.judge import enough, judged
from stickslip.gap.likelihood.replay import Replays
from stickslip.gap.likelihood.settling import free_names
from stickslip.gap.likelihood.verdict import Verdict
from stickslip.gap.null_model.null_model import residuals, without_gap
from stickslip.gap.records.offsets import offsets
from stickslip.gap.records.record import rounding
from stickslip.logs.normal import OF_SIZES

NOISIER = 2.0  # times the noise that levels and the stated noise make, beyond which something else is wrong
IN_ACCORD, MOST = 0.3, 0.8  # of the usual size: so small are most residuals that no rounding of the log has made
LATTICE_RUNS = 6  # of the model, which tell how much is usual
MORE_LIKELY = 10.0  # nats by which the controller has to have seen the steps, if the log may have made them


def by_digits(null: Fit, alone: Verdict, catalogue: Sequence[Effect], seed: int) -> Fit | None:
    """Return the effect that the digits of the log show; None if they show none.

    ``alone`` is how unusual what the model alone leaves is.
    """
    for effect in catalogue:
        if isinstance(effect, Quantisation):
            for place in effect.places(null.hypothesis.frame.model):
                found = _coarse(null, alone, effect, place, seed)
                if found is not None:
                    return found
        if isinstance(effect, Compression):
            found = _compressed(null, effect, seed)
            if found is not None:
                return found
    return None


def shows_steps(null: Fit) -> bool:
    """Return whether a measurement has few levels, which nothing but a coarse sensor leaves."""
    f = null.hypothesis.frame
    return any(coarse(f, place) for place in Quantisation().places(f.model))


def _coarse(null: Fit, alone: Verdict, effect: Effect, place: str, seed: int) -> Fit | None:
    """Return a sensor of few levels; if the log is no finer than these, the controller has to have seen them.

    Then it has to be enough as well, beside runs with such a sensor, for noise of any size gains much where something
    else is wrong.
    """
    f = null.best.hypothesis.frame
    step = coarse(f, place)
    if step:
        return _as(null, Hypothesis(f, effect, place), {"step": step})
    signal, values = measured_by(f, place)
    step = unstated(f, place, rounding(values))
    if not step or len(np.unique(values)) > FEW * len(values):
        return None
    if isinstance(f, Replays):
        return _as(null, Hypothesis(f, effect, place), {"step": step}) if _seen(f, signal, seed) else None
    f = replace(f, record=replace(f.record, computed={**f.record.computed, signal: SEEN_FINER * step}))
    noisier = Hypothesis(f, SensorNoise(), place)
    start = tried(noisier, null.best.values) if place in SensorNoise().places(f.model) else null.best
    if start is None:
        return None
    fit = refined(start, free_names(start.hypothesis))
    if fit.best.values.get("factor", 1.0) > most_noise(start.hypothesis, step):
        return None
    found = _as(fit, Hypothesis(f, effect, place), {"step": step})
    stated = {key: size for key, size in f.stated.items() if key.endswith(".sd")}  # levels are not noise as well
    made = found.hypothesis.model({**found.best.values, **stated})
    if fit.nll > null.nll - MORE_LIKELY or not enough(fit, judged(fit, [], seed, null, made), alone, null):
        return None
    return found


def most_noise(noisier: Hypothesis, step: float) -> float:
    """Return the factor on a sensor's noise up to which levels may stand for it: those of a step add step/sqrt(12)."""
    source = noise_of(noisier.frame.model, noisier.frame.model[noisier.place])
    sd = noisier.frame.model[source].params["sd"] if source else 0.0
    return NOISIER * math.hypot(1.0, step / math.sqrt(12.0) / sd) if sd > 0.0 else math.inf


def _seen(f: Replays, signal: str, seed: int) -> bool:
    """Return whether the controller has seen the steps of a signal: others accord better than rounding allows."""
    if f.record.filter is not None:  # which takes the controllers' accord for itself
        return False
    logs = without_gap(f.model, f.record, LATTICE_RUNS, seed)
    sizes = [
        np.abs(residuals(found, f.null_model.changes))[:, f.skipped :]
        for found in (offsets(f.quiet, f.record), offsets(f.quiet, f.record, logs=logs))
    ]
    own, usual = (np.nanquantile(one, MOST, axis=(0, 1)) for one in sizes)
    others = np.array([s != signal for s in f.record.pinned])
    return bool((own < IN_ACCORD * usual)[others].any())


def _compressed(null: Fit, effect: Effect, seed: int) -> Fit | None:
    """Return a compression that makes as many straight lines as the log has, if these are more than the model's own."""
    f = null.best.hypothesis.frame
    place = next(iter(effect.places(f.model)), "historian")
    fitted = {key: null.best.values[key] for key in f.free}
    usual = OF_SIZES * float(np.nanmin(np.nanmedian(np.abs(null.best.e), axis=0)))  # what shows in few rows is no noise
    less = {key: usual * size for key, size in fitted.items() if key.endswith(".sd")}
    signal = straightened(f, seed, [fitted, {**fitted, **less}] if fitted else [])
    size = deviation(f, f.stated, Compression(signal), place, signal, seed) if signal else None
    return _as(null, Hypothesis(f, effect, place), {"deviation": size}) if size is not None else None


def _as(fit: Fit, one: Hypothesis, size: dict[str, float]) -> Fit:
    """Return a fit under the name of an effect that leaves the same."""
    values = {**{key: fit.best.values[key] for key in one.frame.free}, **size}
    return unfitted(replace(fit.best, hypothesis=one, values=values))

"""What the digits of a measurement show, which no likelihood of rows does: a coarse sensor, a compressing historian."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from stickslip.gap.effects.compression import Compression
from stickslip.gap.effects.quantisation import Quantisation
from stickslip.gap.effects.sensor_noise import SensorNoise
from stickslip.gap.filters.digits import FEW, STRAIGHT, levels
from stickslip.gap.floors.floor import without_gap
from stickslip.gap.insertion.effect import Effect
from stickslip.gap.insertion.straightness import deviation_of, sloping
from stickslip.gap.likelihood.fit import Fit, refined, tried, unfitted
from stickslip.gap.likelihood.hypothesis import Hypothesis
from stickslip.gap.likelihood.settling import free_names
from stickslip.gap.records.record import rounding

NO_WORSE = 1.0  # nat: its steps may be within what is free of the noise already
MORE_LIKELY = 10.0  # nats by which the controller has to have seen the steps, if the log may have made them
SEEN_FINER = 1e-3  # of a step that the controller has seen: so well it is known then
NEITHER_COARSER = 0.5  # of the step that the levels show: a model whose sensor has such a step has none to find


def by_digits(null: Fit, catalogue: Sequence[Effect], seed: int) -> Fit | None:
    """Return the effect that the digits of the log show; None if they show none."""
    for effect in catalogue:
        if isinstance(effect, Quantisation):
            for place in effect.places(null.hypothesis.frame.model):
                found = _coarse(null, effect, place)
                if found is not None:
                    return found
        if isinstance(effect, Compression):
            found = _compressed(null, effect, seed)
            if found is not None:
                return found
    return None


def _coarse(null: Fit, effect: Effect, place: str) -> Fit | None:
    """Return a sensor of few levels if its signal has them, and more of its noise, which steps are, is likelier."""
    f = null.best.hypothesis.frame
    signal = next((str(s) for s in f.quiet[place].output_labels if str(s) in f.signals), "")
    values = f.Y[:, f.signals.index(signal)] if signal else np.zeros(0)
    step, better = levels(values), -NO_WORSE
    if not step and len(np.unique(values)) <= FEW * len(
        values
    ):  # the log's own rounding, or did the controller see it?
        step, better = rounding(values), MORE_LIKELY
        f = replace(f, record=replace(f.record, computed={**f.record.computed, signal: SEEN_FINER * step}))
    if not step or float(f.quiet[place].params.get("step", 0.0)) > NEITHER_COARSER * step:
        return None
    noisier = Hypothesis(f, SensorNoise(), place)
    start = tried(noisier, null.best.values) if place in SensorNoise().places(f.model) else null.best
    if start is None:
        return None
    fit = refined(start, free_names(start.hypothesis))
    return _as(fit, Hypothesis(f, effect, place), {"step": step}) if fit.nll <= null.nll - better else None


def _compressed(null: Fit, effect: Effect, seed: int) -> Fit | None:
    """Return a compression that makes as many straight lines as the log has, if these are more than the model's own."""
    f = null.best.hypothesis.frame
    place = next(iter(effect.places(f.model)), "historian")
    for signal, values in zip(f.signals, f.Y.T, strict=True):
        step = rounding(values)
        if signal in f.ops or sloping(values, step) < STRAIGHT:
            continue
        plain = without_gap(f.model, f.record, 1, seed + 1)
        if plain and sloping(values, step) >= sloping(plain[0][signal], step) + STRAIGHT:
            deviation = deviation_of(plain[0], effect, place, signal, step, values)
            return _as(null, Hypothesis(f, effect, place), {"deviation": deviation})
    return None


def _as(fit: Fit, one: Hypothesis, size: dict[str, float]) -> Fit:
    """Return a fit under the name of an effect that leaves the same."""
    values = {**{key: fit.best.values[key] for key in one.frame.free}, **size}
    return unfitted(replace(fit.best, hypothesis=one, values=values))

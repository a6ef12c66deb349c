"""What the digits of a measurement show: levels of a coarse sensor, straight lines of a compressing historian."""

from collections.abc import Mapping, Sequence

import numpy as np
from stickslip.blocks.role import Role
from stickslip.gap.fits.straightness import corners, deviation_of, sloping
from stickslip.gap.insertion.effect import Effect
from stickslip.gap.null_model.null_model import without_gap
from stickslip.gap.records.given import Held
from stickslip.gap.records.record import Digits, rounding
from stickslip.logs.arrays import Values

APART = 2.5  # roundings of the log by which levels lie apart where a sensor is coarse, or a compression shows
FEW = 0.1  # levels for each row, at most
TRIED = 3000  # steps near the usual distance of neighbours
UNEVEN = 0.05  # of a step, beyond the log's rounding
RUNS = 6  # of the model, which tell how many straight triples are usual
STRAIGHT = 0.05  # share of straight triples beyond what the model's own log has
CORNERS = 0.1  # of bends: measured 0 to 0.08 in rounded signals without noise (one 0.13), compressed ones from 0.13 on
ROUNDED = 0.4  # share from which on rounding draws the lines, and a historian is not told by them
NEITHER_COARSER = 0.5  # of the step that the levels show: a model whose sensor has such a step has none to find


def levels(values: Values) -> float:
    """Return the step between the few levels of a measurement, which the log may have rounded again; 0 for none.

    >>> levels(np.round(np.round(np.random.default_rng(0).normal(1.5, 0.1, 999) / 0.019) * 0.019 / 0.0015) * 0.0015)
    0.019
    """
    known = values[np.isfinite(values)]
    fine, found = rounding(known), np.unique(np.round(known, 9))
    if not 4 <= len(found) <= FEW * len(known):
        return 0.0
    step = float(np.median(np.diff(found)))
    if step < APART * max(fine, 1e-9):
        return 0.0
    tried = step * np.linspace(0.85, 1.15, TRIED)  # the one in whose multiples all levels agree best
    step = float(tried[np.argmax(np.abs(np.exp(2j * np.pi * found[:, None] / tried).mean(axis=0)))])
    step = float(np.polyfit(np.round(found / step), found, 1)[0])
    off = np.abs(found - np.round(found / step) * step)
    return float(f"{step:.4g}") if float(off.max()) <= 0.51 * fine + UNEVEN * step else 0.0


def measured_by(held: Held, place: str) -> tuple[str, Values]:
    """Return the logged signal of a sensor, and its values; none if it is not logged."""
    signal = next((str(s) for s in held.quiet[place].output_labels if str(s) in held.signals), "")
    return signal, held.Y[:, held.signals.index(signal)] if signal else np.zeros(0)


def unstated(held: Held, place: str, step: float) -> float:
    """Return a step that the levels of a sensor show; 0 where the model's sensor has such a step already."""
    return step if float(held.quiet[place].params.get("step", 0.0)) <= NEITHER_COARSER * step else 0.0


def coarse(held: Held, place: str) -> float:
    """Return the step of a sensor whose log is finer than its levels; 0 for none, or where the model has that step."""
    return unstated(held, place, levels(measured_by(held, place)[1]))


def straightened(held: Held, seed: int, others: Sequence[Mapping[str, float]] = ()) -> str:
    """Return the signal that a historian has compressed, empty if none is.

    A signal is compressed if more of its triples of rows lie on a line than in a run of the model, with the noise that
    it states and with ``others`` that are possible: the less there is of it, the more lines rounding draws.  They have
    to meet in corners, for a signal without noise is straight within its rounding wherever it moves slowly.
    """
    models = [held.model, *(held.model.with_params(held.given.settings(one)) for one in others)]
    # a valve takes what a controller gives, or a selector behind it: straight where the controller is calm
    to_valves = {str(s) for b in held.model.blocks if b.role is Role.VALVE for s in b.input_labels}
    for signal, values in zip(held.signals, held.Y.T, strict=True):
        digits = Digits.of(values)
        steps = digits.steps(values)
        own = sloping(values, steps)
        if signal in to_valves or signal in held.ops or own < STRAIGHT or corners(values, steps) < CORNERS:
            continue
        for model in models:
            plain = without_gap(model, held.record, RUNS, seed + 1)  # what is coarse has straight lines of its own
            usual = max((sloping(log[signal], digits.steps(log[signal])) for log in plain), default=1.0)
            if usual >= ROUNDED or own < usual + STRAIGHT:
                break
        else:
            return signal
    return ""


def deviation(
    held: Held, fitted: Mapping[str, float], effect: Effect, place: str, signal: str, seed: int
) -> float | None:
    """Return within what deviation [its unit] a signal was compressed, as runs with fitted noise and loads have it.

    None if such a run stops, or if it is so little that the log's own rounding draws such lines.
    """
    values = held.Y[:, held.signals.index(signal)]
    plain = without_gap(held.model.with_params(held.given.settings(fitted)), held.record, 1, seed + 1)
    found = deviation_of(plain[0], effect, place, signal, values) if plain else 0.0
    return found if found > APART * rounding(values) else None

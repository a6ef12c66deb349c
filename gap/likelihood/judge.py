"""Whether a hypothesis is right: its innovations beside those of runs of itself.

    T = the largest of all figures: innovations white, of unit size, indifferent to all that is known, and to a little
        of every effect of the catalogue
    p = 1 - exp(-exp(-(T - a) / b))          a, b of Gumbel's law, from runs of the hypothesis with its own noise

A noise or a load that stands at its bound is a figure too: by how much the record rejects a size half way there.

One question for the model alone ("is there a gap?") and for the effect that is named ("is it enough?").  Runs are asked
until they decide.
Source of the law of largest values, and of the least b: Gumbel, Statistics of Extremes (1958), sections 5.2 and 4.2; of
runs that end once they decide: Besag and Clifford, Biometrika 78 (1991).
"""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from stickslip.diagram.diagram import Diagram
from stickslip.gap.likelihood.bank import left_by_bank
from stickslip.gap.likelihood.candidates import Candidate
from stickslip.gap.likelihood.checks import checks
from stickslip.gap.likelihood.constancy import constancy
from stickslip.gap.likelihood.few_stems import known_stem
from stickslip.gap.likelihood.fit import Fit, tried
from stickslip.gap.likelihood.hypothesis import Hypothesis, Innovations
from stickslip.gap.likelihood.inputs import played
from stickslip.gap.likelihood.left import judged_by_loss, nearly_all
from stickslip.gap.likelihood.replay import Replays
from stickslip.gap.likelihood.scores import at_bound, basis, trusted
from stickslip.gap.likelihood.threads import in_threads
from stickslip.gap.likelihood.verdict import ALARM, Verdict
from stickslip.gap.null_model.null_model import without_gap
from stickslip.logs import Log
from stickslip.logs.arrays import Values

RUNS, RUNS_OF_BANK = 24, 12  # of a hypothesis, which say what is usual
BATCH = 6  # runs after which a figure is looked at
ORDINARY, BEYOND_DOUBT = 0.25, 3.0  # chance of a figure from which on, and times the limit, no further run is asked
CHANCES = 6  # runs without a gap, which say what an effect gains there
GUESSES = 4  # at what the log does not tell of inputs, among these runs
JUDGED_STEMS = 6  # of a bank there: the record and the runs are asked with as few
FARTHEST = 700.0  # of a deviate: the exponential of more overflows
QUARTILES = (0.25, 0.5, 0.75)
LITTLE = 0.02  # share of what the model alone leaves, that an effect may leave of it: no model is exact
SURE = 4.0  # standard deviations by which noise or a load may want to stand at its bound: 0.00006 of right ones do
MOST_LEFT = 25.0  # standard deviations that such an effect may leave at most


def judged(
    fit: Fit, others: Sequence[Candidate], seed: int = 0, null: Fit | None = None, model: Diagram | None = None
) -> Verdict:
    """Return how unusual the innovations of a fit are, beside ``others``, effects that it has not.

    ``null``: the model alone.  ``model``: whose runs say what is usual, where the fit only stands for
    it; its own unless given.
    """
    if isinstance(fit.hypothesis.frame, Replays):
        return judged_by_loss(fit, null, seed)
    away = [(f"what {c.hypothesis} would change", c.direction) for c in others if c.direction is not None]
    directions = [*_apart(fit, away), *constancy(fit)]
    one = fit.hypothesis
    mine = _left(fit, one) if one.hides else None  # as few stems as the runs have
    name, size = largest(fit if mine is None else replace(fit, best=mine), directions)
    least = 1.0 / math.sqrt(2.0 * math.log(2.0 * max(figures(fit, directions), 2)))  # of independent normal figures
    runs = RUNS_OF_BANK if one.hides else RUNS
    usual: list[float] = []
    found = Verdict(size, name, 1.0, math.inf)
    logs = _runs(fit, runs, seed + 1, model)
    if len(logs) < runs // 2:  # the others come to no end
        return found

    def figure_of(log: Log) -> float | None:
        left = _left_by_run(fit, log)
        return None if left is None else largest(replace(fit, best=left), directions)[1]

    for k in range(0, len(logs), BATCH):
        asked = logs[k : k + BATCH]
        usual += [figure for figure in in_threads(figure_of, asked) if figure is not None]
        if 2 * len(usual) >= k + len(asked):
            found = _beside(usual, size, name, least)
            if found.p > ORDINARY or (found.unusual and _beside(usual, size / BEYOND_DOUBT, name, least).unusual):
                break
    else:
        if len(usual) < runs // 2:  # the filter follows few of them
            return Verdict(size, name, 1.0, math.inf)
    if found.unusual or model is not None:
        return found
    at, beyond = _beyond(fit)
    return found if beyond <= SURE else Verdict(beyond, at, math.erfc(beyond / math.sqrt(2.0)), SURE)


def _beside(usual: Sequence[float], size: float, name: str, least: float) -> Verdict:
    """Return how unusual a figure is beside the ``usual`` ones of runs, whose spread is at ``least`` so large."""
    low, middle, high = np.quantile(usual, QUARTILES)  # of some runs a filter loses the track
    b = max(float(high - low) / (_gumbel(QUARTILES[2]) - _gumbel(QUARTILES[0])), least)
    a = float(middle) - _gumbel(QUARTILES[1]) * b
    return Verdict(size, name, chance((size - a) / b), a + b * _gumbel(1.0 - ALARM))


def _beyond(fit: Fit) -> tuple[str, float]:
    """Return which noise or load at its bound the record wants there most, and by how many standard deviations more
    than half way there: such a load stands for what the model has not.
    """
    names, found = at_bound(fit), ("", 0.0)
    if not names:
        return found
    now = known_stem(fit.best).filtered(fit.best.values) if fit.hypothesis.hides else fit.best
    for name in names:
        stated = now.hypothesis.frame.stated[name]
        half = now.hypothesis.noisier(now, {name: math.sqrt(stated * now.values[name])})
        gained = math.sqrt(2.0 * max(half.nll - now.nll, 0.0))
        found = max(found, (f"{name} at its bound", gained), key=lambda known: known[1])
    return found


def chance(deviate: float) -> float:
    """Return the chance that the largest of many standard figures exceeds a number.

    >>> round(chance(0.0), 3), chance(-1e5)
    (0.632, 1.0)
    """
    return -math.expm1(-math.exp(-min(max(deviate, -FARTHEST), FARTHEST)))


def _runs(fit: Fit, runs: int, seed: int, model: Diagram | None = None) -> list[Log]:
    """Return logs of runs of a fit, some with each guess at what the log does not tell of its inputs."""
    f = fit.hypothesis.frame
    model = model or fit.hypothesis.model(fit.best.values)
    if not f.doubts:
        return without_gap(model, f.record, runs, seed)
    guesses = played(f.record, f.doubts, *f.stops, range(seed, seed + GUESSES))
    each = [without_gap(model, f.record, runs // GUESSES, seed + k * runs, own) for k, own in enumerate(guesses)]
    return [log for logs in zip(*each, strict=False) for log in logs]


def gained_by_chance(fit: Fit, null: Fit, seed: int = 0) -> float:
    """Return what an effect gains, with its sizes, on runs of the model without a gap at most [nats].

    A filter that loses its way near a kink, as a selector has one, gains and loses hundreds there by chance.
    """
    best = 0.0
    for log in _runs(null, CHANCES, seed + 1):
        alone, ahead = _left_by_run(null, log), _left_by_run(fit, log)
        if alone is not None and ahead is not None:
            best = max(best, alone.nll - ahead.nll)
    return best


def _left_by_run(fit: Fit, log: Log) -> Innovations | None:
    """Return what another log of the same rows leaves with the values of a fit."""
    f = fit.hypothesis.frame
    return _left(fit, fit.hypothesis.of(replace(f, record=replace(f.record, log=log))))


def _left(fit: Fit, run: Hypothesis) -> Innovations | None:
    """Return what a record, or a run, leaves with the values of a fit: a bank where a stem is hidden."""
    values = fit.best.values
    if not run.hides:
        return tried(run, values, None if fit.best.kinks.any() else fit.best)  # kinks of a run are its own
    try:
        return left_by_bank(run, values, fit.best.near or fit.best, JUDGED_STEMS)
    except ArithmeticError:
        return None


def _gumbel(share: float) -> float:
    """Return what a share of the largest of many standard figures stays below."""
    return -math.log(-math.log(share))


def enough(fit: Fit, verdict: Verdict, alone: Verdict, null: Fit | None = None) -> bool:
    """Return whether a fit leaves nothing unusual, or next to nothing of what the model alone leaves.

    A fit whose own runs fail, where those of the model alone do not, wrote no such log.
    """
    if math.isinf(verdict.limit) and math.isfinite(alone.limit):
        return False
    if null is not None and isinstance(fit.hypothesis.frame, Replays):
        return not verdict.unusual or nearly_all(fit, null)
    return verdict.size <= max(verdict.limit, min(LITTLE * alone.size, MOST_LEFT))


def largest(fit: Fit, directions: Sequence[tuple[str, Values]]) -> tuple[str, float]:
    """Return the figure that innovations pass least, and its size."""
    found = _figures(fit, directions)
    name = max(found, key=lambda key: abs(found[key]), default="")
    return name, abs(found.get(name, 0.0))


def figures(fit: Fit, directions: Sequence[tuple[str, Values]]) -> int:
    """Return how many figures innovations have to pass."""
    return len(_figures(fit, directions))


def _figures(fit: Fit, directions: Sequence[tuple[str, Values]]) -> dict[str, float]:
    found = checks(fit.best)
    calm = np.nan_to_num(fit.best.e) * trusted(fit)
    return found | {name: float(np.sum(calm * d)) for name, d in directions}


def _apart(fit: Fit, away: Sequence[tuple[str, Values]]) -> list[tuple[str, Values]]:
    """Return directions less their projection on what the fit may change, of unit length."""
    own = basis(fit)
    found = []
    for name, d in away:
        left = d.copy()
        for slope in own:
            left = left - slope * float(np.sum(slope * left))
        length = float(np.sqrt(np.sum(left**2)))
        if length > 0.3:  # the rest is what the fit has already
            found.append((name, left / length))
    return found

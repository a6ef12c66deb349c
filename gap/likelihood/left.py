"""Whether a replay with an effect leaves no more than usual: its loss beside those of runs.

1. No more than records without a gap leave, or
2. no more than runs of the model with the effect leave, when they are explained by it, or
3. next to nothing of the gap: a law that differs a little from the true one leaves a little.
"""

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from stickslip.gap.likelihood.checks import checks
from stickslip.gap.likelihood.fit import Fit, tried
from stickslip.gap.likelihood.hypothesis import Innovations
from stickslip.gap.likelihood.replay import Replays
from stickslip.gap.likelihood.verdict import ALARM, Verdict
from stickslip.gap.null_model.null_model import losses, without_gap
from stickslip.logs.arrays import Values

SIGMAS = 4.5  # by which a loss may exceed its mean without a gap
SIGMAS_OF_FILTER = 3.5  # the same of a large diagram, whose mean and spread forty runs tell
GAINED = 12.0  # nats that what is left may lie above that
INEXACT = 0.005  # nats a row that another integrator may cost, where the null model is as sharp as rounding
NEARLY, NEARLY_HIDDEN = 0.94, 0.85  # share of a gap that an effect explains nearly
NEARLY_SQUARED = 0.9  # of the squares that a stem explains whatever its law, in a model without noise
LEAST = 0.7  # share of a gap that an effect explains whose own runs leave as much
LARGER, WHITE = 1.02, 5.0  # factor of the stated noise that matters; largest figure of white noise
SMALLEST = 1e-9  # [nats]
STANDING = 0.003  # share of the rows that stand at a limit, at least
OWN_RUNS = 4  # runs of the model with the effect


def judged_by_loss(fit: Fit, null: Fit | None = None, seed: int = 0) -> Verdict:
    """Return how unusual the loss of a replay is [standard deviations of that of runs without a gap].

    ``null``: the model alone, if the fit is of an effect.
    """
    f = fit.hypothesis.frame
    assert isinstance(f, Replays)
    unit = f.null_model.sd * math.sqrt(known(fit.best))
    far = SIGMAS if f.record.filter is None else SIGMAS_OF_FILTER
    beyond = left(fit.best) - level(fit.best)
    limit = far * unit
    explained = fit.hypothesis.effect is not None
    if explained or not f.noise:  # runs without noise differ by what another integrator costs
        limit += allowed(f)
    # runs with a hidden mode that is missed now and then leave anything: that alone proves nothing
    if explained and beyond > limit and null is not None and share(fit, null) >= LEAST:
        limit = max(limit, _own_runs(fit, far, seed))
    unit = max(unit, SMALLEST)  # of runs without noise all losses are the same
    return Verdict(beyond / unit, "the misfit of all rows", ALARM if beyond > limit else 1.0, limit / unit)


def nearly_all(fit: Fit, null: Fit) -> bool:
    """Return whether an effect explains so much of a gap that only its law can be a little different."""
    if share(fit, null) >= (NEARLY_HIDDEN if fit.hypothesis.sticks else NEARLY):
        return True
    if fit.hypothesis.sticks and not fit.hypothesis.frame.noise:
        # without noise a row at which two laws of friction differ a little costs as one at which all is wrong
        before, after = (float(np.nansum(one.best.e**2)) for one in (null, fit))
        return after <= (1.0 - NEARLY_SQUARED) * before
    return fit.hypothesis.bends and _only_at_limit(fit)


def _only_at_limit(fit: Fit) -> bool:
    """Return whether a limit leaves nothing unusual but at rows that stand there: when exactly an integral stops is a
    matter of the controller's own step.
    """
    f, away = fit.hypothesis.frame, ~_standing(fit)
    assert isinstance(f, Replays)
    rows = away[f.skipped :]
    if rows.all():
        return False
    n = float(rows.sum())
    usual = f.null_model.mean * n + SIGMAS * f.null_model.sd * math.sqrt(n)
    return float(losses(fit.best.e[f.skipped :][rows]).sum()) <= usual + allowed(f)


def _standing(fit: Fit) -> NDArray[np.bool_]:
    """Return the rows at and next to which a logged signal stands at a fitted limit, (rows,)."""
    one, log = fit.hypothesis, fit.hypothesis.frame.record.log
    shown, _, zero, to_unit = one.reached
    found = np.zeros(len(log), dtype=bool)
    for name in one.own if shown else ():
        value = fit.best.values[name]
        if value != one.nominal[name] and math.isfinite(value):
            near = max(1.5 * one.frame.record.lattice(shown), 1e-5 / to_unit)
            rows = np.abs(log[shown] - (zero + value / to_unit)) <= near
            found |= rows if float(rows.mean()) > STANDING else False
    found[1:-1] |= found[:-2] | found[2:]
    return found


def share(fit: Fit, null: Fit) -> float:
    """Return the share of the gap that an effect explains."""
    removable = left(null.best) - level(null.best)
    return (left(null.best) - left(fit.best)) / removable if removable > 1e-9 else 1.0


def left(found: Innovations) -> float:
    """Return the loss of what is left, with what modes set right cost [nats].

    It is in the unit of the stated noise, as the losses of runs are; in that of noise that was fitted larger only where
    what is left is white, as more noise is.
    """
    return float(losses(found.e * _unproven(found)).sum()) + found.charge


def _unproven(found: Innovations) -> Values:
    """Return the noise of each signal as it was fitted over what is stated; 1 where it is proven to be larger."""
    f = found.hypothesis.frame
    assert isinstance(f, Replays)
    factor = np.ones(len(f.signals))
    stated = np.diag(f.null_model.L)[[f.record.pinned.index(s) for s in f.signals]]
    for j, s in enumerate(f.signals):
        by = math.sqrt(float(np.nanmax(found.S[:, j], initial=0.0))) / stated[j]
        if by <= LARGER or max(abs(x) for name, x in checks(found).items() if s in name.split()) > WHITE:
            factor[j] = by
    return factor


def known(found: Innovations) -> float:
    """Return how many rows are judged, a row with missing signals by the share that is there."""
    return float(np.isfinite(found.e).mean()) * len(found.e)


def level(found: Innovations) -> float:
    """Return the mean loss of so many rows without a gap [nats]."""
    f = found.hypothesis.frame
    assert isinstance(f, Replays)
    return f.null_model.mean * known(found)


def allowed(frame: Replays) -> float:
    """Return the gain in log likelihood from which on an effect is worth reporting [nats]."""
    return GAINED + (0.0 if frame.null_model.coloured else INEXACT * (len(frame.Y) - frame.skipped))


def _own_runs(fit: Fit, far: float, seed: int) -> float:
    """Return by how much runs with the effect exceed the mean loss without a gap at most [nats]; 0 if they fail."""
    one, f, found = fit.hypothesis, fit.hypothesis.frame, []
    assert isinstance(f, Replays)
    for log in without_gap(one.model(fit.best.values), f.record, OWN_RUNS, seed + 1):
        run = tried(one.of(replace(f, record=replace(f.record, log=log))), fit.best.values)
        if run is not None:
            found.append(left(run) - level(run))
    if len(found) < 2:
        return 0.0
    spread = max(float(np.std(found, ddof=1)), f.null_model.sd * math.sqrt(known(fit.best)))
    return float(np.mean(found)) + far * spread + allowed(f)

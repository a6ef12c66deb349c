"""Steps in a long log of routine operation: moves of OP that stand alone, as a set-point change or an operator makes.

move     OP goes by ``LEAST_PERCENT`` or more within ``WITHIN_SAMPLES``
alone    before and after, OP stays within ``STEADY_SHARE`` of the move for ``QUIET_SAMPLES`` or more.  The answer is
         read until OP leaves ``HELD_SHARE`` of the move, or that band where it does so at once; it is read for
         ``LONGEST_SAMPLES`` at most
"""

import numpy as np
from stickslip.detect.valve_test.steps import Step
from stickslip.logs.arrays import Values

LEAST_PERCENT = 2.0  # % of OP span: as for the timed steps of a test
WITHIN_SAMPLES = 2  # samples
STEADY_SHARE = 0.03  # of the move
HELD_SHARE = 0.005  # of the move
QUIET_SAMPLES = 8  # samples
LONGEST_SAMPLES = 2000  # samples
SIGMAS = 4.0  # of the noise: a smaller answer is none
SETTLED_SHARE = 0.1  # of the answer: what still moves in the last quarter of the hold has not settled


def routine_steps(t: Values, op: Values, answer: Values, noise: float) -> tuple[Step, ...]:
    """The isolated moves of a record whose answer settled.

    ``t`` (n,) [s], ``op`` (n,) [% of span], ``answer`` (n,): stem or PV, ``noise`` its standard deviation.

    >>> t = np.arange(300.0)
    >>> op = 40.0 + np.where(t < 100, 0.0, 5.0) + np.where(t < 200, 0.0, 0.01 * (t - 200))
    >>> [step] = routine_steps(t, op, 2.0 * op, 0.0)
    >>> step.time, step.size, step.moved
    (100.0, 5.0, True)
    """
    moves = op[WITHIN_SAMPLES:] - op[:-WITHIN_SAMPLES]
    found: list[Step] = []
    at = 0
    for i in np.flatnonzero(np.abs(moves) >= LEAST_PERCENT).tolist():
        if i < at:
            continue
        first = (
            i + 1 if abs(op[i + 1] - op[i]) > 0.5 * abs(moves[i]) else i + WITHIN_SAMPLES
        )  # the sample with the new value
        step = _step(t, op, answer, first, i + WITHIN_SAMPLES, noise)
        if step is not None:
            found.append(step)
            at = step.start + QUIET_SAMPLES
    return tuple(found)


def _step(t: Values, op: Values, answer: Values, first: int, settled: int, noise: float) -> Step | None:
    before, after = op[max(0, first - QUIET_SAMPLES) : first], op[settled : settled + QUIET_SAMPLES]
    if len(before) < QUIET_SAMPLES or len(after) < QUIET_SAMPLES:
        return None
    size = float(np.median(after) - np.median(before))
    if abs(size) < LEAST_PERCENT or max(np.ptp(before), np.ptp(after)) > STEADY_SHARE * abs(size):
        return None
    away = np.abs(op[settled : settled + LONGEST_SAMPLES] - np.median(after)) / abs(size)
    ends = [int(np.argmax(away > band)) if np.any(away > band) else len(away) for band in (HELD_SHARE, STEADY_SHARE)]
    stop = settled + (ends[0] if ends[0] >= 5 * QUIET_SAMPLES else ends[1])
    hold = answer[first:stop]
    tail = hold[-max(QUIET_SAMPLES // 2, len(hold) // 4) :]
    places = float(np.mean(answer[first - QUIET_SAMPLES : first])), float(np.mean(tail))
    change = places[1] - places[0]
    drift = float(np.mean(tail[len(tail) // 2 :]) - np.mean(tail[: len(tail) // 2]))
    if abs(change) <= SIGMAS * noise or abs(drift) > SETTLED_SHARE * abs(change) + 2.0 * noise:
        return None
    level = float(np.median(before))
    return Step(float(t[first]), level, level + size, first, stop, places[0], places[1], moved=True)

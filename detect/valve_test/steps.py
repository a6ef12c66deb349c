"""Steps of OP and what the valve made of each: where it stood before and after, and whether it moved.

hold     OP stays within its resolution for at least ``HOLD_SAMPLES`` samples
step     from one hold to the next
place    mean of the answer over the last half of a hold
moved    the place changed by more than ``SIGMAS`` standard errors, half its resolution and ``ANSWER_SHARE`` of the step
"""

import itertools
import math
from dataclasses import dataclass

import numpy as np
from stickslip.detect.signals.smoothing import noise_std
from stickslip.logs.arrays import Values

HOLD_SAMPLES = 5
SIGMAS = 4.0  # of the difference of two means
ANSWER_SHARE = 0.05  # of the step of OP times the gain; a smaller answer is drift or leakage of noise


@dataclass(frozen=True)
class Step:
    """One step of OP.

    time : when OP stepped [s]
    before, after : OP before and after [% of span]
    start, stop : samples of the hold after the step, ``stop`` not included
    place_before, place_after : answer before and after [unit of the answer]
    """

    time: float
    before: float
    after: float
    start: int
    stop: int
    place_before: float
    place_after: float
    moved: bool

    @property
    def size(self) -> float:
        """Step of OP [% of span]."""
        return self.after - self.before

    @property
    def answer(self) -> float:
        """Change of the answer [its unit]."""
        return self.place_after - self.place_before


def noise_of(t: Values, answer: Values) -> float:
    """Standard deviation of the answer's noise [its unit]."""
    return float(noise_std(t, answer))


def steps_of(t: Values, op: Values, answer: Values) -> tuple[Step, ...]:
    """The steps of a record.

    ``t`` (n,) [s], ``op`` (n,) [% of span], ``answer`` (n,): stem position or PV.

    >>> t = np.arange(40.0)
    >>> op = np.repeat([50.0, 51.0], 20)
    >>> [step] = steps_of(t, op, 2.0 * op)
    >>> step.time, step.size, step.answer, step.moved
    (20.0, 1.0, 2.0, True)
    """
    resolution = _resolution(op)
    holds = _holds(op, 0.5 * resolution if resolution else 1e-9)
    if len(holds) < 2:
        return ()
    noise, grain = noise_of(t, answer), _resolution(answer)
    gain = _gain(op, answer, holds)
    found = []
    for (first, last), (start, stop) in itertools.pairwise(holds):
        settled = slice((first + last) // 2, last), slice((start + stop) // 2, stop)
        places = [float(np.mean(answer[part])) for part in settled]
        counts = [part.stop - part.start for part in settled]
        error = noise * math.sqrt(sum(1.0 / max(count, 1) for count in counts))
        before, after = float(np.median(op[first:last])), float(np.median(op[start:stop]))
        least = max(SIGMAS * error, 0.5 * grain, ANSWER_SHARE * gain * abs(after - before))
        moved = abs(places[1] - places[0]) > least
        found.append(Step(float(t[start]), before, after, start, stop, places[0], places[1], moved))
    return tuple(found)


def _resolution(values: Values) -> float:
    """The grid that all values lie on, 0 where there is none."""
    distinct = np.unique(values)
    if len(distinct) < 2 or len(distinct) > 0.5 * len(values):
        return 0.0
    return float(np.min(np.diff(distinct)))


def _holds(op: Values, tolerance: float) -> list[tuple[int, int]]:
    """Stretches [first, stop) in which OP stands still."""
    moves = np.flatnonzero(np.abs(np.diff(op)) > tolerance) + 1
    edges = np.concatenate([[0], moves, [len(op)]]).tolist()
    return [(first, stop) for first, stop in itertools.pairwise(edges) if stop - first >= HOLD_SAMPLES]


def _gain(op: Values, answer: Values, holds: list[tuple[int, int]]) -> float:
    """Size of the answer per % of OP: spread over spread of the places."""
    places = np.array([[np.median(op[a:b]), np.mean(answer[(a + b) // 2 : b])] for a, b in holds])
    spread = np.ptp(places, axis=0)
    return float(spread[1] / spread[0]) if spread[0] > 0 else 0.0

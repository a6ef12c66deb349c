"""Whether an effect matters: how far it moves the signals of runs that have the same noise and loads.

share = rms(run with the effect - run without) / standard deviation of the run without        the largest signal's

of the stretch in which it moves most: a limit that is met at few switches matters there.
"""

from collections.abc import Mapping

import numpy as np
from stickslip.gap.likelihood.frame import Frame
from stickslip.gap.likelihood.hypothesis import Hypothesis
from stickslip.gap.null_model.null_model import unrounded

RUNS = 3
STRETCHES = 20  # of a record
ALL = 1.0  # of its movement
RELEVANT = 0.01  # of a signal's movement: no plant computes like its model, and what is less is no gap
RELEVANT_SHARP = 0.005  # the same of a loop without loads, in which less shows


def least(frame: Frame) -> float:
    """Return the share of a signal's movement below which an effect does not matter."""
    return RELEVANT_SHARP if frame.replays else RELEVANT


def moved(one: Hypothesis, values: Mapping[str, float], seed: int = 0) -> float:
    """Return the share of its movement by which an effect moves the signal that it moves most.

    An effect with which a run fails, a level that leaves its tank, moves all.
    """
    frame = one.frame
    free = {key: values[key] for key in frame.free}
    neutral = type(one)(frame).model(free)
    without = unrounded(neutral, frame.record, RUNS, seed + 1)
    found = unrounded(one.model(values), frame.record, RUNS, seed + 1)
    shares = [0.0]
    if any(len(found[s]) < len(plain) or not len(plain) for s, plain in without.items()):
        return ALL
    for s, plain in without.items():
        natural = float(np.mean(np.var(plain, axis=1)))
        if natural > 0.0:
            apart = np.mean((found[s] - plain) ** 2, axis=0)
            shares.append(max(float(np.sqrt(np.mean(part) / natural)) for part in np.array_split(apart, STRETCHES)))
    return max(shares)

"""With what the largest residual goes: the level, rate or direction of a logged signal, or time."""

import numpy as np
from numpy.typing import NDArray
from stickslip.gap.fits.noise import correlation
from stickslip.gap.floors.problem import Problem

Floats = NDArray[np.float64]


def shape(problem: Problem) -> list[str]:
    """Return in words with what the largest residual goes: level, rate, direction, time."""
    e = np.nan_to_num(np.clip(problem.as_it_is, -20.0, 20.0))
    k = int(np.argmax(np.abs(e).mean(axis=0)))
    log, skipped = problem.record.log, problem.floor.skipped
    against: dict[str, Floats] = {"time": log.t[skipped:]}
    for s in log.names:
        values = np.nan_to_num(log[s])
        against[f"the level of {s}"] = values[skipped:]
        against[f"the rate of {s}"] = np.gradient(values)[skipped:]
        against[f"the direction of {s}"] = np.sign(np.gradient(values))[skipped:]
    signal = problem.record.pinned[k]
    words = []
    for what, size in (("residual", e[:, k]), ("size of the residual", np.abs(e[:, k]))):
        found = {name: correlation(size, values) for name, values in against.items()}
        best = max(found, key=lambda name: abs(found[name]))
        if abs(found[best]) >= 0.1:
            words.append(f"The {what} of {signal} goes with {best} (correlation {found[best]:.2f}).")
    return words or [f"The residual of {signal} goes with no logged level, rate or direction."]

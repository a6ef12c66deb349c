"""The shape of the half waves of OP, of e and of the slope of PV, on a phase of their own.

Half waves run from crossing to crossing of the signal less its moving average over four turns, smoothed over three
points.  Each is read at 16 phases and divided by its mean, so that height and length are gone.

    misfit of a shape      sum (y - a s)^2 / sum y^2 with the best height a: sine, triangle, square, exponential
    lateness               log(area after the middle / area before it), over the mean half wave
    area ratio             area before the peak over area after it, of the mean half wave

A sticky valve makes OP a triangle and PV a row of exponentials where the process settles, and PV a triangle where it
integrates; a wave from outside or of tight tuning is a sine in all of them.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt
from stickslip.detect.judge.features.view import View

__all__ = ["crossings_of", "half_waves", "shape_features"]

Values = npt.NDArray[np.float64]
PHASES = (np.arange(16) + 0.5) / 16
LEAST = 4  # half waves without which there is no shape


def _templates() -> dict[str, Values]:
    shapes = {"sine": np.sin(np.pi * PHASES), "triangle": 1 - np.abs(2 * PHASES - 1), "square": np.ones(16)}
    for name, h in (("bend", 1.0), ("exponential", 3.0)):  # half period over time constant
        a = math.tanh(0.5 * h)
        crossed = math.log1p(a) / h  # after the slip PV runs from -a towards 1 and crosses zero here
        wave = 1 - (1 + a) * np.exp(-h * (np.mod(PHASES + crossed, 1.0)))
        shapes[name] = np.where(PHASES + crossed > 1.0, -wave, wave)
    return {name: s / np.linalg.norm(s) for name, s in shapes.items()}


TEMPLATES = _templates()


def shape_features(v: View) -> dict[str, float]:
    """The features of this family by name [-]; NaN for a signal with fewer than four half waves."""
    slope = np.convolve(v.y, _kernel(v.turn), mode="same")
    found: dict[str, float] = {}
    for name, x in (("op", v.u), ("e", v.e), ("slope", slope)):
        found |= {f"{name}_{key}": value for key, value in _shape(x, v.turn).items()}
    return found


def _kernel(turn: float) -> Values:
    """Difference of the means over an eighth of a turn before and after a point."""
    k = max(round(turn / 8.0), 1)
    return np.concatenate([np.ones(k), [0.0], -np.ones(k)]) / k


def crossings_of(x: Values, turn: float) -> tuple[Values, Values]:
    """Where x less its moving average over four turns crosses zero [points], rising first, and what is left of it."""
    width = min(2 * round(2.0 * turn) + 1, len(x))
    pad = width // 2
    held = np.concatenate([np.full(pad, x[: pad + 1].mean()), x, np.full(pad, x[len(x) - pad - 1 :].mean())])
    sums = np.concatenate([[0.0], np.cumsum(held)])
    z = x - (sums[width:] - sums[:-width])[: len(x)] / width
    z[1:-1] = 0.25 * z[:-2] + 0.5 * z[1:-1] + 0.25 * z[2:]
    sure = np.flatnonzero(np.abs(z) > 0.25 * float(np.std(z)))
    way = np.sign(z[sure])
    change = np.flatnonzero(way[1:] != way[:-1])
    if not len(change):
        return np.empty(0), z
    if way[change[0]] > 0.0:
        change = change[1:]
    # the crossing is the last change of sign between the two sure points
    sign = np.sign(z)
    flips = np.flatnonzero(sign[1:] != sign[:-1])
    last = flips[np.searchsorted(flips, sure[change + 1]) - 1]
    return last + z[last] / (z[last] - z[last + 1]), z


def half_waves(x: Values, turn: float) -> tuple[Values, Values, Values]:
    """Half waves at the 16 phases (h, 16), made positive with mean 1, their lengths [points] and areas, (h,).

    >>> t = np.arange(400.0)
    >>> wave, length, area = half_waves(np.sin(t / 8), 25.0)
    >>> wave.shape[1], round(float(np.median(length))), round(float(wave.mean()), 6)
    (16, 25, 1.0)
    """
    at, z = crossings_of(x, turn)
    length = np.diff(at)
    keep = length >= 3.0
    first, length = at[:-1][keep], length[keep]
    if not len(first):
        return np.empty((0, 16)), np.empty(0), np.empty(0)
    wave = np.interp(first[:, None] + length[:, None] * PHASES, np.arange(len(z)), z)
    mean = wave.mean(axis=1, keepdims=True)
    good = np.abs(mean[:, 0]) > 1e-9
    return wave[good] / mean[good], length[good], (mean[:, 0] * length)[good]


def _shape(x: Values, turn: float) -> dict[str, float]:
    wave, length, area = half_waves(x, turn)
    names = [*TEMPLATES, "lateness", "lateness_gap", "area_ratio", "top", "rough", "halves", "length_scatter",
             "area_scatter", "gain_sine", "length", *[f"mean_{name}" for name in TEMPLATES]]  # fmt: skip
    if len(wave) < LEAST:
        return dict.fromkeys(names, math.nan) | {"halves": float(len(wave))}
    weight = np.abs(area) / np.sum(np.abs(area))
    power = np.sum(wave**2, axis=1)
    misfit = {name: float(weight @ (1 - (wave @ s) ** 2 / power)) for name, s in TEMPLATES.items()}
    mean = weight @ wave
    late = np.log(np.maximum(wave[:, 8:].sum(axis=1), 0.5) / np.maximum(wave[:, :8].sum(axis=1), 0.5))
    up, down = area > 0, area < 0
    sides = [float(np.average(late[k], weights=weight[k])) if k.any() else math.nan for k in (up, down)]
    peak = int(np.argmax(mean))
    before, after = mean[:peak].sum() + 0.5 * mean[peak], mean[peak + 1 :].sum() + 0.5 * mean[peak]
    own = mean / np.linalg.norm(mean)
    return (
        misfit
        | {f"mean_{name}": float(1 - (own @ s) ** 2) for name, s in TEMPLATES.items()}
        | {
            "lateness": float(weight @ late),
            "lateness_gap": abs(sides[0] - sides[1]),
            "area_ratio": float(np.log(max(before, 0.05) / max(after, 0.05))),
            "top": float(mean.max()),
            "rough": float(weight @ (1 - (wave @ own) ** 2 / power)),
            "halves": float(len(wave)),
            "length_scatter": float(np.std(length) / np.mean(length)),
            "area_scatter": float(np.std(np.abs(area)) / np.mean(np.abs(area))),
            "gain_sine": math.log((misfit["sine"] + 0.003) / (misfit["triangle"] + 0.003)),
            "length": float(np.median(length) / turn),
        }
    )

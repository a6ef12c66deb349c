"""Regularity, harmonics and time shifts: what the correlations and the spectrum of OP, PV and e say.

    acf(k)     autocorrelation of e and OP; its first peak beyond its first zero crossing, and the decay of the next
    harmonics  amplitudes of 2 f and 3 f over that of f, and the phases arg a3 - 3 arg a1 as a cosine
               (+1 triangle, -1 square)
    ccf(k)     correlation of OP and PV over shifts: where it is largest, zero and least, in turns

Time is counted in turns of OP.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt
from stickslip.detect.judge.features.view import View

__all__ = ["wave_features"]

Values = npt.NDArray[np.float64]


def wave_features(v: View) -> dict[str, float]:
    """The features of this family by name [-]."""
    n = len(v)
    size = 1 << (2 * n - 1).bit_length()
    level = _high_passed(np.stack([v.u, v.e, v.y]), v.turn)
    spectra = np.fft.rfft(level, size, axis=1)
    power = np.abs(spectra) ** 2
    found: dict[str, float] = {}
    for k, name in enumerate(("op", "e")):
        acf = np.fft.irfft(power[k], size)[: n // 2]
        found |= {f"{name}_{key}": value for key, value in _regularity(acf / (acf[0] + 1e-300), v.turn).items()}
    found |= _spectral(level, v.turn)
    cross = np.fft.irfft(spectra[2] * np.conj(spectra[0]), size)
    found |= _shift(cross, power, size, n, v.turn)
    return found


def _high_passed(x: Values, turn: float) -> Values:
    """Signals (k, n) less their moving average over eight turns."""
    n = x.shape[1]
    width = min(round(8 * turn), n)
    sums = np.concatenate([np.zeros((len(x), 1)), np.cumsum(x, axis=1)], axis=1)
    middle = np.clip(np.arange(n), width // 2, n - (width - width // 2))
    slow = (sums[:, middle + width - width // 2] - sums[:, middle - width // 2]) / width
    return np.asarray(x - slow)


def _regularity(acf: Values, turn: float) -> dict[str, float]:
    names = ("acf_peak", "acf_peak2", "acf_trough", "acf_period", "acf_scatter")
    below = np.flatnonzero(acf < 0.0)
    if not len(below):
        return dict.fromkeys(names, math.nan)
    zero = int(below[0])
    trough = zero + int(np.argmin(acf[zero : max(3 * zero, zero + 2)]))
    after = acf[trough : min(3 * trough, len(acf))]
    peak = trough + int(np.argmax(after)) if len(after) else trough
    second = acf[int(1.6 * peak) : int(2.4 * peak) + 1]
    signs = np.flatnonzero(np.sign(acf[1:]) != np.sign(acf[:-1]))[:11]
    gaps = np.diff(signs)
    return {
        "acf_peak": float(acf[peak]),
        "acf_peak2": float(second.max()) if len(second) else math.nan,
        "acf_trough": float(acf[trough]),
        "acf_period": peak / turn,
        "acf_scatter": float(np.std(gaps) / np.mean(gaps)) if len(gaps) > 2 else math.nan,
    }


def _spectral(x: Values, turn: float) -> dict[str, float]:
    """Harmonics of OP, e and PV at the strongest frequency of OP and e together, and how far the power is spread."""
    n = x.shape[1]
    line = np.fft.rfft(x * np.hanning(n), axis=1)
    power = np.abs(line) ** 2
    whole = power[:2].sum(axis=1, keepdims=True) + 1e-300
    joint = (power[:2] / whole).sum(axis=0)
    joint[:2] = 0.0
    f = int(np.argmax(joint))
    found = {"frequency": f * turn / n}
    top = len(joint)
    for k, name in enumerate(("op", "e")):
        bands = [power[k][max(round(h * f) - 3, 0) : min(round(h * f) + 4, top)] for h in (1, 2, 3)]
        total = float(whole[k, 0])
        share = [float(b.sum()) / total for b in bands]
        found |= {f"{name}_line": share[0]}
        for h in (2, 3):
            found[f"{name}_h{h}"] = math.log10(share[h - 1] / (share[0] + 1e-12) + 1e-6)
        third = 3 * f
        if third < top:
            near = third - 2 + int(np.argmax(power[k][third - 2 : third + 3]))
            shift = (near - third) * math.pi * (n - 1) / n  # both phases are those in the middle of the record
            phase = float(np.angle(line[k, near]) - 3 * np.angle(line[k, f])) + shift
            found[f"{name}_c3"] = math.cos(phase)
        else:
            found[f"{name}_c3"] = math.nan
        p = power[k] / total
        found[f"{name}_entropy"] = float(-np.sum(p * np.log(p + 1e-300)) / math.log(max(n / turn, 2.0)))
    return found


def _shift(cross: Values, power: Values, size: int, n: int, turn: float) -> dict[str, float]:
    scale = math.sqrt(float(np.fft.irfft(power[0], size)[0] * np.fft.irfft(power[2], size)[0])) + 1e-300
    reach = min(round(2.5 * turn), n - 1)
    ccf = np.concatenate([cross[-reach:], cross[: reach + 1]]) / scale
    middle = reach
    right, left = ccf[middle:], ccf[middle::-1]
    best = int(np.argmax(right))
    other = [np.flatnonzero(np.sign(side) != np.sign(ccf[middle])) for side in (right, left)]
    zero = [int(at[0]) if len(at) else reach for at in other]
    inside = ccf[middle - zero[1] : middle + zero[0] + 1]
    strongest = inside[int(np.argmax(np.abs(inside)))] if len(inside) else 0.0
    return {
        "ccf_0": float(ccf[middle]),
        "ccf_best": float(right[best]),
        "ccf_lag": best / turn,
        "ccf_least": float(np.min(right)),
        "ccf_least_lag": int(np.argmin(right)) / turn,
        "ccf_before": float(np.max(left)),
        "ccf_before_lag": int(np.argmax(left)) / turn,
        "ccf_odd": abs(zero[0] - zero[1]) / max(zero[0] + zero[1], 1),
        "ccf_rise": float(abs(ccf[middle] - strongest) / (abs(ccf[middle] + strongest) + 1e-9)),
    }

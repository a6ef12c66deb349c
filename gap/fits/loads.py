"""Fit a load that follows a plan (step, sine, slug): by its response in the innovations, all times and periods at once.

    e = A (h * s_q) + w        h response of the innovations to a load of 1 in one interval, s_q the plan of shape q

For each q the best A removes <e, h * s_q>^2 / (2 |h * s_q|^2) nats; correlations with all times and periods come from a
few Fourier transforms.  The best few are then asked of the likelihood.
"""

import math

import numpy as np
from stickslip.diagram.diagram import Diagram
from stickslip.gap.insertion.effect import Effect
from stickslip.gap.null_model.null_model import NU
from stickslip.logs.arrays import Values

LONGEST = 1.0 / 3.0  # period, as a share of the record: a longer one imitates a drift
SHORTEST = 4.0  # period, in rows
TRIED = 4  # shapes that are replayed
FEW, WIDER = 0.99, 3.0  # quantile of the innovations that is looked at too, if it is so many times the usual size
HARMONICS = 8
PHASES = 32  # begins of a period that are looked at
FINER = 4  # frequencies for each one that the record resolves


def is_load(effect: Effect) -> bool:
    """Return whether an effect is a size times a plan of a time or a period."""
    return [p.name for p in effect.parameters][:2] in (["amplitude", "time"], ["amplitude", "period"])


def planned(
    effect: Effect | None,
    base: Diagram,
    place: str,
    t: Values,
    e: Values,
    h: Values,
) -> list[dict[str, float]]:
    """Return the sizes of a planned load that suit innovations ``e`` (rows, signals) at the times ``t`` [s] best.

    ``h`` (rows, signals): what a load of 1 in the first interval of the model changes in its innovations.
    """
    if effect is None:
        return []
    if "time" in [p.name for p in effect.parameters]:
        return _steps(t, e, h)
    return _periods(t, e, h, _harmonics(effect, base, place))


def trimmed(e: Values) -> list[Values]:
    """Return innovations with the weight that Student's loss gives them, unknown ones 0.

    At the scale of most rows; and, where a few rows are far beyond it, at theirs too: a step near the end of a record
    is in few rows, which the first scale takes for outliers.
    """
    size = np.abs(e[np.isfinite(e)])
    if len(size) == 0:
        return []
    usual, large = max(1.0, 2.0 * float(np.median(size))), 2.0 * float(np.quantile(size, FEW))
    scales = [usual, large] if large > WIDER * usual else [usual]
    with np.errstate(over="ignore", invalid="ignore"):  # beyond all squares the weight is 0, and so is the innovation
        return [np.nan_to_num(e / (1.0 + (e / scale) ** 2 / NU)) for scale in scales]


def _steps(t: Values, e: Values, h: Values) -> list[dict[str, float]]:
    """Return amplitude and time of the best steps, and of one before the first row."""
    n = len(e)
    H = np.zeros((n, h.shape[1]))
    H[: len(h)] = np.cumsum(h, axis=0)[:n]
    H[len(h) :] = H[len(h) - 1]
    size = 2 * n
    product = np.fft.rfft(e, size, axis=0) * np.conj(np.fft.rfft(H, size, axis=0))
    hit = -np.fft.irfft(product.sum(axis=1), size)[:n]
    power = np.cumsum((H**2).sum(axis=1))[::-1]  # of a step at row k: what of H lies inside the record
    least_power = 0.001 * power[0]  # a step that hardly shows inside the record is none
    gain = hit**2 / np.maximum(power, max(least_power, 1e-300))
    gain[power < least_power] = 0.0
    found = [{"amplitude": hit[k] / power[k], "time": float(t[k])} for k in _peaks(gain, n // 50 + 1)]
    return [*found, {"amplitude": hit[0] / power[0], "time": 0.0}]


def _periods(t: Values, e: Values, h: Values, harmonics: list[complex]) -> list[dict[str, float]]:
    """Return amplitude, period and phase of the best periodic loads with these harmonics, no shorter than ``SHORTEST``
    rows.
    """
    n, dt = len(e), float(np.median(np.diff(t)))
    size = FINER * (1 << (n - 1).bit_length())
    E, H = np.fft.rfft(e, size, axis=0), np.fft.rfft(h[: n // 2], size, axis=0)
    hit, power = -(np.conj(H) * E).sum(axis=1), (np.abs(H) ** 2).sum(axis=1)
    longest, shortest = LONGEST * n * dt, SHORTEST * dt
    k = np.arange(max(1, math.ceil(size * dt / longest)), min(int(size * dt / shortest), len(hit) - 1))
    turns = np.arange(PHASES) / PHASES
    total, norm = np.zeros((len(k), PHASES)), np.full(len(k), 1e-300)
    for j, b in enumerate(harmonics, start=1):
        inside = j * k < len(hit)
        at = np.where(inside, j * k, 0)
        seen = np.where(inside, hit[at], 0.0)
        total += np.real(2.0 * np.conj(b) * seen[:, None] * np.exp(-2j * math.pi * j * turns[None]))
        norm += np.where(inside, 2.0 * n * np.abs(b) ** 2 * power[at], 0.0)
    best = np.argmax(total, axis=1)
    rows = np.arange(len(k))
    gain = np.maximum(total[rows, best], 0.0) ** 2 / norm
    found: list[dict[str, float]] = []
    for i in _peaks(gain, 2 * FINER):
        period = size * dt / k[i]
        # Rows count from where scoring begins; a sample that is held stands half an interval later.
        phase = (turns[best[i]] - (float(t[0]) + 0.5 * dt) / period) % 1.0
        found.append({"amplitude": total[i, best[i]] / norm[i], "period": period, "phase": phase})
    return found


def _harmonics(effect: Effect, base: Diagram, place: str) -> list[complex]:
    """Return the Fourier coefficients of one period of the plan of amplitude 1, phase 0."""
    values = {"amplitude": 1.0, "period": 1.0, "phase": 0.0}
    changed = effect.put(base, place).with_params(effect.settings(base, place, **values))
    wave = changed[f"{effect.block(place)}/wave"]
    phase = (np.arange(256) + 0.5) / 256
    shape = np.array([float(wave.output(t, [], [])[0]) for t in phase])
    return [complex(np.mean(shape * np.exp(-2j * math.pi * j * phase))) for j in range(1, HARMONICS + 1)]


def _peaks(gain: Values, apart: int) -> list[int]:
    """Return the places of the highest peaks that lie apart from one another."""
    left, found = gain.copy(), []
    for _ in range(TRIED):
        k = int(np.argmax(left))
        if not left[k] > 0.0:
            break
        found.append(k)
        left[max(0, k - apart) : k + apart + 1] = 0.0
    return found

"""Fit a load that follows a plan (step, sine, slug): by its response in the innovations, all times and periods at once.

    e = A (h * s_q) + w        h response of the innovations to a load of 1 in one interval, s_q the plan of shape q

For each q the best A removes <e, h * s_q>^2 / (2 |h * s_q|^2) nats; correlations with all times and periods come from a
few Fourier transforms.  The best few are then replayed and refined.
"""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from blocks.recorded import Recorded
from diagram.diagram import Diagram
from gap.effect import Effect
from gap.floor import NU
from gap.problem import Problem
from gap.search import Fit, refined, tried

Floats = NDArray[np.float64]
PULSE = 1e-3  # size of the load that shows the response, in spans of its signal
LONGEST = 1.0 / 3.0  # period, as a share of the record: a longer one imitates a drift
SHORTEST = 6.0  # period, in rows
TRIED = 4  # shapes that are replayed
HARMONICS = 8
FINER = 4  # frequencies for each one that the record resolves


def is_load(effect: Effect) -> bool:
    """Return whether an effect is a size times a plan of a time or a period."""
    return [p.name for p in effect.parameters][1:] in (["time"], ["period"]) and effect.parameters[0].neutral == 0.0


def fitted_load(problem: Problem, base: Diagram, effect: Effect, place: str) -> Fit | None:
    """Return the best fit of a planned load; None if no run succeeded."""
    response = _response(problem, base, place)
    if response is None:
        return None
    e = _trimmed(problem.innovations(base)[0])
    names = [p.name for p in effect.parameters]
    guesses = (_steps if names[1] == "time" else _periods)(problem, effect, base, place, e, response)
    low, high = effect.bounds(base, place)[names[0]]
    many = [{names[0]: float(np.clip(size, low, high)), names[1]: float(shape)} for size, shape in guesses]
    fits = [fit for fit in tried(problem, base, effect, place, many) if math.isfinite(fit.F)]
    fits.sort(key=lambda fit: fit.F)
    return min((refined(problem, base, fit) for fit in fits[:2]), key=lambda fit: fit.F, default=None)


def _trimmed(e: Floats) -> Floats:
    """Return innovations with the weight that Student's loss gives them, unknown ones 0."""
    scale = max(1.0, 2.0 * float(np.nanmedian(np.abs(e))))
    return np.nan_to_num(e / (1.0 + (e / scale) ** 2 / NU))


def _response(problem: Problem, base: Diagram, place: str) -> Floats | None:
    """Return the innovations' response to a load of 1 in one interval, (rows from then on, signals)."""
    t = problem.record.log.t
    at = problem.floor.skipped + (len(t) - problem.floor.skipped) // 4
    signal = base[place].output_labels[0]
    low, high = base.signal_spans.get(signal, (0.0, 1.0))
    size = PULSE * (high - low)
    idle = base.replace(place, Recorded(signal, t, np.zeros(len(t)), hold="previous", name=place))
    push = np.zeros(len(t))
    push[at] = size
    kicked = base.replace(place, Recorded(signal, t, push, hold="previous", name=place))
    found = (problem.innovations(kicked)[0] - problem.innovations(idle)[0]) / size
    h = np.nan_to_num(found[at - problem.floor.skipped :])
    return h if np.abs(h).max(initial=0.0) > 0.0 else None


def _steps(
    problem: Problem, effect: Effect, base: Diagram, place: str, e: Floats, h: Floats
) -> Sequence[tuple[float, float]]:
    """Return (size, time) of the best steps."""
    n = len(e)
    H = np.zeros((n, h.shape[1]))
    H[: len(h)] = np.cumsum(h, axis=0)[:n]
    H[len(h) :] = H[len(h) - 1]
    size = 2 * n
    hit = np.fft.irfft(
        (np.fft.rfft(e, size, axis=0) * np.conj(np.fft.rfft(H, size, axis=0))).sum(axis=1), size
    )[:n]
    power = np.cumsum((H**2).sum(axis=1))[::-1]  # of a step at row k: what of H lies inside the record
    gain = hit**2 / np.maximum(power, 1e-300)
    gain[power < 0.001 * power[0]] = 0.0
    best = _peaks(gain, n // 50 + 1)
    t = problem.record.log.t[problem.floor.skipped :]
    return [(hit[k] / power[k], t[k]) for k in best]


def _periods(
    problem: Problem, effect: Effect, base: Diagram, place: str, e: Floats, h: Floats
) -> Sequence[tuple[float, float]]:
    """Return (size, period) of the best periodic loads whose plan begins with the record."""
    log = problem.record.log
    n, dt = len(e), log.dt
    size = FINER * (1 << (n - 1).bit_length())
    E, H = np.fft.rfft(e, size, axis=0), np.fft.rfft(h[: n // 2], size, axis=0)
    hit, power = (np.conj(H) * E).sum(axis=1), (np.abs(H) ** 2).sum(axis=1)
    late = log.t[problem.floor.skipped] - 0.5 * dt  # rows count from here; a held sample stands half an interval later
    plan = _harmonics(effect)
    longest, shortest = LONGEST * n * dt, SHORTEST * dt
    k = np.arange(max(1, math.ceil(size * dt / longest)), min(int(size * dt / shortest), len(hit) - 1))
    total, norm = np.zeros(len(k)), np.full(len(k), 1e-300)
    for j, b in enumerate(plan, start=1):
        inside = j * k < len(hit)
        at = np.where(inside, j * k, 0)
        turn = np.exp(-2j * math.pi * at / (size * dt) * late)
        total += np.where(inside, np.real(2.0 * np.conj(b * np.conj(turn)) * hit[at]), 0.0)
        norm += np.where(inside, 2.0 * n * np.abs(b) ** 2 * power[at], 0.0)
    gain = total**2 / norm
    best = _peaks(gain, 2 * FINER)
    return [(total[i] / norm[i], size * dt / k[i]) for i in best]


def _harmonics(effect: Effect) -> list[complex]:
    """Return the Fourier coefficients of one period of an effect's plan of amplitude 1."""
    phase = (np.arange(512) + 0.5) / 512
    shape = effect.plan(phase)
    return [complex(np.mean(shape * np.exp(-2j * math.pi * j * phase))) for j in range(1, HARMONICS + 1)]


def _peaks(gain: Floats, apart: int) -> list[int]:
    """Return the places of the highest peaks that lie apart from one another."""
    left, found = gain.copy(), []
    for _ in range(TRIED):
        k = int(np.argmax(left))
        if not left[k] > 0.0:
            break
        found.append(k)
        left[max(0, k - apart) : k + apart + 1] = 0.0
    return found

"""Kalman prefilter with a local linear trend: takes noise off a signal of any sampling, with its slope.

    state (level x [unit], slope v [unit/s]),   over a step h = t - t_previous [s]:
    F = [[1, h], [0, 1]],   Q = q [[h^3/3, h^2/2], [h^2/2, h]],   z = x + noise,   noise variance r

The slope wanders with intensity q [unit^2/s^3]; F and Q are built anew for every step, so the sampling may be
uneven, and a missing sample is a step without a measurement. ``filter`` is causal, ``smooth`` is the
Rauch-Tung-Striebel smoother for whole records (no phase lag), ``init`` / ``update`` the streaming form.

The arithmetic is filterpy's (predict, update, rts_smoother). Minded here: its functional smoother takes the
transition from k to k + 1 at index k (its class takes k + 1, which is wrong by one for uneven steps when fed
alike), and it lets P lose its symmetry; P is made symmetric after every step.

What it does to the area ratio R of an exponential wave (true 5.87, half period 25 samples): smoothed with q
fitted, R = 4.3 at 2 % noise, 2.5 at 10 %, 1.9 at 20 %, 1.6 at 30 % of the signal's standard deviation; with the
bandwidth fixed at five times the frequency of oscillation, 2.2 even at 2 %. Sine and triangle stay at 1. The
moving average of ``area_ratio`` does as well (its page has the table), so that method does not use this filter.

>>> import numpy as np
>>> rng = np.random.default_rng(1)
>>> t = np.cumsum(rng.uniform(0.5, 1.5, 600))
>>> clean = np.sin(t / 15)
>>> p = estimate(t, clean + rng.normal(0, 0.2, 600))
>>> level = smooth(p, t, clean + rng.normal(0, 0.2, 600)).level
>>> bool(np.std(level - clean) < 0.08)
True
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from stickslip.detect.signals.smoothing import noise_std
from stickslip.logs.arrays import Mask, Values

_H = np.array([[1.0, 0.0]])


@dataclass(frozen=True)
class Params:
    """Noise of the measurement and liveliness of the signal.

    noise_std : standard deviation of the measurement noise, sqrt(r) [unit]
    q : intensity of the slope's random walk [unit^2/s^3]. The filter follows the signal up to about (q / (r h))^(1/4)
        rad/s, h being the sampling interval.
    """

    noise_std: float
    q: float

    def __post_init__(self) -> None:
        if not (self.noise_std > 0 and self.q > 0 and math.isfinite(self.noise_std + self.q)):
            raise ValueError(
                f"noise_std = {self.noise_std}, q = {self.q}; both must be positive and finite: "
                "use ``estimate`` or give them"
            )


class State(NamedTuple):
    """Time of the last row [s], mean (2,) and covariance (2, 2); nothing seen yet when t is NaN."""

    t: float
    x: Values
    P: Values


@dataclass(frozen=True, eq=False)
class Trend:
    """Level [unit] and slope [unit/s] over time, with the standard deviation of the level, shapes (n,)."""

    level: Values
    slope: Values
    level_std: Values


def init(p: Params) -> State:
    """The state before the first sample."""
    return State(math.nan, np.zeros(2), np.eye(2))


def update(p: Params, s: State, t: float, z: float) -> State:
    """The state after the measurement z [unit] at t [s]; z = NaN only predicts.

    Before the first finite z the state stays empty. Raises ValueError when time does not advance.
    """
    from filterpy.kalman import predict
    from filterpy.kalman import update as correct

    r = p.noise_std**2
    if math.isnan(s.t):
        if not math.isfinite(z):
            return s
        # The first level is known to the noise; the slope is not known at all: a wide prior of ten noise
        # standard deviations, or the walk of a second, whichever is wider.
        return State(t, np.array([z, 0.0]), np.diag([r, max(100 * r, p.q)]))
    h = t - s.t
    if not h > 0:
        raise ValueError(f"t = {t} s follows {s.t} s; time must increase, sort the samples first")
    x, P = predict(s.x, s.P, F=_transition(h), Q=_walk(p.q, h))
    if math.isfinite(z):
        x, P = correct(x, P, z, r, _H)
    return State(t, x, 0.5 * (P + P.T))


def filter(p: Params, t: Values, z: Values) -> Trend:
    """Return level and slope at every sample, (n,), estimated from those so far; NaN before the first finite z."""
    states = _run(p, t, z)
    return _trend(np.array([s.x for s in states]), np.array([s.P for s in states]), _started(states))


def smooth(p: Params, t: Values, z: Values) -> Trend:
    """Return level and slope at every sample, (n,), estimated from the whole record (Rauch-Tung-Striebel smoother)."""
    from filterpy.kalman import rts_smoother

    states = _run(p, t, z)
    seen = _started(states)
    first = int(np.argmax(seen))
    x, P = np.array([s.x for s in states[first:]]), np.array([s.P for s in states[first:]])
    steps = np.append(np.diff(t[first:]), 1.0)  # the last one is not used
    if seen.any() and len(x) > 1:
        Fs, Qs = [_transition(h) for h in steps], [_walk(p.q, h) for h in steps]
        x, P, _, _ = rts_smoother(x, P, Fs, Qs)
    pad = np.full((first, 2), np.nan)
    return _trend(np.concatenate([pad, x]), np.concatenate([np.zeros((first, 2, 2)), P]), seen)


def log_likelihood(p: Params, t: Values, z: Values) -> float:
    """Logarithm of the probability of the measurements after the second, from the innovations."""
    total, s, r, seen = 0.0, init(p), p.noise_std**2, 0
    for ti, zi in zip(t.tolist(), z.tolist(), strict=True):
        if seen >= 2 and math.isfinite(zi):
            h = ti - s.t
            F = _transition(h)
            S = float((F @ s.P @ F.T + _walk(p.q, h))[0, 0]) + r
            y = zi - float(s.x[0] + h * s.x[1])
            total -= 0.5 * (math.log(2 * math.pi * S) + y * y / S)
        seen += math.isfinite(zi)
        s = update(p, s, ti, zi)
    return total


def estimate(t: Values, z: Values, period: float | None = None, samples: int = 400) -> Params:
    """Parameters from the data, shapes (n,).

    noise_std comes from ``smoothing.noise_std``; q from the likelihood of the first ``samples`` samples over
    fourteen bandwidths from the length of the record to the sampling, or, with a known ``period`` [s], from a
    bandwidth of five times its frequency.

    Raises ValueError when fewer than 8 finite samples are given.
    """
    finite = np.isfinite(z)
    if np.count_nonzero(finite) < 8:
        raise ValueError(f"{np.count_nonzero(finite)} finite samples; 8 are needed to separate noise from signal")
    t, z = t[finite], z[finite]
    scale = float(np.std(z))
    sigma = max(noise_std(t, z), 1e-4 * scale, 1e-300)
    h = float(np.median(np.diff(t)))
    if period is not None:
        return Params(sigma, _intensity(sigma, h, 2 * math.pi * 5 / period))
    t, z = t[:samples], z[:samples]
    bandwidths = np.geomspace(2 * math.pi / (t[-1] - t[0]), 2 / h, 14)
    candidates = [Params(sigma, _intensity(sigma, h, float(w))) for w in bandwidths]
    return max(candidates, key=lambda p: log_likelihood(p, t, z))


def _intensity(sigma: float, h: float, w: float) -> float:
    return max(sigma**2 * h * w**4, 1e-300)


def _transition(h: float) -> Values:
    return np.array([[1.0, h], [0.0, 1.0]])


def _walk(q: float, h: float) -> Values:
    return q * np.array([[h**3 / 3, h**2 / 2], [h**2 / 2, h]])


def _run(p: Params, t: Values, z: Values) -> list[State]:
    s, states = init(p), []
    for ti, zi in zip(t.tolist(), z.tolist(), strict=True):
        s = update(p, s, ti, zi)
        states.append(s)
    return states


def _started(states: list[State]) -> Mask:
    return np.array([not math.isnan(s.t) for s in states])


def _trend(x: Values, P: Values, seen: Mask) -> Trend:
    level, slope = np.where(seen, x[:, 0], np.nan), np.where(seen, x[:, 1], np.nan)
    return Trend(level, slope, np.where(seen, np.sqrt(np.maximum(P[:, 0, 0], 0.0)), np.nan))

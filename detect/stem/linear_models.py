"""From many candidate inputs to one measurement: the best linear process behind each, without the bias of plain ARX.

    y(t) = b G(q) x(t - d) + c + noise,    G(q) = 1 / ((1 + tau_1 s)(1 + tau_2 s)), held input

tau_1, tau_2 and the dead time d run over a bank; gain b and offset c follow in closed form for each (separable least
squares), so the search is exact on the bank and has no local minimum. Five models of the noise:

    oe1      output error, one lag: white noise on y
    oe2      output error, two lags
    armax    one lag; noise (1 - c q^-1) / (1 - a q^-1) e, so that a disturbance passes the process too
    eoe      as oe2, with a slow disturbance beside it
    earmax   as armax, with a slow disturbance beside it

The slow disturbance of the extended models is what a moving average over two periods leaves of y; it is taken from
both sides alike, which leaves G as it is. Whatever the fit minimises, the quality is that of a simulation:

    F = 100 (1 - |y - y_sim| / |y - mean y|) %

In closed loop with white noise in the loop ARX would prefer the inverse of the controller, which turns OP back into PV
exactly; a linear loop then gains by a sticky valve that is not there.

Source: Bacci di Capaci, Scali and Pannocchia 2016, J. Process Control 46:11 (extended models); Karra and Karim 2009,
Control Eng. Practice 17:387 (EARMAX); Ljung 1999, System Identification. Ours: the bank in the place of a descent, and
the moving average in the place of an integrated noise.
"""

import math
from dataclasses import dataclass, replace
from typing import Literal, NamedTuple, get_args

import numpy as np
from stickslip.detect.signals.filters import first_order
from stickslip.logs.arrays import Values

Linear = Literal["oe1", "oe2", "armax", "eoe", "earmax"]

NOISE_ZEROS = (0.5, 0.8, 0.95)  # c of ARMAX; c = a would be output error, c = 0 plain ARX


class Process(NamedTuple):
    """Two lags and a dead time [samples], gain [unit of y / unit of x]."""

    tau_1: float
    tau_2: float
    delay: int
    gain: float


class Fit(NamedTuple):
    """F of every input, shape (m,) [%], the best process of each, and y and y_sim of the best, (k,)."""

    quality: Values
    processes: list[Process]
    y: Values
    simulated: Values


@dataclass(frozen=True)
class Bank:
    """What is tried: pairs of lags [samples], the longest dead time and the sign of the gain (0: either)."""

    pairs: tuple[tuple[float, float], ...]
    delay_max: int
    sign: float


def bank(period: float, model: Linear, sign: float, steps: int = 9, integrating: bool = False) -> Bank:
    """Lags from a third of a sample to two periods [samples], dead times to a quarter of a period.

    Two lags are tried equal and with the second a quarter of the first. An integrator is a lag without end.
    """
    if model not in get_args(Linear):
        raise ValueError(f"linear = {model!r}; give one of {', '.join(get_args(Linear))}")
    taus = np.geomspace(0.3, 2.0 * period, steps).tolist()
    second = (0.0, 0.25, 1.0) if model in ("oe2", "eoe") else (0.0,)
    pairs = [(tau, share * tau) for tau in taus for share in second]
    if integrating:
        pairs = [(math.inf, 0.0), *[(math.inf, tau) for tau in taus if model in ("oe2", "eoe") and tau < period]]
    return Bank(tuple(pairs), max(int(period / 4), 1), sign)


def near_by(tried: Bank, best: Process) -> Bank:
    """The bank around a process: lags within a third, in steps of an eighth; dead times as far as before."""
    scales = np.geomspace(0.7, 1.0 / 0.7, 7).tolist()
    if math.isinf(best.tau_1):
        pairs = {(math.inf, scale * best.tau_2) for scale in scales}
    else:
        pairs = {(scale * best.tau_1, scale * best.tau_2) for scale in scales}
        if best.tau_2 > 0.0:
            pairs |= {(scale * best.tau_1, best.tau_2 / scale) for scale in scales}
    return replace(tried, pairs=tuple(sorted(pairs)))


def fit(x: Values, y: Values, period: float, model: Linear, tried: Bank) -> Fit:
    """The best process of the bank behind each input x (m, n) for y (n,); the first period [samples] settles.

    >>> u = np.sin(np.arange(400.0) / 9) ** 3
    >>> found = fit(u[None], np.concatenate([np.zeros(3), 2 * u[:-3]]), 57.0, "oe1", bank(57.0, "oe1", 1.0))
    >>> bool(found.quality[0] > 90), found.processes[0].delay, round(found.processes[0].gain)
    (True, 2, 2)
    """
    start, end = _settled(x.shape[1], period, model)
    best = np.full(len(x), np.inf)
    quality = np.zeros(len(x))
    found = [Process(math.nan, math.nan, 0, 0.0)] * len(x)
    target = _through(y[None], 0.0, 0.0, period, model)[0]
    tss = float(np.var(target[start:end]))
    for pair in tried.pairs:
        through = _through(x, *pair, period, model)
        for zero in NOISE_ZEROS if "armax" in model else (None,):
            white = np.vstack([through, target])
            if zero is not None:
                white = first_order(white, 1.0, -math.exp(-1.0 / pair[0]), -zero)
            delay, gain, cost = _best_delays(white[:-1], white[-1], start, end, tried)
            better = np.flatnonzero(cost < best)
            best[better] = cost[better]
            for i in better.tolist():
                late = int(delay[i])
                rest = cost[i]
                if zero is not None:
                    rest = np.var(target[start:end] - gain[i] * through[i, start - late : end - late])
                quality[i] = 100.0 * (1.0 - math.sqrt(max(float(rest), 0.0) / tss))
                found[i] = Process(*pair, late, float(gain[i]))
    top = int(np.argmax(quality))
    return Fit(quality, found, target[start:end], _simulated(x[top], found[top], period, model)[start:end])


def _simulated(x: Values, process: Process, period: float, model: Linear) -> Values:
    if math.isnan(process.tau_1):
        return np.zeros(len(x))
    through = _through(x[None], process.tau_1, process.tau_2, period, model)[0]
    late = np.concatenate([np.full(process.delay, through[0]), through[: len(through) - process.delay]])
    start, end = _settled(len(x), period, model)
    return np.asarray(process.gain * (late - np.mean(late[start:end])))


def _settled(n: int, period: float, model: Linear) -> tuple[int, int]:
    """Where the unknown start has died out, and where a moving average still has both sides."""
    return min(round(0.75 * period), n // 3), n - (round(period) if _slow(model) and n > 6 * period else 0)


def _slow(model: Linear) -> bool:
    return model in ("eoe", "earmax")


def _best_delays(x: Values, y: Values, start: int, end: int, tried: Bank) -> tuple[Values, Values, Values]:
    """The best delay [samples] of each input, its gain by least squares with an offset, the mean square left, (m,)."""
    from stickslip.detect.stem.kernels import best_delays

    found = np.empty((len(x), 3))
    best_delays(x, y, start, end, tried.delay_max + 1, tried.sign, found)
    delay, gain, cost = found.T
    return delay, gain, cost


def _through(x: Values, tau_1: float, tau_2: float, period: float, model: Linear) -> Values:
    """The inputs behind two lags [samples], one sample late because they are held, freed; inf is an integrator."""
    from stickslip.detect.stem.kernels import lagged

    out = np.empty(x.shape)
    lagged(np.ascontiguousarray(x, dtype=float), tau_1, tau_2, _width(x.shape[1], period, model), out)
    return out


def _width(n: int, period: float, model: Linear) -> int:
    """Samples of the moving average that an extended model takes off n; 0 for the others."""
    width = 2 * round(period) + 1
    return width if _slow(model) and n > width else 0

"""Models of PV side by side: OP through a lag, with a sticky valve on the way and without; see ``methods/play_fit``.

The candidates (S, J, start) are tried on a coarse grid with a part of the samples, then closer and closer about the
best.  What S, J and start are good for is only ever judged by the same response model (``lags``) with the same freedom.
Two more rivals have that freedom too: a play, which has no slip jump, and a wave of constant period from outside.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from stickslip.detect.stem.lags import Lags, Response
from stickslip.detect.stem.stick import stick, turns
from stickslip.logs.arrays import Values

Candidate = tuple[float, float, float]  # S, J / S, start
SIZES = (0.06, 0.1, 0.15, 0.22, 0.3, 0.38, 0.46, 0.54, 0.62, 0.7, 0.77, 0.83, 0.88, 0.93, 0.97)  # S over OP's travel
JUMPS = (0.0, 0.35, 0.7, 1.0)  # J over S
STARTS = (-1.0, -0.5, 0.0, 0.5, 1.0)
COARSE, CLOSE = 300, 600  # samples compared in the search; the models are judged by all
HARMONICS = 6
NONE: Candidate = (0.0, 0.0, 0.0)


class Fit(NamedTuple):
    """The models side by side; S, J, low, high in the unit of u.

    ratio, gain : over no valve;  jump_gain : over a play without slip jump;  clock : rms of the outside wave over the
    valve's [-]
    explained, explained_without : share of y's variance [-]; lag : mean lag of the best linear model [samples]
    wins, spread : over the reversals [-]; S_each : (r,) S at each
    sizes, loss : (m,) sizes tried, and how far n_eff ln(rms) of the best fit with each lies above the least
    x, y, linear, played : (m,) best stem, y freed of load, what is left of it without and with play, where the models
    are compared, to the end of the record
    """

    ratio: float
    gain: float
    jump_gain: float
    clock: float
    S: float
    J: float
    low: float
    high: float
    explained: float
    explained_without: float
    lag: float
    travel: float
    wins: float
    spread: float
    S_each: Values
    sizes: Values
    loss: Values
    x: Values
    y: Values
    linear: Values
    played: Values
    integrating: bool


def fit(
    u: Values, y: Values, turn: float, sign: float = 1.0, kinds: Sequence[bool] = (False,), wave: float | None = None
) -> Fit:
    """Fit y (n,) by u (n,) with and without a sticky valve; ``turn`` [samples] is the time between two turns of u.

    kinds : sequence of bool; whether the process integrates; of two kinds the one that tells more of y is taken
    wave : float, optional; period of the oscillation [samples]; by default two turns

    >>> t = np.arange(600.0)
    >>> u = 5 * np.sin(t / 15) + np.sin(t / 47)
    >>> found = fit(u, stick(u, 4.0), 47.0)
    >>> round(found.S, 1), found.ratio > 10, found.explained > 0.999
    (4.0, True, True)
    """
    travel = travel_of(u, turn)
    grid = [NONE] + [(share * travel, q, a) for share in SIZES for q in JUMPS for a in STARTS]
    first = [_Table(u, Lags(y, turn, kind, sign, COARSE)) for kind in kinds]
    for tried in first:
        tried.add(grid)
    coarse = max(first, key=lambda tried: tried.explained)
    integrating = coarse.model.integrating
    close = _Table(u, Lags(y, turn, integrating, sign, CLOSE))
    jumpless = _close_in(close, coarse, play=True)
    best = _close_in(close, coarse, play=False)

    whole = _Table(u, model := Lags(y, turn, integrating, sign))
    whole.add([NONE, jumpless, best])
    linear, played = whole.responses[NONE], whole.responses[best]
    S, ratio, start = best
    x = stick(u, S, ratio * S, start)
    left, left_without = whole.residual(best), whole.residual(NONE)
    a = float(left[1:] @ left[:-1]) / max(float(left @ left), 1e-300)
    # The load model leaves no swing beyond a few turns, so there is about one look per turn even where a nears one.
    n_eff = min(max(len(u) * (1.0 - a) / (1.0 + a), len(u) / turn), float(len(u)))
    wins, each = _reversals(u, best, whole, left, left_without)
    gain = 0.5 * n_eff * math.log(linear.rss / played.rss)
    sizes, profile = _profile((coarse, close, whole), gain, n_eff)
    # Each reversal is one look at S: what is left within one is the same misfit, however many samples it has.
    low, high = interval(sizes, profile * min(n_eff, max(len(each), 1.0)) / n_eff, S)
    spread = float(np.percentile(each, 75) - np.percentile(each, 25)) / (1.35 * S) if len(each) else math.inf
    clocked = _clocked(u, y, turn, 2.0 * turn if wave is None else wave, model)
    return Fit(
        math.sqrt(linear.rss / played.rss), gain, 0.5 * n_eff * math.log(whole.responses[jumpless].rss / played.rss),
        math.sqrt(clocked / played.rss), S, ratio * S, low, high, 1.0 - played.rss / model.tss,
        1.0 - linear.rss / model.tss, linear.lag, travel, wins, spread, each, sizes, profile, x[model.rows], model.y,
        left_without,
        left, integrating,
    )  # fmt: skip


class _Table:
    """Every candidate tried for u (n,), with its best response by one model."""

    def __init__(self, u: Values, model: Lags) -> None:
        self.u, self.model = u, model
        self.responses: dict[Candidate, Response] = {}

    def add(self, keys: list[Candidate]) -> None:
        """Try those that are new."""
        keys = list(dict.fromkeys(key for key in keys if key not in self.responses))
        if keys:
            s, r, a = np.array(keys).T
            self.responses.update(zip(keys, self.model.fit(stick(self.u, s, r * s, a)), strict=True))

    def best(self, m: int, play: bool = False) -> list[Candidate]:
        """The m best, best first; ``play`` asks for those without a slip jump."""
        keys = [key for key in self.responses if key != NONE and (not play or key[1] == 0.0)]
        return sorted(keys, key=lambda key: self.responses[key].rss)[:m]

    def residual(self, key: Candidate) -> Values:
        """What a candidate leaves of y."""
        S, ratio, start = key
        return self.model.residual(stick(self.u, S, ratio * S, start), self.responses[key])

    @property
    def explained(self) -> float:
        """Largest explained share of the variance of y [-]."""
        return 1.0 - min(response.rss for response in self.responses.values()) / self.model.tss


def _close_in(close: _Table, coarse: _Table, play: bool) -> Candidate:
    """The best candidate by the close model, sought about the best of the coarse one."""
    width, centres = 0.13, coarse.best(2 if play else 3, play)  # half the widest gap of SIZES
    close.add([NONE])
    for kept in (2, 1, 1):
        close.add([near for centre in centres for near in _about(centre, width, play)])
        centres, width = close.best(kept, play), 0.35 * width
    return centres[0]


def _about(centre: Candidate, width: float, play: bool) -> list[Candidate]:
    """Candidates around one: S within ``width`` of it [-], J / S and start further, because they matter less."""
    S, ratio, start = centre
    ratios = {0.0} if play else {min(max(ratio + 2.5 * width * j, 0.0), 1.0) for j in (-1, 0, 1)}
    starts = {min(max(start + 5.0 * width * k, -1.0), 1.0) for k in (-1, 0, 1)}
    return [(S * (1.0 + width * i), r, a) for i in (-1.0, -0.5, 0.0, 0.5, 1.0) for r in ratios for a in starts]


def _profile(tables: Sequence[_Table], gain: float, n_eff: float) -> tuple[Values, Values]:
    """Every size tried and the least loss of log-likelihood that a candidate of that size has, both (m,)."""
    loss: dict[float, float] = {}
    for tried in tables:
        without = tried.responses[NONE].rss
        for (size, _, _), response in tried.responses.items():
            value = gain + 0.5 * n_eff * math.log(response.rss / without)
            loss[size] = min(loss.get(size, math.inf), value)
    return np.array(sorted(loss)), np.array([loss[s] for s in sorted(loss)])


def _clocked(u: Values, y: Values, turn: float, wave: float, model: Lags) -> float:
    """Sum of squares that a wave of constant period from outside leaves, OP through a lag beside it.

    The period is sought within a tenth of ``wave`` [samples], where y has most power in it and its harmonics.
    """
    n = len(u)
    harmonics = np.arange(1, min(HARMONICS, max(int(0.4 * wave), 1)) + 1)
    phase = 2.0 * np.pi * np.arange(n) / wave

    def waves(scale: float) -> Values:
        angle = scale * phase[:, None] * harmonics
        return np.column_stack([np.cos(angle), np.sin(angle)])

    def power(scale: float) -> float:  # the harmonics are orthogonal over many cycles
        spectrum = np.exp(-1j * scale * np.outer(harmonics, phase[model.rows])) @ model.y
        return float(np.sum(np.abs(spectrum) ** 2))

    step = 0.25 * wave / n  # a quarter of the width of a spectral line
    scales = np.arange(0.9, 1.1 + 0.5 * step, max(step, 0.002))
    best = max(scales.tolist(), key=power)
    finer = max(np.linspace(best - step, best + step, 9).tolist(), key=power)
    rival = Lags(y, turn, model.integrating, model.sign, waves=waves(finer))
    return rival.fit(u[:, None])[0].rss


def travel_of(u: Values, turn: float) -> float:
    """How far OP moves between two turns: the 90th percentile over windows of two."""
    width = min(max(round(2.0 * turn), 2), len(u))
    rows = np.lib.stride_tricks.sliding_window_view(u, width)[:: max(width // 8, 1)]
    return float(np.percentile(np.ptp(rows, axis=1), 90))


def interval(at: Values, loss: Values, S: float) -> tuple[float, float]:
    """The sizes about S where the loss stays below half the 90 % point of chi-square with one degree of freedom."""
    limit, k = 1.353, int(np.searchsorted(at, S))

    def edge(way: int) -> float:
        inside = k
        while 0 <= inside + way < len(at):
            beyond = inside + way
            if loss[beyond] > limit:
                share = (limit - loss[inside]) / (loss[beyond] - loss[inside])
                return float(at[inside] + share * (at[beyond] - at[inside]))
            inside = beyond
        return float(at[inside])

    return edge(-1), edge(1)


def _reversals(u: Values, best: Candidate, whole: _Table, left: Values, left_without: Values) -> tuple[float, Values]:
    """Share of the reversals with travel beyond S at which the valve wins, and the best S at each."""
    S, ratio, start = best
    at = turns(u, S) - whole.model.rows[0] if S > 0.0 else np.empty(0, dtype=np.intp)
    at = at[at >= 0]
    if not len(at):
        return 0.0, np.empty(0)
    with_, without = np.add.reduceat(left**2, at), np.add.reduceat(left_without**2, at)
    trial = S * np.concatenate([np.linspace(0.5, 0.95, 8), [1.0], np.linspace(1.05, 1.5, 8)])
    whole.add([(float(size), ratio, start) for size in trial])
    squares = [np.add.reduceat(whole.residual((size, ratio, start)) ** 2, at) for size in trial.tolist()]
    return float(np.mean(with_ < without)), np.asarray(trial[np.argmin(squares, axis=0)])

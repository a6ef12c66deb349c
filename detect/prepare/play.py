"""Two models of PV side by side: OP through a lag, with a play on the way and without one; see ``methods/play_fit``.

The candidates are tried over a coarse grid of (S, J, start) with part of the samples, then closer and closer about the
best; what S, J and start are good for is only ever told by the same response model (``lags``) with the same freedom.
"""

from __future__ import annotations

import math
from typing import NamedTuple, Protocol

import numpy as np
import numpy.typing as npt

from detect.prepare.lags import Lags, Response
from detect.prepare.stick import stick, turns

__all__ = ["Candidate", "Fit", "Model", "Table", "fit", "interval", "search", "travel_of"]

Values = npt.NDArray[np.float64]
Candidate = tuple[float, float, float]  # S, J / S, start
SIZES = (0.06, 0.1, 0.15, 0.22, 0.3, 0.38, 0.46, 0.54, 0.62, 0.7, 0.77, 0.83, 0.88, 0.93, 0.97)  # S over OP's travel
JUMPS = (0.0, 0.35, 0.7, 1.0)  # J over S
STARTS = (-1.0, -0.5, 0.0, 0.5, 1.0)


class Fit(NamedTuple):
    """The two models side by side; S, J, low, high in the unit of u.

    told, told_without : share of y's variance told [-]; lag : mean lag of the best linear model [samples]
    wins, spread : over the reversals [-]; S_each : (r,) S at each
    sizes, loss : (m,) sizes tried, and how far n_eff ln(rms) of the best fit with each lies above the least
    x, y, linear, played : (n,) best stem, y freed of load, what is left of it without and with play
    """

    ratio: float
    gain: float
    S: float
    J: float
    low: float
    high: float
    told: float
    told_without: float
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


def fit(u: Values, y: Values, turn: float, sign: float = 1.0, integrating: bool = False) -> Fit:
    """Fit y (n,) by u (n,) with and without play; ``turn`` [samples] is the time between two turns of u.

    >>> t = np.arange(600.0)
    >>> u = 5 * np.sin(t / 15) + np.sin(t / 47)
    >>> found = fit(u, stick(u, 4.0), 47.0)
    >>> round(found.S, 2), found.ratio > 10, found.told > 0.999
    (4.0, True, True)
    """
    travel = travel_of(u, turn)
    coarse = Lags(y, turn, integrating, sign, every=max(1, int(turn / 12.0)))
    model = Lags(y, turn, integrating, sign)
    quick, table = search(u, travel, coarse, model)
    S, ratio, start = table.best(1)[0]
    linear = table.responses[(0.0, 0.0, 0.0)]
    played = table.responses[(S, ratio, start)]
    x = stick(u, S, ratio * S, start)
    left, left_without = model.residual(x, played), model.residual(u, linear)
    a = float(left[1:] @ left[:-1]) / max(float(left @ left), 1e-300)
    # The load model leaves no swing beyond a few turns, so there is about one look per turn even where a nears one.
    n_eff = min(max(len(u) * (1.0 - a) / (1.0 + a), len(u) / turn), float(len(u)))
    wins, each = _reversals(u, S, ratio, start, table, model, left, left_without)
    gain = 0.5 * n_eff * math.log(linear.rss / played.rss)
    loss: dict[float, float] = {}
    for tried in (quick, table):
        without = tried.responses[(0.0, 0.0, 0.0)]
        for (size, _, _), response in tried.responses.items():
            value = gain + 0.5 * n_eff * math.log(response.rss / without.rss)
            loss[size] = min(loss.get(size, math.inf), value)
    sizes, profile = np.array(sorted(loss)), np.array([loss[s] for s in sorted(loss)])
    # Each reversal is one look at S: what is left within one is the same misfit, however many samples it has.
    low, high = interval(sizes, profile * min(n_eff, max(len(each), 1.0)) / n_eff, S)
    spread = float(np.percentile(each, 75) - np.percentile(each, 25)) / (1.35 * S) if len(each) else math.inf
    told, told_without = 1.0 - played.rss / model.tss, 1.0 - linear.rss / model.tss
    return Fit(
        math.sqrt(linear.rss / played.rss), gain, S, ratio * S, low, high, told, told_without, linear.lag, travel, wins,
        spread, each, sizes, profile, x, model.y, left_without, left, integrating,
    )  # fmt: skip


def search(u: Values, travel: float, coarse: Model, close: Model) -> tuple[Table, Table]:
    """Try stems for u (n,) on the whole grid by the coarse model, then about the best by the close one, S = 0 too."""
    quick, table = Table(u, coarse), Table(u, close)
    quick.add([(0.0, 0.0, 0.0)] + [(share * travel, q, a) for share in SIZES for q in JUMPS for a in STARTS])
    table.add([(0.0, 0.0, 0.0)])
    width, centres = 0.13, quick.best(4)  # half the widest gap of SIZES
    for kept in (3, 2, 1):
        table.add([near for centre in centres for near in _about(centre, width)])
        centres, width = table.best(kept), 0.35 * width
    return quick, table


def _about(centre: Candidate, width: float) -> list[Candidate]:
    """Candidates around one: S within ``width`` of it [-], J / S and start further, because they matter less."""
    S, ratio, start = centre
    ratios = {min(max(ratio + 2.5 * width * j, 0.0), 1.0) for j in (-1, 0, 1)}
    starts = {min(max(start + 5.0 * width * k, -1.0), 1.0) for k in (-1, 0, 1)}
    return [(S * (1.0 + width * i), r, a) for i in (-1.0, -0.5, 0.0, 0.5, 1.0) for r in ratios for a in starts]


class Model(Protocol):
    """Anything that fits a measurement by each of the stems x (n, m)."""

    def fit(self, x: Values) -> list[Response]:
        """The best response to each."""


class Table:
    """Every candidate tried for u (n,), with its best response."""

    def __init__(self, u: Values, model: Model) -> None:
        self.u, self.model = u, model
        self.responses: dict[Candidate, Response] = {}

    def add(self, keys: list[Candidate]) -> None:
        """Try those that are new."""
        keys = list(dict.fromkeys(key for key in keys if key not in self.responses))
        if keys:
            s, r, a = np.array(keys).T
            self.responses.update(zip(keys, self.model.fit(stick(self.u, s, r * s, a)), strict=True))

    def best(self, m: int) -> list[Candidate]:
        """The m best, best first."""
        return sorted(self.responses, key=lambda key: self.responses[key].rss)[:m]


def travel_of(u: Values, turn: float) -> float:
    """How far OP moves between two turns: the 90th percentile over windows of two."""
    width = min(max(round(2.0 * turn), 2), len(u))
    starts = np.arange(0, len(u) - width + 1, max(width // 8, 1))
    return float(np.percentile([np.ptp(u[k : k + width]) for k in starts], 90))


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


def _reversals(
    u: Values, S: float, ratio: float, start: float, table: Table, model: Lags, left: Values, left_without: Values
) -> tuple[float, Values]:
    """Share of the reversals with travel beyond S at which play wins, and the best S at each."""
    at = turns(u, S) if S > 0.0 else np.empty(0, dtype=np.intp)
    if not len(at):
        return 0.0, np.empty(0)
    with_, without = np.add.reduceat(left**2, at), np.add.reduceat(left_without**2, at)
    trial = S * np.concatenate([np.linspace(0.5, 0.95, 8), [1.0], np.linspace(1.05, 1.5, 8)])
    stems = stick(u, trial, ratio * trial, start)
    squares = []
    for size, stem, response in zip(trial.tolist(), stems.T, model.fit(stems), strict=True):
        squares.append(np.add.reduceat(model.residual(stem, response) ** 2, at))
        table.responses[(size, ratio, start)] = response
    return float(np.mean(with_ < without)), np.asarray(trial[np.argmin(squares, axis=0)])

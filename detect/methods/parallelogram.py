"""Parallelogram, Kano et al. 2004 method B: the width of the play that makes OP correlate best with the stem.

    F(t) = max(min(F(t-1) + OP(t) - OP(t-1), F_max), 0)
    rho* = max over F_max, F(0) and a short lag of |corr(OP - F, y)|
    rho0 = max over any lag up to half a period of |corr(OP, y)|,    W = F_max / travel of OP

OP - F is the play operator of width F_max: it draws the parallelogram of a sticky valve, whose level sides are F_max
long.  The travel of OP is its range between two turns (the paper's range of the whole record grows with every drift and
set-point move).  y is MV where it is logged, else PV, which stands for the stem in a flow loop.  PV lags behind the
stem, and a lag opens the picture as a play does: so OP - F may be shifted by up to an eighth of a period, and OP alone,
the rival, by up to half of one.

Source: Kano, Maruta, Kugemoto, Shimizu 2004, DYCOPS.  The paper leaves open how F_max is found and judged.  Ours: a
grid of 50 widths and 5 starts; stiction where rho* >= 0.5, W >= 0.25 and OP - F leaves at most ``left`` of the variance
that OP alone leaves (a limit on rho* - rho0, as the paper's readers use, loses plain parallelograms that are densely
sampled).  A small W clears nothing: two signals that have nothing in common have one too.

F_max is S where J = 0.  A slip has steeper sides than a play, and the best play is then narrower than S by up to J.  So
the verdict rests on the play of the paper, and the amounts on the stick of S and J that correlates best about it
(``sizes_of``), which is ours.  Deadband and stiction differ by J alone; a lag between stem and PV hides it, and
takes up to 30 % off S (docs/evidence/amounts.md).  In a cycle it has two places, and a correlation hardly tells J.
Not for levels, where any wave lags a quarter period, nor for slow processes without MV.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from stickslip.detect.card import Card
from stickslip.detect.prepare.preconditions import refused, too_short
from stickslip.detect.prepare.prepared import Prepared, prepared
from stickslip.detect.prepare.stem_signal import stem_signal
from stickslip.detect.stem.play import interval, travel_of
from stickslip.detect.stem.stick import stick, turn_time, turns
from stickslip.detect.verdict import FigureBase, Verdict, Word
from stickslip.logs import LoopRecord
from stickslip.logs.arrays import Indices, Values

CARD = Card(
    name="parallelogram", title="Parallelogram", source="Kano, Maruta, Kugemoto, Shimizu 2004, DYCOPS, method B",
    signals=("OP", "MV", "PV"), process=("self_regulating",),
    assumes=("MV logged, or a fast flow loop", "OP range large against the noise"),
    finds="stiction or deadband from the width of the OP-MV picture; S in % of OP",
    index=(0.0, 1.0), streams="window", cost="O(50 n)", experimental=True,
    stream_note="The width of the play is searched for over a whole record, after PV was shifted for all of it.",
    pros=("gives S", "no oscillation needed", "set point may move"),
    cons=("a process lag opens the picture too", "S from PV low", "deadband looks the same", "blind on levels"),
    needs=("unsaturated", "fine_pv"),
)  # fmt: skip

AT_ONCE = 64  # sticks that are made together: each takes as much memory as the record


@dataclass(frozen=True)
class Params:
    """Limits, all ours: W, rho* and the share of the variance left [-]; fewest reversals beyond S and samples."""

    width: float = 0.25
    rho: float = 0.5
    left: float = 0.6
    reversals: int = 4
    samples: int = 150


class Width(NamedTuple):
    """S [unit of u], low and high of its 90 % interval, rho* and rho0 [-], lag [samples], play output x (n,).

    sizes (50,) and rho (50,): best correlation with each width; slope : of y on x; travel : of u between two turns
    """

    S: float
    low: float
    high: float
    best: float
    without: float
    lag: int
    x: Values
    sizes: Values
    rho: Values
    slope: float
    travel: float


def width(u: Values, y: Values, turn: float) -> Width:
    """The width of the play between u and y (n,); ``turn`` [samples] is the time between two turns of u.

    >>> from stickslip.detect.stem.stick import stick
    >>> t = np.arange(800.0)
    >>> u = 5 * np.sin(t / 15) + np.sin(t / 47)
    >>> found = width(u, stick(u, 4.0), 47.0)
    >>> round(found.S, 1), round(found.best, 3), found.lag
    (4.0, 1.0, 0)
    """
    n, drop = len(u), len(u) // 10
    span = travel_of(u, turn)
    short = np.unique(np.linspace(0, 0.25 * turn, 6).astype(int))
    sizes = span * np.linspace(0.02, 1.0, 50)
    starts = np.linspace(-1.0, 1.0, 5)
    rho, at = _correlate(stick(u, np.repeat(sizes, 5), 0.0, np.tile(starts, 50)), y, short, drop)
    rho = rho.reshape(50, 5)
    k = int(np.argmax(np.max(rho, axis=1)))
    start = float(starts[np.argmax(rho[k])])
    fine = np.linspace(max(sizes[k] - 0.06 * span, 1e-3 * span), min(sizes[k] + 0.06 * span, span), 61)
    stems = stick(u, fine, 0.0, start)
    middle, reach = int(short[at.reshape(50, 5)[k, np.argmax(rho[k])]]), int(np.max(np.diff(short), initial=1))
    short = np.arange(max(middle - reach, 0), min(middle + reach, int(short[-1])) + 1)
    close, at = _correlate(stems, y, short, drop)
    best = int(np.argmax(close))
    any_lag = np.unique(np.linspace(0, turn, 25).astype(int))
    without = float(_correlate(u[:, None], y, any_lag[any_lag < n // 2], drop)[0][0])
    top = float(close[best])
    looks = max(len(turns(u, float(fine[best]))), 1)
    tried, reached = np.concatenate([sizes, fine]), np.concatenate([np.max(rho, axis=1), close])
    order = np.argsort(tried)
    loss = 0.5 * looks * np.log((1.0 - reached[order] ** 2 + 1e-12) / (1.0 - top**2 + 1e-12))
    low, high = interval(tried[order], loss, float(fine[best]))
    x, lag = stems[:, best], int(short[at[best]])
    late = x[: n - lag] if lag else x
    slope = float(np.cov(late[drop:], y[lag + drop :])[0, 1] / max(np.var(late[drop:]), 1e-300))
    return Width(float(fine[best]), low, high, top, without, lag, x, sizes, np.max(rho, axis=1), slope, span)


def _correlate(x: Values, y: Values, lags: Indices, drop: int) -> tuple[Values, Indices]:
    """The largest |corr| of each column of x (n, m) with y (n,) that follows it by one of the lags, and which lag."""
    reach = int(lags[-1])
    head = x[drop : len(x) - reach]
    size = math.sqrt(len(head)) * np.array([np.std(column) for column in head.T])  # one by one: hundreds of long ones
    tails = np.array([y[drop + lag : len(y) - reach + lag] for lag in lags])
    tails = tails - np.mean(tails, axis=1, keepdims=True)  # so the means of the columns do not count
    tails /= np.maximum(np.linalg.norm(tails, axis=1, keepdims=True), 1e-300)
    still = size <= 1e-9 * max(float(np.max(size)), 1e-300)
    rho = np.abs(tails @ head) / np.where(still, np.inf, size)
    return np.minimum(np.max(rho, axis=0), 1.0), np.argmax(rho, axis=0)


class Sizes(NamedTuple):
    """S, low and high of its 90 % interval, J [unit of u], and the stem x (n,) of that S and J."""

    S: float
    low: float
    high: float
    J: float
    x: Values


def sizes_of(u: Values, y: Values, found: Width) -> Sizes:
    """S and J of the stick that correlates best with y (n,), sought about the play that was ``found``.

    >>> u = 8.0 * np.abs((np.arange(2000.0) % 400.0) / 200.0 - 1.0)
    >>> y = stick(u, 4.0, 2.0)
    >>> sizes = sizes_of(u, y, width(u, y, 200.0))
    >>> round(sizes.S, 1), round(sizes.J, 1)
    (4.0, 2.0)
    """
    drop, tried, reached = len(u) // 10, [], []
    S, share, start, lag = found.S, 0.5, 0.0, 0.5 * found.lag  # the play makes up for a jump by some lag
    reach = (0.5, 0.5, 1.0, lag)  # of S, of J / S, of the start, of the lag
    for _ in range(5):
        low, high = max(S * (1.0 - 0.4 * reach[0]), 0.02 * found.travel), min(S * (1.0 + 2.0 * reach[0]), found.travel)
        s, j, a = (
            v.ravel()
            for v in np.meshgrid(
                np.append(np.linspace(low, max(high, low), 15), S),
                np.append(np.clip(np.linspace(share - reach[1], share + reach[1], 9), 0.0, 1.0), 0.0),
                np.clip(np.linspace(start - reach[2], start + reach[2], 5), -1.0, 1.0),
            )
        )
        lags = np.unique(np.append(np.round(lag + np.linspace(-reach[3], reach[3], 7)).astype(int), found.lag))
        rows = np.arange(0, len(s), AT_ONCE)[1:]
        sticks = zip(*(np.split(one, rows) for one in (s, j * s, a)), strict=True)
        correlated = [_correlate(stick(u, *some), y, lags, drop) for some in sticks]
        rho, at = (np.concatenate(each) for each in zip(*correlated, strict=True))
        k = int(np.argmax(rho))
        S, share, start, lag = float(s[k]), float(j[k]), float(a[k]), float(lags[at[k]])
        tried.append(s)
        reached.append(rho)
        reach = (0.4 * reach[0], 0.4 * reach[1], 0.5 * reach[2], 0.5 * reach[3])
    sizes, rho = np.concatenate(tried), np.concatenate(reached)
    at, group = np.unique(sizes, return_inverse=True)
    best = np.zeros(len(at))
    np.maximum.at(best, group, rho)
    looks = max(len(turns(u, S)), 1)
    loss = 0.5 * looks * np.log((1.0 - best**2 + 1e-12) / (1.0 - float(np.max(rho)) ** 2 + 1e-12))
    low, high = interval(at, loss, S)
    return Sizes(S, low, high, share * S, stick(u, S, share * S, start))


def detect(record: LoopRecord | Prepared, p: Params = Params()) -> Verdict:
    """The verdict on one loop.

    >>> from stickslip.detect.stem.stick import stick
    >>> t = np.arange(800.0)
    >>> op = 50 + 5 * np.sin(t / 15) + np.sin(t / 47)
    >>> v = detect(LoopRecord.from_arrays(t, pv=stick(op, 4.0), op=op, process="self_regulating"))
    >>> v.verdict, round(v.amount_percent_op, 1)
    ('stiction', 4.0)
    """
    loop = prepared(record)
    if refusal := refused(CARD, loop, p.width) or too_short(CARD, loop.whole, p.samples, p.width):
        return refusal
    grid = loop.whole
    name, y = stem_signal(grid)
    u = grid.op
    found = width(u, y, min(turn_time(u, loop.period / grid.dt)[1], len(u) / 4.0))
    W = min(found.S / found.travel, 1.0)
    sizes = sizes_of(u, y, found)
    reversals = len(turns(u, found.S))
    word, why = _word(found, W, reversals, p)
    amount = loop.op_percent(sizes.S) if word == "stiction" else None
    size = "" if amount is None else f"S = {amount:.3g} % of OP; "
    reason = (
        f"{size}W = {W:.2f}, correlation of {name} with OP {found.without:.2f}, through a play {found.best:.2f}: {why}."
    )
    evidence: dict[str, Values | float] = {
        "u": u[-3000:], "x": sizes.x[-3000:], "y": y[-3000:], "sizes": found.sizes, "rho": found.rho, "width": found.S,
        "S": sizes.S, "J": sizes.J, "rho_best": found.best, "rho_without": found.without, "lag": found.lag * grid.dt,
        "reversals": float(reversals), "slope": found.slope, "mv": float(name == "MV"),
    }  # fmt: skip
    for key, value in (("S_low", sizes.low), ("S_high", sizes.high)):
        evidence[key] = loop.op_percent(value) or value
    return Verdict(CARD.name, word, W, p.width, reason, amount_percent_op=amount, evidence=evidence, draw=draw)


def _word(found: Width, W: float, reversals: int, p: Params) -> tuple[Word, str]:
    if found.best < p.rho:
        return "inconclusive", "the two have too little in common to speak of the valve"
    left = (1.0 - found.best**2) / max(1.0 - found.without**2, 1e-12)
    if left > p.left:
        return "inconclusive", (
            "a lag alone predicts as much, which clears nothing"
            if left > 0.9
            else "a play predicts little more than a lag"
        )
    if p.width > W:
        return "inconclusive", f"the picture is open, but narrower than {p.width:g} of the travel of OP"
    if reversals < p.reversals:
        return "inconclusive", f"OP reverses {reversals} times with travel beyond it, {p.reversals} are needed"
    return "stiction", f"the stem stands still while OP travels, at {reversals} reversals"


def draw(v: Verdict, figure: FigureBase) -> None:
    """The OP-MV (or PV) picture with the fitted parallelogram, and the correlation over the width."""
    from stickslip.detect.figures.verdict import finish
    from stickslip.logs.style import INK, SOFT

    left, right = figure.subplots(1, 2)
    y, x, slope = v.array("y"), v.array("x"), float(v.array("slope")[0])
    left.plot(v.array("u")[::2], y[::2], ".", ms=2, color=SOFT)
    left.plot(v.array("u"), np.mean(y) + slope * (x - np.mean(x)), color=INK, lw=0.8)
    right.plot(v.array("sizes"), v.array("rho"), color=INK)
    right.axhline(v.array("rho_without")[0], color=SOFT, ls=":")
    right.axvline(v.array("width")[0], color=SOFT, ls="--")
    finish(left, "OP", "MV" if v.array("mv")[0] else "PV")
    finish(right, "width of the play [unit of OP]", "correlation [-]", "dotted: OP alone with its best lag")

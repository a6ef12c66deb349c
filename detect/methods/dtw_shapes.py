"""Each cycle against templates by dynamic time warping, Srinivasan, Rengaswamy and Miller 2005.

A cycle of OP and of PV, standardised and on 32 points a half wave, is compared with cycles of known shape: a sine,
triangles with their apex at 0.1 to 0.9 of the half wave, a square, and squares behind a lag of 0.1 to 0.4 half
periods.  Time may be warped by 5 % of the cycle; the distance of the best path from corner to corner, where a diagonal
step counts twice, is

    d = sum of |x_i - y_j| w / (2 n)

A cycle is named after the nearest template, if that is nearer than the sine by 10 %; a self-regulating loop sticks
where OP is triangular and PV square in the same share of cycles, an integrating one where PV is triangular.

    index = min(share of triangular cycles of OP, share of square cycles of PV), or share of triangular cycles of PV

Source: Srinivasan, Rengaswamy and Miller 2005, Ind. Eng. Chem. Res. 44:6708 (shapes, one template a cycle); Sakoe and
Chiba 1978 for the path.  Templates, band, margin 10 % and share 60 % are ours.

Not where dead time rounds all shapes: then the cycles are sines, which clears nothing.  Measured on the prepared
record: 5 to 10 ms for 7,200 samples (at most 40 cycles are read).
"""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import numpy.typing as npt
from stickslip.detect.card import Card
from stickslip.detect.prepare.preconditions import refused
from stickslip.detect.prepare.prepared import CUT, Prepared, Signal, prepared
from stickslip.detect.prepare.whole_cycles import averaged, whole_cycles
from stickslip.detect.verdict import FigureBase, Verdict, Word
from stickslip.logs import LoopRecord
from stickslip.logs.arrays import Indices, Values

POINTS = 64

CARD = Card(
    name="dtw_shapes", title="Templates by time warping",
    source="Srinivasan, Rengaswamy and Miller 2005, Ind. Eng. Chem. Res. 44:6708",
    signals=("OP", "PV"), process=("self_regulating", "integrating"),
    assumes=("sustained oscillation of the loop's own making", "PI controller", "constant set point"),
    finds="whether OP is triangular while PV is square (level: PV triangular), cycle by cycle; no amount",
    index=(0.0, 1.0), streams="window", cost="O(cycles templates 64 6)", experimental=True,
    stream_note="Every cycle is scaled by the period of the record before it is compared.",
    pros=("every cycle by itself", "small wobbles of the period do not matter", "names the shape"),
    cons=("the kind of process must be known", "noise above 30 % of the wave", "few templates"),
    needs=("known_process", "oscillation", "constant_sp", "unsaturated"),
    cycles=5.0, samples=(20.0, math.inf),
)  # fmt: skip


@dataclass(frozen=True)
class Params:
    """Limits, all ours.

    band : how far time may be warped [points of 64]: 3 is 5 %
    margin : how much nearer than the sine a template must be [share of the distance to the sine]
    cycles_stiction : share of the cycles that must have the shape [-]
    cycles_min, cycles_max : fewest and most cycles read
    noise_wanted : neighbouring cycles are averaged towards this noise [standard deviations of the wave]
    """

    band: int = 3
    margin: float = 0.1
    cycles_stiction: float = 0.6
    cycles_min: int = 4
    cycles_max: int = 40
    noise_wanted: float = 0.1


@lru_cache(maxsize=1)
def templates() -> tuple[tuple[str, ...], Values]:
    """The names of the templates, "sine", "triangle" or "square", and their standardised cycles, (k, 64).

    >>> names, cycles = templates()
    >>> names.count("triangle"), cycles.shape
    (5, (10, 64))
    """
    x = (np.arange(POINTS // 2) + 0.5) / (POINTS // 2)
    halves = [("sine", np.sin(np.pi * x))]
    halves += [("triangle", np.minimum(x / apex, (1.0 - x) / (1.0 - apex))) for apex in (0.1, 0.25, 0.5, 0.75, 0.9)]
    halves += [("square", np.ones(len(x)))]
    halves += [("square", _lagged(x, lag)) for lag in (0.1, 0.2, 0.4)]
    # Where a triangle rises faster than it falls, the negative half wave is the positive one turned by half a circle.
    cycles = np.array([np.concatenate([half, -half[::-1] if name == "triangle" else -half]) for name, half in halves])
    return tuple(name for name, _ in halves), cycles / cycles.std(axis=1, keepdims=True)


def _lagged(x: Values, lag: float) -> Values:
    """A square wave behind a first-order lag [half periods], from its crossing on."""
    a = math.tanh(0.5 / lag)
    s = x / lag + math.log1p(a)
    turn = 1.0 / lag
    return np.where(s < turn, 1.0 - (1.0 + a) * np.exp(-s), (1.0 + a) * np.exp(turn - s) - 1.0)


def distances(x: Values, y: Values, band: int = 3) -> Values:
    """Warped distances (c, k) between cycles (c, n) and templates (k, n), at most ``band`` points apart.

    >>> a = np.sin(np.arange(64) / 10.19)
    >>> d = distances(a[None], np.array([a, np.roll(a, 2), np.sign(a)]))
    >>> d[0].round(2).tolist()[0], bool(d[0, 1] < 0.1 * d[0, 2])
    (0.0, True)
    """
    n, width = x.shape[1], 2 * band + 1
    padded = np.pad(y, ((0, 0), (band, band)), constant_values=np.inf)
    last = np.full((width, len(x), len(y)), np.inf)
    for i in range(n):
        # column b stands for template point j = i + b - band
        cost = np.abs(x[:, i][None, :, None] - padded[:, i : i + width].T[:, None, :])
        now = last + 2.0 * cost  # diagonal: j - 1 of the row above has the same b
        now[:-1] = np.minimum(now[:-1], last[1:] + cost[:-1])
        if i == 0:
            now[band] = 2.0 * cost[band]
        for b in range(1, width):
            now[b] = np.minimum(now[b], now[b - 1] + cost[b])
        last = now
    return np.asarray(last[band] / (2.0 * n))


def named(cycles: Values, p: Params) -> tuple[npt.NDArray[np.str_], Indices]:
    """The name of each cycle (c, 64) and the number of its nearest template, both (c,)."""
    names, shapes = templates()
    centred = cycles - cycles.mean(axis=1, keepdims=True)
    d = distances(centred / centred.std(axis=1, keepdims=True), shapes, p.band)
    best = np.argmin(d, axis=1)
    clear = d[np.arange(len(d)), best] < (1.0 - p.margin) * d[:, 0]
    best = np.where(clear, best, 0)
    return np.array(names)[best], best


def detect(record: LoopRecord | Prepared, p: Params = Params()) -> Verdict:
    """The verdict on one loop; refuses where the kind of process is unknown.

    >>> t = np.arange(2000.0)
    >>> pv, op = np.tanh(9 * np.sin(t / 12)), 2 * np.abs(2 * ((t / 24 / np.pi) % 1) - 1)
    >>> loop = LoopRecord.from_arrays(t, pv=pv, op=50 + op, sp=0 * t, process="self_regulating")
    >>> detect(loop).verdict, detect(loop).index
    ('stiction', 1.0)
    """
    loop = prepared(record)
    if refusal := refused(CARD, loop, p.cycles_stiction):
        return refusal
    found: dict[str, Values] = {}
    signals: tuple[Signal, ...] = ("OP", "PV")
    for signal in signals:
        cycles = whole_cycles(loop, signal, POINTS, cut_at=CUT, even_halves=True)
        if len(cycles.y) < p.cycles_min:
            reason = f"{len(cycles.y)} cycles of {signal} are whole; {p.cycles_min} are needed."
            return Verdict.not_applicable(CARD.name, "too_few_cycles", reason, p.cycles_stiction)
        means = averaged(cycles, p.noise_wanted, p.cycles_min).y
        found[signal] = means[:: -(-len(means) // p.cycles_max)]
    names, best = named(np.concatenate([found["OP"], found["PV"]]), p)
    shares: dict[str, dict[str, float]] = {}
    evidence: dict[str, Values | float] = {"phase": (np.arange(POINTS) + 0.5) / POINTS}
    for signal, part in (("OP", slice(0, len(found["OP"]))), ("PV", slice(len(found["OP"]), None))):
        shares[signal] = {name: float(np.mean(names[part] == name)) for name in ("sine", "triangle", "square")}
        evidence[f"{signal} cycles"] = found[signal] / found[signal].std(axis=1, keepdims=True)
        evidence[f"{signal} template"] = float(np.bincount(best[part]).argmax())
    op, pv = shares["OP"], shares["PV"]
    level = bool(loop.integrating)
    index = pv["triangle"] if level else min(op["triangle"], pv["square"])
    word, why = _word(index, pv["sine"] if level else min(op["sine"], pv["sine"]), level, p)
    parts = [f"{signal} is {_listed(share)}" for signal, share in shares.items()]
    reason = f"{' and '.join(parts)} of the cycles (period {loop.period:.4g} s): {why}."
    return Verdict(CARD.name, word, index, p.cycles_stiction, reason, evidence=evidence, draw=draw)


def _listed(shares: dict[str, float]) -> str:
    return ", ".join(f"a {name} in {share:.0%}" for name, share in shares.items() if share > 0.0)


def _word(index: float, sines: float, level: bool, p: Params) -> tuple[Word, str]:
    shape = "PV is triangular" if level else "OP is triangular while PV is square"
    if index >= p.cycles_stiction:
        return "stiction", f"{shape}, as a sticky valve makes it"
    if sines >= p.cycles_stiction:
        return "inconclusive", (
            "sines are what outside waves and tight tuning make; dead time or a slow process rounds the waves of a "
            "sticky valve too, so it is not cleared"
        )
    return "inconclusive", f"it is in {index:.0%} of the cycles that {shape} ({p.cycles_stiction:.0%} are needed)"


def draw(v: Verdict, figure: FigureBase) -> None:
    """The cycles of OP and PV with the template that most of them are nearest to."""
    from stickslip.detect.figures.half_waves import OTHER, WAVE
    from stickslip.detect.figures.verdict import finish

    names, shapes = templates()
    for ax, signal in zip(figure.subplots(1, 2, sharey=True), ("OP", "PV"), strict=True):
        k = int(v.array(f"{signal} template")[0])
        ax.plot(v.array("phase"), v.array(f"{signal} cycles").T, color=WAVE, lw=0.6)
        ax.plot(v.array("phase"), shapes[k], color=OTHER, lw=1.6, label=names[k])
        finish(ax, "phase of the cycle [-]", f"{signal} [standard deviations]", f"cycles of {signal}", named=True)

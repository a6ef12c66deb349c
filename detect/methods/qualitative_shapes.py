"""Qualitative shape of each cycle from its primitives, Rengaswamy, Hagglund and Venkatasubramanian 2001.

Each cycle of OP (integrating process: of PV) is cut into straight and bent pieces by interval halving, and each piece
is named by the signs of slope and bend (see ``signals.interval_halving``).  A sine reads D G E B, a triangle C F C, a
parabola wave G E.  Behind a sticky valve the signal after the first integrator is a triangle:

    index = share of the cycles that are at least 70 % of their time straight and sloping (C and F)

Source: Rengaswamy, Hagglund and Venkatasubramanian 2001, Eng. Appl. Artif. Intell. 14:23, whose neural network is
replaced by interval halving (Dash et al. 2004, AIChE J. 50:149); the shares 70 % and 60 % are ours.

Where noise would hide the bends, neighbouring cycles are averaged (ours).  Not where noise is then above 30 % of the
wave, since a line then explains a bent piece; dead time, strong proportional action and slow processes bend the
triangle, so a sine is not cleared.  Outside triangles are accused. Measured on the prepared record: 6 ms for 7,200
samples and 60 cycles.
"""

import math
from dataclasses import dataclass

import numpy as np
from stickslip.detect.card import Card
from stickslip.detect.prepare.preconditions import refused
from stickslip.detect.prepare.prepared import Prepared, Signal, prepared
from stickslip.detect.prepare.whole_cycles import averaged, whole_cycles
from stickslip.detect.signals.interval_halving import Piece, primitives
from stickslip.detect.verdict import FigureBase, Verdict, Word
from stickslip.logs import LoopRecord
from stickslip.logs.arrays import Values

LETTERS = "ABCDEFG"

CARD = Card(
    name="qualitative_shapes", title="Qualitative shapes",
    source="Rengaswamy, Hagglund and Venkatasubramanian 2001, Eng. Appl. Artif. Intell. 14:23",
    signals=("OP", "PV"), process=("self_regulating", "integrating"),
    assumes=("sustained oscillation of the loop's own making", "controller with integral action", "constant set point"),
    finds="whether the cycles after the first integrator read as triangles; no amount",
    index=(0.0, 1.0), streams="window", cost="O(n)", experimental=True,
    stream_note="The pieces of interval halving depend on the noise and the scale of a whole record.",
    pros=("every cycle by itself", "readable letters", "unequal halves"),
    cons=("the kind of process must be known", "noise hides the bends", "outside triangles look the same"),
    needs=("known_process", "oscillation", "constant_sp", "unsaturated"),
    cycles=5.0, samples=(20.0, math.inf),
)  # fmt: skip


@dataclass(frozen=True)
class Params:
    """Limits, all ours.

    straight, bent : share of a cycle's time in C and F for a triangle, in B, D, E and G for a sine [-]
    cycles_stiction : share of the cycles that must be triangles [-]
    cycles_min, cycles_max : fewest and most cycles read
    points : values a cycle, at most as many as were sampled
    noise_wanted, noise_max : noise on a value over the standard deviation of the wave: neighbouring cycles are averaged
        towards the first, above the second nothing is decided [-]
    misfit : part of the wave's standard deviation that counts as noise even where there is none [-]
    """

    straight: float = 0.7
    bent: float = 0.7
    cycles_stiction: float = 0.6
    cycles_min: int = 4
    cycles_max: int = 60
    points: int = 64
    noise_wanted: float = 0.04
    noise_max: float = 0.3
    misfit: float = 0.02


def share_of(names: str, pieces: tuple[Piece, ...]) -> float:
    """Share of the samples in the pieces with these names [-].

    >>> share_of("CF", (Piece(0, 3, "C"), Piece(3, 4, "G")))
    0.75
    """
    inside = sum(piece.stop - piece.start for piece in pieces if piece.name in names)
    return inside / max(pieces[-1].stop - pieces[0].start, 1)


def detect(record: LoopRecord | Prepared, p: Params = Params()) -> Verdict:
    """The verdict on one loop; refuses where the kind of process is unknown.

    >>> t = np.arange(2000.0)
    >>> saw = 2 * np.abs(2 * ((t / 80 + 0.1) % 1) - 1) - 1
    >>> loop = LoopRecord.from_arrays(t, pv=np.sin(t / 12.7), op=50 + saw, sp=0 * t, process="self_regulating")
    >>> detect(loop).verdict, detect(loop).index
    ('stiction', 1.0)
    """
    loop = prepared(record)
    if refusal := refused(CARD, loop, p.cycles_stiction):
        return refusal
    signal: Signal = "PV" if loop.integrating else "OP"
    points = min(p.points, int(loop.samples_per_period))  # more would be joined by lines, which are straight
    cycles = averaged(whole_cycles(loop, signal, points), p.noise_wanted, p.cycles_min)
    if len(cycles.y) < p.cycles_min:
        reason = f"{len(cycles.y)} cycles of {signal} are whole; {p.cycles_min} are needed."
        return Verdict.not_applicable(CARD.name, "too_few_cycles", reason, p.cycles_stiction)
    spread, read = float(np.std(cycles.y)), cycles.y[:: -(-len(cycles.y) // p.cycles_max)]
    words = [primitives(y, math.hypot(cycles.noise, p.misfit * spread)) for y in read]
    straight = np.array([share_of("CF", pieces) for pieces in words])
    bent = np.array([share_of("BDEG", pieces) for pieces in words])
    index, sines = float(np.mean(straight >= p.straight)), float(np.mean(bent >= p.bent))
    word, why = _word(index, sines, cycles.noise / spread, p)
    spelt = ["".join(piece.name for piece in pieces) for pieces in words]
    common = max(set(spelt), key=lambda letters: (spelt.count(letters), letters))
    reason = (
        f"{index:.0%} of {len(words)} cycles of {signal} are triangles and {sines:.0%} sines; the most frequent reads "
        f"{' '.join(common)} (period {loop.period:.4g} s): {why}."
    )
    return Verdict(
        CARD.name, word, index, p.cycles_stiction, reason, evidence=_evidence(read, words, signal), draw=draw
    )


def _word(triangles: float, sines: float, noise: float, p: Params) -> tuple[Word, str]:
    if noise > p.noise_max:
        return "inconclusive", (
            f"noise is {noise:.0%} of the wave ({p.noise_max:.0%} allowed), so lines explain all bends"
        )
    if triangles >= p.cycles_stiction:
        return "stiction", "triangles are what the first integrator makes of the square wave of a stuck valve"
    if sines >= p.cycles_stiction:
        return "inconclusive", (
            "sines are what outside waves and tight tuning make; dead time or a slow process bends the triangles of a "
            "sticky valve too, so it is not cleared"
        )
    return "inconclusive", f"no shape has {p.cycles_stiction:.0%} of the cycles"


def _evidence(cycles: Values, words: list[tuple[Piece, ...]], signal: Signal) -> dict[str, Values | float]:
    """The first cycles with their primitives: rows of first sample, last sample and number of the letter."""
    points, shown = cycles.shape[1], min(len(words), 8)
    rows = [
        (k * points + piece.start, k * points + piece.stop, LETTERS.index(piece.name))
        for k in range(shown)
        for piece in words[k]
    ]
    return {"y": cycles[:shown].ravel(), "pieces": np.array(rows, dtype=float), "points": float(points),
            "of_pv": float(signal == "PV")}  # fmt: skip


def draw(v: Verdict, figure: FigureBase) -> None:
    """The first cycles, each piece with its letter."""
    from stickslip.detect.figures.half_waves import OTHER, SINE, WAVE
    from stickslip.detect.figures.verdict import finish

    ax = figure.subplots()
    y, points = v.array("y"), v.array("points")[0]
    x = np.arange(len(y)) / points
    signal = "PV" if v.evidence["of_pv"] else "OP"
    high = float(np.max(np.abs(y)))
    for start, stop, letter in v.array("pieces").astype(int):
        name = LETTERS[letter]
        colour = OTHER if name in "CF" else WAVE if name == "A" else SINE
        ax.plot(x[start : stop + 1], y[start : stop + 1], color=colour, lw=1.6)
        ax.annotate(name, (x[(start + stop) // 2 if stop < len(x) else (start + len(x) - 1) // 2], 1.15 * high),
                    ha="center", fontsize=8, color=colour)  # fmt: skip
    ax.set_ylim(-1.15 * high, 1.35 * high)
    finish(ax, "cycle [-]", f"{signal}, drift off", "straight (C F), bent (B D E G) and level (A) pieces")

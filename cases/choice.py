"""How sets C and E were chosen, and what hangs on it: pressure cycles over the drop D over VPCS1 and PCS11's gain.

Set C, by thought.  Between two reversals PCS11 must carry OP through S = (F_s + F_c)/k, which period T and amplitude A
fix whatever the plant is: S = K_p (2 A + |e| T/(2 T_i)), |e| the mean of the error, about half of A.  The printed rows
give 4.3 and 4.8e-7 /Pa (``gain_from``); the printed 5E-10 times a thousand is 5e-7, and PCS21's 3E-10 is used times a
thousand as well.  Then D alone is left.

Set E, by search.  Seventeen numbers that the thesis does not print (D, K_p, C_4, dp_out, dp_link, J, gains of the
speed, F_in, m_d of both compressors, p_C1, margin, the shape of the map) were searched: 1800 settings judged by table
5.4 over 10 starts, then 260 around C and A judged by all rows of tables 5.4, 6.1, 6.2 and of case 2 over 24 starts.
The best was taken back to set B number by number wherever no row was lost; five were left, and rounded.  ``scan`` shows
every start along two of them, and how the starts part into groups.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from stickslip.cases.kicks import Study, study_of
from stickslip.cases.tables import Row, jumps_a_half_cycle, relative
from stickslip.plant.parameters import Stem

if TYPE_CHECKING:
    from matplotlib.figure import Figure

DROPS = (3.0e5, 3.5e5, 4.1e5, 4.4e5, 5.0e5, 6.0e5, 7.8e5)  # Pa
GAINS = (3.5e-7, 5.0e-7, 7.0e-7, 8.8e-7)  # 1/Pa
PUBLISHED = {"normal": (101.0, 0.26), "high": (37.0, 0.44)}  # s, bar; table 5.4


def gain_from(F_s: float, period: float, amplitude: float, T_i: float = 8.0, share: float = 0.5) -> float:
    """Return the K_p [1/Pa] that carries OP through S in half a period [s] at an amplitude [Pa].

    ``share`` is the mean of the error over its amplitude: 0.5 for a triangle, 0.64 for a sine.

    >>> round(gain_from(1750.0, 101.0, 0.26e5) * 1e7, 1), round(gain_from(2250.0, 37.0, 0.44e5) * 1e7, 1)
    (4.3, 4.8)
    """
    return (F_s + Stem.F_c) / Stem.k / (2.0 * amplitude + share * amplitude * 0.5 * period / T_i)


@dataclass(frozen=True)
class Point:
    """One setting of the scan: ``D`` [Pa], ``K_p`` [1/Pa], size of stiction, what the starts gave."""

    D: float
    K_p: float
    size: str
    found: Study


def scan(
    kicks: int = 40, drops: Sequence[float] = DROPS, gains: Sequence[float] = GAINS,
    progress: Callable[[int, int], None] | None = None,
) -> list[Point]:  # fmt: skip
    """Return the pressure cycles along D at set E's gain, and along the gain at set E's D; skips what cannot rest."""
    from stickslip.plant import SET_E, InfeasibleFeed

    settings = dict.fromkeys([(D, SET_E.S1.K_p_pressure) for D in drops] + [(SET_E.D, K_p) for K_p in gains])
    points: list[Point] = []
    for done, (D, K_p) in enumerate(settings):
        plant = replace(SET_E, D=D, S1=replace(SET_E.S1, K_p_pressure=K_p))
        try:
            points += [Point(D, K_p, size, study_of(plant, size, kicks=kicks)) for size in ("normal", "high")]
        except InfeasibleFeed:
            continue
        finally:
            if progress is not None:
                progress(done + 1, len(settings))
    return points


def rows(points: Sequence[Point]) -> list[Row]:
    """Return medians and bands of the scan beside the published values; none is judged."""
    table = []
    for point in points:
        where = f"D = {point.D / 1e5:.1f} bar, K_p = {point.K_p:.2g}/Pa, {point.size}"
        groups = jumps_a_half_cycle(point.found, point.size)
        note = "starts by jumps a half cycle: " + ", ".join(f"{groups.count(n)} of {n}" for n in sorted(set(groups)))
        for quantity, name, unit, value in (
            ("period", "pressure T", "s", PUBLISHED[point.size][0]),
            ("amplitude", "pressure A", "bar", PUBLISHED[point.size][1]),
        ):
            table.append(
                relative("choice", f"pressure {quantity}, {where}", unit, value, point.found.band(name), None, note)
            )
    return table


def figure(points: Sequence[Point]) -> "Figure":
    """Return amplitude and period of the pressure for every start, along D and along K_p."""
    from stickslip.cases.curves import label, panels
    from stickslip.logs.style import STICTION
    from stickslip.plant import SET_E

    D_E, K_p_E = SET_E.D, SET_E.S1.K_p_pressure
    picture, axes = panels(2, 2, "Every start of the scan: pressure of separator 1 (dashed: published)", 3.0)
    ways: tuple[tuple[list[Point], Callable[[Point], float], str, str], ...] = (
        ([p for p in points if p.K_p == K_p_E], lambda p: p.D / 1e5, "drop over VPCS1 [bar]", f"K_p = {K_p_E:g} /Pa"),
        ([p for p in points if p.D == D_E], lambda p: p.K_p * 1e7, "gain of PCS11 [1e-7 /Pa]", f"D = {D_E / 1e5} bar"),
    )
    for column, (chosen, place, name, fixed) in enumerate(ways):
        for row, (number, unit, which) in enumerate((("pressure A", "bar", 1), ("pressure T", "s", 0))):
            ax = axes[2 * row + column]
            for point in chosen:
                values = point.found.numbers[number]
                side = -0.04 if point.size == "normal" else 0.04
                x = place(point) + side * np.linspace(0.5, 1.5, len(values))
                ax.plot(x, values, ".", markersize=3, color=STICTION[point.size])
            for size, published in PUBLISHED.items():
                ax.axhline(published[which], color=STICTION[size], linestyle="--", linewidth=0.9)
            label(ax, ("amplitude, " if row == 0 else "period, ") + fixed, name, f"[{unit}]")
            ax.set_ylim(0.0, None if row == 0 else 250.0)
    for size in PUBLISHED:
        axes[0].plot([], [], "o", color=STICTION[size], label=f"{size} stiction")
    axes[0].legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=3, fontsize=8, frameon=False)
    return picture
